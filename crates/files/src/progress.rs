//! Long runs, with a progress bar where there is a terminal.

use a3_core::{Error, Simulation};

use crate::platform::bar::RunBar;

/// Simulated time between two calls of `frame` (s).
const FRAME: f64 = 1.0 / 60.0;
/// Largest number of steps between them, of systems of one's own, whose time has any unit.
const STRIDE: u64 = 1000;

/// Advances a simulation to `until` (s) in whole steps, the last one shortened. Calls `frame` about
/// sixty times a simulated second, or after a thousand steps of a system of one's own, and stops if
/// it returns false. Returns whether the run got to the end.
pub fn march(
    simulation: &mut Simulation,
    until: f64,
    mut frame: impl FnMut(&Simulation) -> bool,
) -> Result<bool, Error> {
    let control = simulation.control();
    let is_own = simulation.model().network().is_none();
    if is_own && control.step().is_none() {
        while !simulation.advance_in(until, STRIDE)? {
            if !frame(simulation) {
                return Ok(false);
            }
        }
        return Ok(frame(simulation));
    }
    let step = control.step().unwrap_or(FRAME);
    let most = if is_own { STRIDE as f64 } else { f64::INFINITY };
    let stride = (FRAME / step).floor().clamp(1.0, most);
    loop {
        // Whole steps that end before the last one. If only rounding makes the last one shorter, it
        // is whole too.
        let left = (until - simulation.time()) / step;
        let whole = (left - 1.0 - Simulation::STEP_END_TOLERANCE).ceil().min(stride);
        if whole < 1.0 {
            break;
        }
        if control.step().is_none() {
            // The same times whenever the run begins: states within a step cost evaluations.
            let frame = (simulation.time() / FRAME + Simulation::STEP_END_TOLERANCE).floor();
            simulation.advance_to((frame + 1.0) * FRAME)?;
        } else {
            simulation.take_steps(whole as u64)?;
        }
        if !frame(simulation) {
            return Ok(false);
        }
    }
    simulation.advance_to(until)?;
    Ok(frame(simulation))
}

/// Advances a simulation to `until` (s) as [`march`] does, without a way to stop, and shows how far
/// it is.
pub fn advance(
    simulation: &mut Simulation,
    until: f64,
    mut frame: impl FnMut(&Simulation),
) -> Result<(), Error> {
    let start = simulation.time();
    let mut bar = RunBar::begin();
    let done = march(simulation, until, |simulation| {
        frame(simulation);
        bar.show((simulation.time() - start) / (until - start));
        true
    });
    bar.clear();
    done.map(drop)
}
