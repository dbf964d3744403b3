//! Runs that continue from the states of others.

use a3_core::{Error, Progress, Simulation};

/// Continues a fresh run of the same scene from the state of another run, by its own method.
///
/// # Errors
/// The method does not support the present scene of that run.
pub fn continue_from(next: &mut Simulation, run: &Simulation) -> Result<(), Error> {
    let (method, control) = (next.method(), next.control());
    let mut moment = run.moment();
    let time = moment.time();
    let state = &mut moment.run;
    (state.method, state.control) = (method, control);
    (state.since, state.taken, state.shown) = (time, 0, None);
    moment.progress = Progress::default();
    next.restore(&moment)?;
    // Energy of another model is no gain of the method.
    next.set_method(method, control)
}
