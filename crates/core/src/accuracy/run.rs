//! Runs that are observed at frames, wherever their steps end.

use std::time::Duration;

use super::frames::{Frames, GoOn};
use super::hermite::weights;
use crate::error::{BlowUp, Cause, Error};
use crate::simulation::Simulation;

/// Largest distance of the end of a step from a frame, relative to the time, at which it counts as
/// the frame.
const FRAME_TOLERANCE: f64 = 1e-9;
/// Number of ends of steps through which states between them are interpolated.
const NODES: u64 = 3;
/// Largest number of steps, and largest work of these, between two calls of `go_on`.
const MAX_PORTION: (u64, f64) = (1000, 4e5);

/// State of a run at a frame.
#[derive(Clone, Copy)]
pub struct FrameState<'a> {
    /// Number of the frame, counted from 1.
    pub frame: u64,
    /// The run, which may be beyond the frame.
    pub run: &'a Simulation,
    /// State at the frame.
    pub state: &'a [f64],
    /// Step that encloses the frame, if no step ends there and the state is interpolated.
    pub within: Option<EnclosingStep<'a>>,
}

/// Step that encloses a frame.
#[derive(Clone, Copy)]
pub struct EnclosingStep<'a> {
    /// Times at its beginning and its end (s).
    pub times: [f64; 2],
    /// Time (s) and state at the nearest end of a step.
    pub nearest: (f64, &'a [f64]),
}

/// Callback for each frame.
pub type Visit<'a> = &'a mut dyn FnMut(&FrameState);

/// Observer of a run, with the time that it takes, which does not count as the run's.
pub(super) struct Observer<'a> {
    pub(super) visit: Visit<'a>,
    /// Clock: the time since some fixed moment.
    pub(super) clock: &'a dyn Fn() -> Duration,
    pub(super) spent: Duration,
    /// Largest work of the run, in evaluations.
    pub(super) max_work: f64,
}

impl Observer<'_> {
    /// Does work that only the observer needs, and measures its time.
    fn observe(&mut self, work: impl FnOnce(&mut dyn FnMut(&FrameState))) {
        let begun = (self.clock)();
        work(&mut *self.visit);
        self.spent += (self.clock)().saturating_sub(begun);
    }
}

/// Runs a simulation from its beginning to the last frame, in whole steps of equal length or by an
/// adaptive method, and calls `visit` with the state at each frame.
///
/// Where no step ends at a frame, the state there is interpolated through the last three ends of
/// steps: positions by a polynomial of degree 8, from positions, velocities and accelerations, and
/// velocities by one of degree 5. No step is shortened, so the cost of a run does not depend on the
/// frames. Returns the blow-up, if there was one, and `None` if `go_on` returned false.
///
/// # Errors
/// The run fails for a reason other than a blow-up.
pub fn run(
    simulation: &mut Simulation,
    frames: &Frames,
    go_on: GoOn,
    visit: Option<Visit>,
) -> Result<Option<Option<BlowUp>>, Error> {
    let mut observer = visit.map(|visit| Observer {
        visit,
        clock: &|| Duration::ZERO,
        spent: Duration::ZERO,
        max_work: f64::INFINITY,
    });
    run_observed(simulation, frames, go_on, observer.as_mut())
}

/// Does what [`run`] does, with an observer that measures its own time.
#[expect(clippy::option_option, reason = "this is what `run` returns")]
pub(super) fn run_observed(
    simulation: &mut Simulation,
    frames: &Frames,
    go_on: GoOn,
    observer: Option<&mut Observer>,
) -> Result<Option<Option<BlowUp>>, Error> {
    let result = match (simulation.control().step(), observer) {
        (Some(step), Some(observer)) => in_steps(simulation, frames, step, go_on, observer),
        (Some(step), None) => to_step(simulation, frames, frames.steps(step), go_on),
        (None, observer) => to_a_tolerance(simulation, frames, go_on, observer),
    };
    let ended = result.and_then(|ended| {
        // The energy may have grown too large since its last check.
        if ended {
            simulation.conclude()?;
        }
        Ok(ended)
    });
    if let Some(failure) = simulation.model().system().take_failure() {
        return Err(failure);
    }
    match ended {
        Ok(true) => Ok(Some(None)),
        Ok(false) => Ok(None),
        Err(Error::BlowUp(lost)) => Ok(Some(Some(lost))),
        Err(error) => Err(error),
    }
}

/// Visits frames between the steps of an adaptive method. `false` if `go_on` returned false.
fn to_a_tolerance(
    simulation: &mut Simulation,
    frames: &Frames,
    go_on: GoOn,
    mut observer: Option<&mut Observer>,
) -> Result<bool, Error> {
    for k in 1..=frames.count {
        if !go_on() {
            return Ok(false);
        }
        let most = observer.as_ref().map(|observer| observer.max_work);
        // Between two frames of a system of one's own there may be any number of steps.
        while !simulation.advance_in(frames.time(k), MAX_PORTION.0)? {
            check_work(simulation, most)?;
            if !go_on() {
                return Ok(false);
            }
        }
        check_work(simulation, most)?;
        if let Some(observer) = &mut observer {
            observer.observe(|visit| visit(&at_end(simulation, k)));
        }
    }
    Ok(true)
}

/// Checks that a run has not taken more work than this (evaluations).
fn check_work(run: &Simulation, most: Option<f64>) -> Result<(), Error> {
    match most.filter(|most| run.work().total() > *most) {
        None => Ok(()),
        Some(most) => Err(Error::BlowUp(BlowUp {
            method: run.method().title,
            control: run.control(),
            step: run.steps(),
            time: run.time(),
            cause: Cause::TooCostly { most },
        })),
    }
}

/// Returns the state of a run that has arrived at a frame.
fn at_end(run: &Simulation, frame: u64) -> FrameState<'_> {
    FrameState { frame, run, state: run.state(), within: None }
}

/// Advances to the end of step n, counted from the beginning. `false` if `go_on` returned false.
fn to_step(
    simulation: &mut Simulation,
    frames: &Frames,
    n: u64,
    go_on: GoOn,
) -> Result<bool, Error> {
    let last = simulation.control().step().map(|step| frames.steps(step));
    let most = ((MAX_PORTION.1 / simulation.model().work()) as u64).clamp(1, MAX_PORTION.0);
    while simulation.steps() < n {
        if !go_on() {
            return Ok(false);
        }
        let mut portion = (n - simulation.steps()).min(most);
        // The last step ends at the last frame, so rounding leaves no tiny step.
        if last == Some(simulation.steps() + portion) {
            portion -= 1;
            simulation.take_steps(portion)?;
            simulation.advance_to(frames.until)?;
        } else {
            simulation.take_steps(portion)?;
        }
    }
    Ok(true)
}

/// End of a step: the number of the step, its time (s), the state y and f(t, y) there.
struct StepEnd {
    number: u64,
    t: f64,
    y: Vec<f64>,
    f: Vec<f64>,
}

/// Visits frames between fixed steps. `false` if `go_on` returned false.
fn in_steps(
    simulation: &mut Simulation,
    frames: &Frames,
    step: f64,
    go_on: GoOn,
    observer: &mut Observer,
) -> Result<bool, Error> {
    let last = frames.steps(step);
    let (mut ends, mut state) = (vec![], simulation.state().to_vec());
    for k in 1..=frames.count {
        let time = frames.time(k);
        let steps = time / step;
        let nearest = steps.round();
        if (steps - nearest).abs() < FRAME_TOLERANCE * steps.max(1.0) || k == frames.count {
            let n = (nearest as u64).min(last);
            // For interpolation, the run may already be beyond this frame.
            if n >= simulation.steps() {
                let n = if k == frames.count { last } else { n };
                if !to_step(simulation, frames, n, go_on)? {
                    return Ok(false);
                }
                observer.observe(|visit| visit(&at_end(simulation, k)));
                continue;
            }
        }
        // Both ends of the step that encloses the frame, and one end before them if there is one.
        let begun = (steps.floor() as u64).min(last);
        let oldest = begun.saturating_sub(1).min((last + 1).saturating_sub(NODES));
        let at = oldest.max(simulation.steps());
        if !to_step(simulation, frames, at, go_on)? {
            return Ok(false);
        }
        if ends.last().is_none_or(|end: &StepEnd| end.number != at) {
            ends.clear();
            observer.observe(|_| remember_end(&mut ends, simulation));
        }
        let newest = (begun + 1).max(ends[0].number + NODES - 1).min(last);
        while simulation.steps() < newest {
            let next = simulation.steps() + 1;
            if !to_step(simulation, frames, next, go_on)? {
                return Ok(false);
            }
            observer.observe(|_| remember_end(&mut ends, simulation));
        }
        observer.observe(|visit| {
            interpolate(simulation, &ends, time, &mut state);
            let far = |end: &&StepEnd| (end.t - time).abs();
            let nearest = ends.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
            visit(&FrameState {
                frame: k,
                run: simulation,
                state: &state,
                within: nearest.map(|end| EnclosingStep {
                    times: [begun, begun + 1].map(|n| (n as f64 * step).min(frames.until)),
                    nearest: (end.t, &end.y[..]),
                }),
            });
        });
    }
    Ok(true)
}

/// Remembers the state at the end of the last step, in place of the oldest if there are enough.
fn remember_end(ends: &mut Vec<StepEnd>, simulation: &Simulation) {
    let y = simulation.state();
    let mut end = if ends.len() < NODES as usize {
        StepEnd { number: 0, t: 0.0, y: y.to_vec(), f: y.to_vec() }
    } else {
        ends.remove(0)
    };
    (end.number, end.t) = (simulation.steps(), simulation.time());
    end.y.copy_from_slice(y);
    let system = simulation.model().system();
    system.eval_f(end.t, &end.y, &mut end.f);
    ends.push(end);
}

/// Interpolates the state at a time (s) between the ends of steps, and writes it to `state`.
fn interpolate(simulation: &Simulation, ends: &[StepEnd], time: f64, state: &mut [f64]) {
    let system = simulation.model().system();
    // Times are in units of a step, so that the weights are of ordinary size.
    let (first, last) = (&ends[0], &ends[ends.len() - 1]);
    let unit = ((last.t - first.t) / (ends.len().max(2) - 1) as f64).max(f64::MIN_POSITIVE);
    let nodes: Vec<_> = ends.iter().map(|end| (end.t - first.t) / unit).collect();
    let at = (time - first.t) / unit;
    let powers = [1.0, unit, unit * unit];
    let mut combine = |out: std::ops::Range<usize>, count: usize| {
        let (weights, half) = (weights(&nodes, count, at), state.len() / 2);
        state[out.clone()].fill(0.0);
        for (k, weight) in weights.iter().enumerate() {
            let (end, derivative) = (&ends[k / count], k % count);
            let from = match derivative {
                0 => &end.y[out.clone()],
                1 => &end.f[out.clone()],
                _ => &end.f[out.start + half..out.end + half],
            };
            for (state, from) in state[out.clone()].iter_mut().zip(from) {
                *state += weight * powers[derivative] * from;
            }
        }
    };
    let dim = system.dim();
    if system.mechanics().is_some() {
        combine(0..dim / 2, 3);
        combine(dim / 2..dim, 2);
        system.hold(time, state);
    } else {
        combine(0..dim, 2);
    }
}
