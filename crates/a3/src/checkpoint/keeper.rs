//! Checkpoints as files of the system, written again and again.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::{ENDING, Kept, TITLE};
use crate::failure::Failure;
use crate::output;

/// Size of the largest file that is read (bytes).
const LARGEST: u64 = 4 << 30;

/// The bytes of an ordinary file that is not too large.
pub(super) fn bytes_of(path: &Path) -> Result<Vec<u8>, String> {
    let read = || -> std::io::Result<Option<Vec<u8>>> {
        let file = File::open(path)?;
        let there = file.metadata()?;
        if !there.is_file() || there.len() > LARGEST {
            return Ok(None);
        }
        let mut bytes = vec![];
        file.take(LARGEST).read_to_end(&mut bytes)?;
        Ok(Some(bytes))
    };
    match read() {
        Ok(Some(bytes)) => Ok(bytes),
        Ok(None) => Err("this is no checkpoint of a3".into()),
        Err(error) => Err(format!("it could not be read: {}", output::reason(&error))),
    }
}

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
