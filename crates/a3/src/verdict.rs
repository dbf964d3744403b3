//! Words about runs without a window that went wrong: what would have held, and energy that nothing
//! put in.

use a3_core::{Cause, Control, Error, Simulation};

use crate::failure::Failure;
use crate::holding::step_that_holds;
use crate::output;

/// The failure of a run, with a clause that says what is left of it.
pub fn lost(run: &Simulation, error: &Error, kept: &str) -> Failure {
    let kept = if kept.is_empty() {
        String::new()
    } else {
        format!("; {kept}")
    };
    Failure::run(format!("{error}{kept}{}", advice(run, error)))
}

/// A clause with the longest step that would have held, where the step was at fault.
fn advice(run: &Simulation, error: &Error) -> String {
    let Error::BlowUp(lost) = error else {
        return String::new();
    };
    match (lost.cause, lost.control) {
        (Cause::StepTooSmall { .. }, _) => "; a larger tolerance may do".into(),
        (Cause::ReadsVelocity | Cause::Squeezed { .. }, _)
        | (Cause::NotFinite { .. }, Control::Tolerance(_)) => String::new(),
        (_, Control::Tolerance(_)) => "; a smaller tolerance may hold".into(),
        (_, Control::Step(step)) => match step_that_holds(run) {
            Some(holds) if holds < step => format!("; a step of {holds} s would have held"),
            _ => String::new(),
        },
    }
}

/// Warns on stderr of energy that nothing put into a run.
pub fn warn_of_gain(run: &Simulation) {
    if let Some(gain) = run.gained() {
        let (what, better) = match run.control() {
            Control::Step(step) => (format!("the step of {step} s"), "shorter"),
            Control::Tolerance(tolerance) => (format!("the tolerance of {tolerance:e}"), "smaller"),
        };
        output::warn(&format!(
            "warning: the run gained {:.3e} J that nothing put in, {:.1} times the energy of the scene: {what} should be {better}",
            gain.energy, gain.share
        ));
    }
}
