//! Data of a chart: its runs, in a file that a later chart continues.

use std::path::Path;

use a3_files::failure::Failure;
use a3_files::rows::Rows;

use super::each::Each;
use super::record::Record;

/// Runs that are known.
pub struct Data {
    pub runs: Rows<Record>,
    /// File for the errors of each particle in the runs that are measured, if it was asked for.
    pub each: Option<Each>,
}

impl Data {
    /// Reads the runs in a file; none if there is no file, or an empty one.
    ///
    /// # Errors
    /// The file holds something else, or cannot be read.
    pub fn open(path: Option<&Path>) -> Result<Self, Failure> {
        let runs = Rows::open(path, "the data of a chart")?;
        Ok(Self { runs, each: None })
    }

    /// Finds the run of the same scene, method, setting and version; if `timed`, only one that was
    /// timed, or that blew up.
    pub fn find(&self, like: &Record, timed: bool) -> Option<&Record> {
        let run = self.runs.find(like);
        run.filter(|run| !timed || run.seconds.is_some() || run.lost_at.is_some())
    }
}

/// Version of this program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
