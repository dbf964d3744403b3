//! Messages about failed runs without a window: a step that would have held, energy that nothing
//! put in, and constraints that are not met.

use a3_core::{Cause, Control, Error, Simulation, Unmet};

use crate::base::failure::Failure;
use crate::base::holding::step_that_holds;
use crate::base::terminal;

/// Returns the failure of a run that was to last until the time `until` (s). `kept` is a clause
/// that says what was written.
pub fn lost(run: &Simulation, error: &Error, kept: &str, until: f64) -> Failure {
    let kept = if kept.is_empty() {
        String::new()
    } else {
        format!("; {kept}")
    };
    Failure::run(format!("{error}{kept}{}", advice(run, error, until)))
}

/// Returns a clause with the longest step that would have held until the time `until` (s), if the
/// step was the cause.
fn advice(run: &Simulation, error: &Error, until: f64) -> String {
    let Error::BlowUp(lost) = error else {
        return String::new();
    };
    match (lost.cause, lost.control) {
        (Cause::StepTooSmall { .. }, _) => "; a larger tolerance may do".into(),
        (Cause::ReadsVelocity | Cause::Pinched { .. } | Cause::Contradiction(_), _)
        | (Cause::NotFinite { .. } | Cause::NumberNotFinite { .. }, Control::Tolerance(_)) => {
            String::new()
        }
        (_, Control::Tolerance(_)) => "; a smaller tolerance may hold".into(),
        (_, Control::Step(_)) => match step_that_holds(run, until) {
            Some(holds) => format!("; a step of {holds} s would have held"),
            None => "; no shorter step was found that holds".into(),
        },
    }
}

/// Warns on stderr of energy that nothing put into a run, and of constraints that it did not meet.
pub fn warn(run: &Simulation) {
    let (what, better) = match run.control() {
        Control::Step(step) => (format!("the step of {step} s"), "shorter"),
        Control::Tolerance(tolerance) => (format!("the tolerance of {tolerance:e}"), "smaller"),
    };
    if let Some(gain) = run.gained() {
        terminal::warn(&format!(
            "warning: the run gained {:.3e} J that nothing put in, {:.1} times the energy of the scene: {what} should be {better}",
            gain.energy, gain.share
        ));
    }
    if let Some(unmet) = run.worst_constraint().filter(Unmet::is_visible) {
        terminal::warn(&format!(
            "warning: {unmet}, was off by {:.2} %: {what} should be {better}",
            100.0 * unmet.share
        ));
    }
    if run.was_nearly_singular() {
        terminal::warn(
            "warning: constraints contradict one another or pins, except at a single place: no force holds particles exactly there, as in a chain that is stretched straight between two pins",
        );
    }
}
