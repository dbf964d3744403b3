//! Data of a chart in files: its runs, which a later chart continues, and the errors of each
//! particle along each axis.

use std::path::Path;

use a3_files::failure::Failure;
use a3_files::output::{self, Draft};
use a3_files::rows::Rows;

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

/// CSV file that is being written, with a row for each run and particle.
pub struct Each {
    writer: csv::Writer<Draft>,
}

impl Each {
    /// Begins a file with its heading.
    pub fn new(path: &Path) -> Result<Self, Failure> {
        output::check(path, &["csv"])?;
        let mut each = Self {
            writer: csv::Writer::from_writer(Draft::new(path)?),
        };
        each.row(("stiffness", "solver", "setting", "particle", "x", "y", "z"))?;
        Ok(each)
    }

    /// Writes the largest error of each coordinate in a run (m), n x 3: all x, all y, all z.
    pub fn add(&mut self, run: &Record, coordinates: &[f64]) -> Result<(), Failure> {
        let n = coordinates.len() / 3;
        for i in 0..n {
            let of = [0, 1, 2].map(|axis| coordinates[axis * n + i]);
            self.row((run.stiffness, &run.solver, run.setting, i, of))?;
        }
        Ok(())
    }

    /// Completes the file, and moves it to its place.
    pub fn finish(mut self) -> Result<(), Failure> {
        let flushed = self.writer.flush();
        flushed.map_err(|e| self.writer.get_ref().failure(&e))?;
        self.writer.into_inner().map_err(Failure::run)?.place()
    }

    /// Writes a row.
    fn row(&mut self, row: impl serde::Serialize) -> Result<(), Failure> {
        let written = self.writer.serialize(row);
        written.map_err(|e| self.writer.get_ref().failure(&e.into()))
    }
}
