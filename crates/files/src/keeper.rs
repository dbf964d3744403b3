//! Periodic writing of checkpoints.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::checkpoint::{ENDING, Kept, TITLE};
use super::failure::Failure;
use super::platform::{output, read_checkpoint};

/// A file to which a run is saved periodically.
pub struct Keeper {
    path: PathBuf,
    /// Real time between two writes.
    every: Duration,
    last: Instant,
}

impl Keeper {
    /// Creates a keeper that writes to `path` when the real time `every` has passed since the last
    /// write.
    pub fn new(path: &Path, every: Duration) -> Result<Self, Failure> {
        output::check(path, &[ENDING])?;
        // Only checkpoints are overwritten. The name of the file does not matter.
        if path.is_file() && !read_checkpoint(path).is_ok_and(|bytes| bytes.starts_with(TITLE)) {
            return Err(Failure::usage(format!(
                "{}: this is no checkpoint of a3, and would be overwritten: give another name",
                path.display()
            )));
        }
        Ok(Self { path: path.into(), every, last: Instant::now() })
    }

    /// Writes the run that `kept` returns, if it is time to.
    pub fn write_if_due(&mut self, kept: impl FnOnce() -> Kept) -> Result<(), Failure> {
        if self.last.elapsed() < self.every {
            return Ok(());
        }
        kept().write(&self.path)?;
        self.last = Instant::now();
        Ok(())
    }

    /// Writes the run now. Returns a clause that says so.
    pub fn write(&self, kept: &Kept) -> Result<String, Failure> {
        kept.write(&self.path)?;
        let time = kept.checkpoint.time();
        Ok(format!("{} has the run at t = {time:.4} s", self.path.display()))
    }
}
