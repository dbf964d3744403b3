//! Errors of each particle along each axis, in a file.

use std::path::Path;

use a3_files::failure::Failure;
use a3_files::output::{self, Draft};

use super::record::Record;

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
