//! The interface of all export formats, and checks and encodings of numbers for several of them.

use std::io::{self, Write};

use a3_core::Simulation;
use a3_files::failure::Failure;
use a3_files::rounding::{DIGITS, short};

/// An export that is being written.
pub trait Export {
    /// Adds the current state as a frame.
    fn add(&mut self, simulation: &Simulation) -> Result<(), Failure>;

    /// Completes the export after its last frame.
    fn finish(self: Box<Self>) -> Result<(), Failure>;
}

/// Returns the velocities of all particles (m/s); a failure if a number of the state is not finite.
pub fn velocities(simulation: &Simulation) -> Result<Vec<f64>, Failure> {
    let velocities = simulation.velocities();
    let mut all = simulation.state().iter().chain(&velocities);
    if all.all(|x| x.is_finite()) {
        return Ok(velocities);
    }
    Err(Failure::run(format!(
        "the state at t = {} s has numbers that are not finite",
        short(simulation.time(), DIGITS)
    )))
}

/// Writes vectors in little-endian single precision, one after the other.
pub fn rows(file: &mut dyn Write, vectors: &[[f32; 3]]) -> io::Result<()> {
    for number in vectors.as_flattened() {
        if !number.is_finite() {
            let why = "a displacement is too large for single precision";
            return Err(io::Error::other(why));
        }
        file.write_all(&number.to_le_bytes())?;
    }
    Ok(())
}
