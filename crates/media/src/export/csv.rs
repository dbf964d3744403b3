//! CSV: a row for each frame and particle, at full precision.

use std::path::Path;

use a3_core::Simulation;
use a3_files::failure::Failure;
use a3_files::output::Draft;
use a3_files::rounding::{DIGITS, short};

use super::geometry::{Export, velocities};

/// Approximate size of a row (bytes).
pub const ROW_SIZE: f64 = 150.0;

/// A CSV file that is being written.
pub struct Csv {
    writer: csv::Writer<Draft>,
    /// Number of the next frame.
    next: usize,
}

impl Csv {
    /// Creates a file with a heading, for frames from number `first` on.
    pub fn new(path: &Path, first: usize) -> Result<Self, Failure> {
        let mut csv = Self { writer: csv::Writer::from_writer(Draft::new(path)?), next: first };
        csv.row(("frame", "time", "particle", "x", "y", "z", "vx", "vy", "vz"))?;
        Ok(csv)
    }

    /// Writes a row.
    fn row(&mut self, row: impl serde::Serialize) -> Result<(), Failure> {
        let written = self.writer.serialize(row);
        written.map_err(|e| self.writer.get_ref().failure(&e.into()))
    }
}

impl Export for Csv {
    fn add(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        let (n, x, v) = (simulation.particles(), simulation.state(), velocities(simulation)?);
        let time = short(simulation.time(), DIGITS);
        for i in 0..n {
            let of = |column: &[f64]| (column[i], column[n + i], column[2 * n + i]);
            self.row((self.next, time, i, of(x), of(&v)))?;
        }
        self.next += 1;
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> Result<(), Failure> {
        let flushed = self.writer.flush();
        flushed.map_err(|e| self.writer.get_ref().failure(&e))?;
        self.writer.into_inner().map_err(Failure::run)?.place()
    }
}
