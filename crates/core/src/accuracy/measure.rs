//! Errors and cost of a run against its reference.

use std::time::Duration;

use super::frames::GoOn;
use super::reference::Reference;
use super::run::{FrameState, Observer, run_observed};
use super::snapshot::Errors;
use crate::contact::Guarded;
use crate::control::Control;
use crate::error::{BlowUp, Error};
use crate::integrators::{Method, Work};
use crate::scene::Scene;
use crate::simulation::Simulation;

/// Outcome of a run against the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Largest errors over the frames that the run reached, or those at the last frame if only that
    /// one counts.
    pub errors: Errors,
    /// Work of the whole run.
    pub work: Work,
    /// Actions of the collision safeguard: a run that it changed is not the method's own.
    pub guarded: Guarded,
    /// Blow-up of the run, if there was one.
    pub lost: Option<BlowUp>,
    /// Computing time of the run alone, by the clock that was given.
    pub time: Duration,
}

/// Runs a scene and compares the run with its reference. Returns `None` if `go_on` returned false.
///
/// # Errors
/// The method does not support the scene or the control, or the run fails without a blow-up.
pub fn measure(
    scene: &Scene,
    method: &'static Method,
    control: Control,
    reference: &Reference,
    go_on: GoOn,
) -> Result<Option<Outcome>, Error> {
    let clock = || Duration::ZERO;
    measure_by(&clock, scene, method, control, reference, &mut [], go_on)
}

/// Does what [`measure`] does, with the computing time by a clock: a function that returns the time
/// since some fixed moment. The largest error of each coordinate over the frames that count (m) is
/// written to `coordinates`, n x 3, unless that is empty; without particles, that of each number of
/// the state.
///
/// # Errors
/// The method does not support the scene or the control, or the run fails without a blow-up.
pub fn measure_by(
    clock: &dyn Fn() -> Duration,
    scene: &Scene,
    method: &'static Method,
    control: Control,
    reference: &Reference,
    coordinates: &mut [f64],
    go_on: GoOn,
) -> Result<Option<Outcome>, Error> {
    coordinates.fill(0.0);
    let mut simulation = Simulation::new(scene.clone(), method, control)?;
    let mut errors = Errors::default();
    let mut last = reference.start.clone();
    let mut visit = |seen: &FrameState| {
        let (k, model) = (seen.frame, seen.run.model());
        last = last.next(model, reference.frames.time(k), seen.state);
        if reference.counts(k) {
            let mut here = reference.errors(k, &last);
            let mut at = (reference.frames.time(k), last.positions());
            if let Some(step) = &seen.within {
                let at_end = reference.errors_between(model, k, step);
                if at_end.of_coordinates() < here.of_coordinates() {
                    at = step.nearest;
                }
                here = here.min(at_end);
            }
            errors = errors.max(here);
            if coordinates.is_empty() {
                return;
            }
            let truth = reference.positions(model, k, at.0);
            let apart = truth.iter().zip(at.1).map(|(a, b)| (a - b).abs());
            for (most, apart) in coordinates.iter_mut().zip(apart) {
                *most = f64::max(*most, apart);
            }
        }
    };
    let mut observer = Observer {
        visit: &mut visit,
        clock,
        spent: Duration::ZERO,
    };
    let begun = clock();
    let end = run_observed(
        &mut simulation,
        &reference.frames,
        go_on,
        Some(&mut observer),
    )?;
    let time = clock().saturating_sub(begun + observer.spent);
    Ok(end.map(|lost| Outcome {
        time,
        errors,
        work: simulation.work(),
        guarded: simulation.guarded(),
        lost,
    }))
}
