//! Errors and cost of a run against its reference.

use std::time::Duration;

use super::frames::GoOn;
use super::reference::Reference;
use super::run::{EnclosingStep, FrameState, Observer, run_observed};
use super::snapshot::{Errors, Snapshot};
use crate::contact::Guarded;
use crate::control::Control;
use crate::error::{BlowUp, Cause, Error};
use crate::integrators::{Derivative, Method, Solve, Work};
use crate::scene::{Model, Scene};
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

impl Outcome {
    /// Returns whether the run was given up, because it took more work than its
    /// [reference](Reference::max_work) allows.
    #[must_use]
    pub fn is_too_costly(&self) -> bool {
        let lost = self.lost.as_ref();
        lost.is_some_and(|lost| matches!(lost.cause, Cause::TooCostly { .. }))
    }
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
    let mut tally =
        Tally { reference, coordinates, errors: Errors::default(), last: reference.start.clone() };
    if let Some(solve) = method.solve() {
        return measure_whole(clock, scene, (method, solve), control, &mut tally).map(Some);
    }
    let mut simulation = Simulation::new(scene.clone(), method, control)?;
    let mut visit =
        |seen: &FrameState| tally.add(seen.frame, seen.run.model(), seen.state, seen.within);
    let mut observer =
        Observer { visit: &mut visit, clock, spent: Duration::ZERO, max_work: reference.max_work };
    let begun = clock();
    let end = run_observed(&mut simulation, &reference.frames, go_on, Some(&mut observer))?;
    let time = clock().saturating_sub(begun + observer.spent);
    Ok(end.map(|lost| Outcome {
        time,
        errors: tally.errors,
        work: simulation.work(),
        guarded: simulation.guarded(),
        lost,
    }))
}

/// Errors of a run, frame by frame.
struct Tally<'a> {
    reference: &'a Reference,
    coordinates: &'a mut [f64],
    errors: Errors,
    /// The frame before.
    last: Snapshot,
}

impl Tally<'_> {
    /// Adds the errors at frame k, counted from 1.
    fn add(&mut self, k: u64, model: &Model, state: &[f64], within: Option<EnclosingStep>) {
        let reference = self.reference;
        self.last = self.last.next(model, reference.frames.time(k), state);
        if !reference.counts(k) {
            return;
        }
        let mut here = reference.errors(k, &self.last);
        let mut at = (reference.frames.time(k), self.last.positions());
        if let Some(step) = &within {
            let at_end = reference.errors_between(model, k, step);
            if at_end.of_coordinates() < here.of_coordinates() {
                at = step.nearest;
            }
            here = here.min(at_end);
        }
        self.errors = self.errors.max(here);
        if self.coordinates.is_empty() {
            return;
        }
        let truth = reference.positions(model, k, at.0);
        let apart = truth.iter().zip(at.1).map(|(a, b)| (a - b).abs());
        for (most, apart) in self.coordinates.iter_mut().zip(apart) {
            *most = f64::max(*most, apart);
        }
    }
}

/// Runs another library's solver over all frames that count, and compares its states.
fn measure_whole(
    clock: &dyn Fn() -> Duration,
    scene: &Scene,
    (method, solve): (&'static Method, &Solve),
    control: Control,
    tally: &mut Tally,
) -> Result<Outcome, Error> {
    method.check(scene.model.system())?;
    method.check_control(control)?;
    let Control::Tolerance(tolerance) = control else {
        return Err(Error::Invalid(format!("{} takes a tolerance, not a step", method.title)));
    };
    let (reference, dim) = (tally.reference, scene.state.len());
    let frames: Vec<u64> = (1..=reference.frames.count).filter(|k| reference.counts(*k)).collect();
    let times: Vec<f64> = frames.iter().map(|k| reference.frames.time(*k)).collect();
    let most = reference.max_work;
    let mut f = Derivative::new(scene.model.system()).with_most(most);
    let lost_at = |frame: u64, cause: Cause| BlowUp {
        method: method.title,
        control,
        step: frame,
        time: reference.frames.time(frame),
        cause,
    };
    let begun = clock();
    let solved = solve(&mut f, &times, &scene.state, tolerance);
    let time = clock().saturating_sub(begun);
    if f.is_spent() {
        return Ok(Outcome {
            time,
            errors: tally.errors,
            work: f.work(),
            guarded: Guarded::default(),
            lost: Some(lost_at(0, Cause::TooCostly { most })),
        });
    }
    let states = solved?;
    if states.len() != times.len() * dim {
        return Err(Error::Callback(format!(
            "{} returned {} numbers, but {dim} at each of {} times were asked for",
            method.title,
            states.len(),
            times.len()
        )));
    }
    let mut lost = None;
    for (k, state) in frames.into_iter().zip(states.chunks_exact(dim)) {
        if let Some(index) = state.iter().position(|y| !y.is_finite()) {
            lost = Some(lost_at(k, Cause::NumberNotFinite { index }));
            break;
        }
        tally.add(k, &scene.model, state, None);
    }
    Ok(Outcome { time, errors: tally.errors, work: f.work(), guarded: Guarded::default(), lost })
}
