//! The interface of all export formats.

use a3_core::Simulation;

use a3_files::failure::Failure;

/// An export that is being written.
pub trait Export {
    /// Adds the current state as a frame.
    fn add(&mut self, simulation: &Simulation) -> Result<(), Failure>;

    /// Completes the export after its last frame.
    fn finish(self: Box<Self>) -> Result<(), Failure>;
}
