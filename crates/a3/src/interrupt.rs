//! Ctrl-C: the first one asks the program to come to an end, the second one ends it at once.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock};

/// Exit code of an interrupted program, as shells define it for SIGINT.
pub const EXIT_CODE: u8 = 130;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);
static HANDLER: OnceLock<()> = OnceLock::new();
/// Files that are not complete yet.
static DRAFTS: Mutex<Vec<PathBuf>> = Mutex::new(vec![]);

/// Makes the first interrupt a request, from now on.
pub fn listen() {
    HANDLER.get_or_init(|| {
        // Where no handler can be set, an interrupt ends the program at once.
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

/// Whether no interrupt has been requested.
pub fn go_on() -> bool {
    !INTERRUPTED.load(Ordering::SeqCst)
}

/// A file that is deleted if the program ends at once while this value exists.
pub struct Temporary(PathBuf);

impl Temporary {
    /// Registers the file.
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
