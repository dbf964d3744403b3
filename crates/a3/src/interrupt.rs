//! Ctrl-C: the first one asks to come to an end, the second one ends at once.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// As a shell has it for SIGINT.
pub const EXIT_CODE: u8 = 130;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);
static HANDLER: OnceLock<()> = OnceLock::new();

/// From now on an interrupt is a wish.
pub fn listen() {
    HANDLER.get_or_init(|| {
        // Where that cannot be, an interrupt ends the program as it always does.
        let _ = ctrlc::set_handler(|| {
            if INTERRUPTED.swap(true, Ordering::SeqCst) {
                std::process::exit(i32::from(EXIT_CODE));
            }
        });
    });
}

/// Whether to go on.
pub fn go_on() -> bool {
    !INTERRUPTED.load(Ordering::SeqCst)
}
