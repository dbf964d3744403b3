//! Locks on folders, with which processes wait for one another.

use std::fs::{File, TryLockError};
use std::path::Path;
use std::time::Duration;

use web_time::Instant;

use super::place::{folder, resolve};
use crate::failure::Failure;
use crate::terminal::warn;

/// Times of waiting for another process: until a message says so, and until the wait fails.
const WAITS: [Duration; 2] = [Duration::from_secs(1), Duration::from_secs(10)];

/// Locks the folder of a file until the returned value is dropped, so that no other process that
/// locks it reads or replaces the file meanwhile. `None` where the system has no such locks; a
/// failure if another process holds the lock for 10 s.
pub fn lock(path: &Path) -> Result<Option<File>, Failure> {
    let folder = resolve(path).and_then(|place| File::open(folder(&place)));
    let Ok(folder) = folder else {
        return Ok(None);
    };
    let (begun, mut is_said) = (Instant::now(), false);
    loop {
        match folder.try_lock() {
            Ok(()) => return Ok(Some(folder)),
            Err(TryLockError::Error(_)) => return Ok(None),
            Err(TryLockError::WouldBlock) => {}
        }
        let (waited, place) = (begun.elapsed(), path.display());
        if waited > WAITS[1] {
            return Err(Failure::run(format!(
                "{place}: another process has locked its folder for 10 s: end it, or give another name"
            )));
        }
        if waited > WAITS[0] && !is_said {
            is_said = true;
            warn(&format!(
                "{place}: waits for another process that has locked its folder"
            ));
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}
