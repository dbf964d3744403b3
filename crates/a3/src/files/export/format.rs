//! What every format of exports does.

use a3_core::Simulation;

use crate::base::failure::Failure;

/// An export in the making.
pub trait Export {
    /// Adds the current state as a frame.
    fn add(&mut self, simulation: &Simulation) -> Result<(), Failure>;

    /// Completes the export after its last frame.
    fn finish(self: Box<Self>) -> Result<(), Failure>;
}
