//! Long runs on a page, which has no terminal.

use a3_core::{Error, Simulation};

use super::march::march;

/// Does the same as [`march`], without a way to stop.
pub fn advance(
    simulation: &mut Simulation,
    until: f64,
    mut frame: impl FnMut(&Simulation),
) -> Result<(), Error> {
    march(simulation, until, |simulation| {
        frame(simulation);
        true
    })
    .map(drop)
}
