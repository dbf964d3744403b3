//! Errors of the states that a run shows at any time, as in films and data.

use super::frames::{Frames, GoOn};
use super::reference::Reference;
use super::snapshot::Errors;
use crate::control::Control;
use crate::error::Error;
use crate::failure::succeeded;
use crate::integrators::Method;
use crate::scene::Scene;
use crate::simulation::Simulation;
use crate::stability::accurate;

/// Number of times for each frame at which states are compared.
const TIMES: u64 = 4;
/// Share of a time that is rounding.
const ROUNDING: f64 = 1e-9;

/// Largest errors of the states that a run shows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shown {
    /// Errors at the ends of steps, where fixed ones end.
    pub at_ends: Errors,
    /// Errors at the frames, between them, and at the ends of fixed steps.
    pub anywhere: Errors,
}

/// Runs a scene and compares the states that the run shows with the method and the tolerance of its
/// reference, at the frames and at three times between each two of them. Between its steps, a run
/// shows interpolated states. Errors are infinite if the run fails. `None` if `go_on` returned
/// false.
///
/// # Errors
/// The method does not support the scene or the control, or a callback failed.
pub fn shown(
    scene: &Scene,
    method: &'static Method,
    control: Control,
    reference: &Reference,
    go_on: GoOn,
) -> Result<Option<Shown>, Error> {
    let frames = Frames { count: TIMES * reference.frames.count, ..reference.frames };
    let tolerance = Control::Tolerance(reference.trajectory.tolerance);
    let mut exact = scene.clone();
    exact.limits.absolute = None;
    let mut exact = Simulation::new(exact, accurate(reference.is_stiff)?, tolerance)?;
    exact.locate_events();
    let mut run = Simulation::new(scene.clone(), method, control)?;
    let (mut truth, mut own) = (reference.start.clone(), reference.start.clone());
    let mut found = Shown::default();
    for k in 1..=frames.count {
        if !go_on() {
            return Ok(None);
        }
        let (before, time) = (frames.time(k - 1), frames.time(k));
        // The last end of a fixed step until now.
        let end = control.step().map(|h| h * (time / h + ROUNDING).floor());
        let is_end = end.is_some_and(|end| end >= time * (1.0 - ROUNDING)) || k == frames.count;
        let end = end.filter(|end| *end > before && !is_end);
        for (t, is_end) in end.map(|t| (t, true)).into_iter().chain([(time, is_end)]) {
            if !succeeded(exact.advance_to(t))? || !succeeded(run.advance_to(t))? {
                let lost = Errors::with_all(f64::INFINITY);
                return Ok(Some(Shown { at_ends: lost, anywhere: lost }));
            }
            truth = truth.next(exact.model(), t, exact.state());
            own = own.next(run.model(), t, run.state());
            if reference.scope.at_end && k < frames.count {
                continue;
            }
            let scope = reference.scope;
            let errors = reference.trajectory.errors_of(&truth, &own, scope);
            found.anywhere = found.anywhere.max(errors);
            if is_end {
                found.at_ends = found.at_ends.max(errors);
            }
        }
    }
    Ok(Some(found))
}
