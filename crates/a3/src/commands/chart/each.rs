//! Errors of each particle along each axis, in a file.

use std::path::Path;

use super::record::Record;
use crate::base::failure::Failure;
use crate::files::output::{self, Draft};

/// A CSV file in the making: a row for each run and particle.
pub struct Each {
    writer: csv::Writer<Draft>,
}

impl Each {
    /// A file with a heading.
    pub fn new(path: &Path) -> Result<Self, Failure> {
        output::check(path, &["csv"])?;
        let mut each = Self {
            writer: csv::Writer::from_writer(Draft::new(path)?),
        };
        each.row(("stiffness", "solver", "setting", "particle", "x", "y", "z"))?;
        Ok(each)
    }

    /// Writes the largest errors of a run (m), of all x, all y, all z.
    pub fn add(&mut self, run: &Record, coordinates: &[f64]) -> Result<(), Failure> {
        let n = coordinates.len() / 3;
        for i in 0..n {
            let of = [0, 1, 2].map(|axis| coordinates[axis * n + i]);
            self.row((run.stiffness, &run.solver, run.setting, i, of))?;
        }
        Ok(())
    }

    /// Puts the file in its place.
    pub fn finish(mut self) -> Result<(), Failure> {
        let flushed = self.writer.flush();
        flushed.map_err(|e| self.writer.get_ref().failure(&e))?;
        self.writer.into_inner().map_err(Failure::run)?.place()
    }

    fn row(&mut self, row: impl serde::Serialize) -> Result<(), Failure> {
        let written = self.writer.serialize(row);
        written.map_err(|e| self.writer.get_ref().failure(&e.into()))
    }
}
