//! Checkpoints as files of the system, written again and again.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::file::bytes_of;
use super::kept::{ENDING, Kept, TITLE};
use crate::base::failure::Failure;
use crate::files::output;

/// The file in which a run is kept again and again.
pub struct Keeper {
    path: PathBuf,
    /// Real time between two writes.
    every: Duration,
    last: Instant,
}

impl Keeper {
    /// A file that is written when so much real time has passed since the last time.
    pub fn new(path: &Path, every: Duration) -> Result<Self, Failure> {
        output::check(path, &[ENDING])?;
        // Nothing else is overwritten, whatever its name is.
        if path.is_file() && !bytes_of(path).is_ok_and(|bytes| bytes.starts_with(TITLE)) {
            return Err(Failure::usage(format!(
                "{}: this is no checkpoint of a3, and would be overwritten: give another name",
                path.display()
            )));
        }
        Ok(Self {
            path: path.into(),
            every,
            last: Instant::now(),
        })
    }

    /// Writes what `kept` returns, if it is time to.
    pub fn look(&mut self, kept: impl FnOnce() -> Kept) -> Result<(), Failure> {
        if self.last.elapsed() < self.every {
            return Ok(());
        }
        kept().write(&self.path)?;
        self.last = Instant::now();
        Ok(())
    }

    /// Writes what is kept now. Returns a clause that says so.
    pub fn write(&self, kept: &Kept) -> Result<String, Failure> {
        kept.write(&self.path)?;
        let time = kept.checkpoint.time();
        Ok(format!(
            "{} has the run at t = {time:.4} s",
            self.path.display()
        ))
    }
}
