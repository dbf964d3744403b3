//! Ctrl-C: the first one asks to come to an end, the second one ends at once.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock};

/// As a shell has it for SIGINT.
pub const EXIT_CODE: u8 = 130;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);
static HANDLER: OnceLock<()> = OnceLock::new();
/// Files that are not yet what they are to be.
static DRAFTS: Mutex<Vec<PathBuf>> = Mutex::new(vec![]);

/// From now on an interrupt is a wish.
pub fn listen() {
    HANDLER.get_or_init(|| {
        // Where that cannot be, an interrupt ends the program as it always does.
        let _ = ctrlc::set_handler(|| {
            if INTERRUPTED.swap(true, Ordering::SeqCst) {
                for path in DRAFTS.lock().iter().flat_map(|drafts| drafts.iter()) {
                    let _ = fs::remove_file(path);
                }
                std::process::exit(i32::from(EXIT_CODE));
            }
        });
    });
}

/// Whether to go on.
pub fn go_on() -> bool {
    !INTERRUPTED.load(Ordering::SeqCst)
}

/// As long as this is held, the file is taken away when the program ends at once.
pub struct Temporary(PathBuf);

impl Temporary {
    pub fn new(path: &Path) -> Self {
        if let Ok(mut drafts) = DRAFTS.lock() {
            drafts.push(path.into());
        }
        Self(path.into())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if let Ok(mut drafts) = DRAFTS.lock() {
            drafts.retain(|path| *path != self.0);
        }
    }
}
