//! Runs that are looked at in frames, at whatever times their steps end.

use std::time::Duration;

use super::frames::{Frames, GoOn};
use super::hermite::weights;
use crate::error::{BlowUp, Error};
use crate::simulation::Simulation;

/// Share of a step by which its end may miss a frame and yet count as the frame.
const CLOSE: f64 = 1e-9;
/// Number of ends of steps through which states between them are interpolated.
const NODES: u64 = 3;
/// Most steps between two questions whether to go on, and most of their work.
const PORTION: (u64, f64) = (1000, 4e5);

/// Look at a run.
#[derive(Clone, Copy)]
pub struct Look<'a> {
    /// Number of the frame, counted from 1.
    pub frame: u64,
    /// The run, which may be past the frame.
    pub run: &'a Simulation,
    /// State at the frame.
    pub state: &'a [f64],
    /// Step that the frame is within, where none ends at the frame, and the state there is
    /// interpolated.
    pub within: Option<Between<'a>>,
}

/// Step between two frames or around one.
#[derive(Clone, Copy)]
pub struct Between<'a> {
    /// Times at its beginning and its end (s).
    pub times: [f64; 2],
    /// Time (s) and state at the nearest end of a step.
    pub nearest: (f64, &'a [f64]),
}

/// Use of a look.
pub type Visit<'a> = &'a mut dyn FnMut(&Look);

/// Looks at a run, and the time that they take, which is not the run's.
pub(super) struct Looks<'a> {
    pub(super) visit: Visit<'a>,
    /// The time that has passed since some moment.
    pub(super) clock: &'a dyn Fn() -> Duration,
    pub(super) spent: Duration,
}

impl Looks<'_> {
    /// Does what only a look needs.
    fn look(&mut self, work: impl FnOnce(&mut dyn FnMut(&Look))) {
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
/// velocities by one of degree 5. No step is shortened, so the run costs the same whatever the
/// frames. Returns the blow-up, if the run was lost, and `None` if `go_on` returned false.
///
/// # Errors
/// The run cannot go on for a reason other than a blow-up.
pub fn run(
    simulation: &mut Simulation,
    frames: &Frames,
    go_on: GoOn,
    visit: Option<Visit>,
) -> Result<Option<Option<BlowUp>>, Error> {
    let mut looks = visit.map(|visit| Looks {
        visit,
        clock: &|| Duration::ZERO,
        spent: Duration::ZERO,
    });
    looked_at(simulation, frames, go_on, looks.as_mut())
}

/// As [`run`], with the time of its looks.
#[expect(clippy::option_option, reason = "this is what `run` returns")]
pub(super) fn looked_at(
    simulation: &mut Simulation,
    frames: &Frames,
    go_on: GoOn,
    looks: Option<&mut Looks>,
) -> Result<Option<Option<BlowUp>>, Error> {
    let result = match (simulation.control().step(), looks) {
        (Some(step), Some(looks)) => in_steps(simulation, frames, step, go_on, looks),
        (Some(step), None) => to_step(simulation, frames, frames.steps(step), go_on),
        (None, looks) => to_a_tolerance(simulation, frames, go_on, looks),
    };
    let ended = result.and_then(|ended| {
        // It may have been lost since the last look at its energy.
        if ended {
            simulation.conclude()?;
        }
        Ok(ended)
    });
    match ended {
        Ok(true) => Ok(Some(None)),
        Ok(false) => Ok(None),
        Err(Error::BlowUp(lost)) => Ok(Some(Some(lost))),
        Err(error) => Err(error),
    }
}

/// Visits frames between the steps of an adaptive method. `false` if it was told to stop.
fn to_a_tolerance(
    simulation: &mut Simulation,
    frames: &Frames,
    go_on: GoOn,
    mut looks: Option<&mut Looks>,
) -> Result<bool, Error> {
    for k in 1..=frames.count {
        if !go_on() {
            return Ok(false);
        }
        simulation.advance_to(frames.time(k))?;
        if let Some(looks) = &mut looks {
            looks.look(|visit| visit(&at_end(simulation, k)));
        }
    }
    Ok(true)
}

/// Look at a run that is at a frame.
fn at_end(run: &Simulation, frame: u64) -> Look<'_> {
    Look {
        frame,
        run,
        state: run.state(),
        within: None,
    }
}

/// Goes on to the end of step n, counted from the beginning. `false` if it was told to stop.
fn to_step(
    simulation: &mut Simulation,
    frames: &Frames,
    n: u64,
    go_on: GoOn,
) -> Result<bool, Error> {
    let last = simulation.control().step().map(|step| frames.steps(step));
    let most = ((PORTION.1 / simulation.model().work()) as u64).clamp(1, PORTION.0);
    while simulation.steps() < n {
        if !go_on() {
            return Ok(false);
        }
        let mut portion = (n - simulation.steps()).min(most);
        // The last step ends at the last frame, whatever rounding or a sliver of time is left.
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
struct End {
    number: u64,
    t: f64,
    y: Vec<f64>,
    f: Vec<f64>,
}

/// Visits frames between fixed steps. `false` if it was told to stop.
fn in_steps(
    simulation: &mut Simulation,
    frames: &Frames,
    step: f64,
    go_on: GoOn,
    looks: &mut Looks,
) -> Result<bool, Error> {
    let last = frames.steps(step);
    let (mut ends, mut state) = (vec![], simulation.state().to_vec());
    for k in 1..=frames.count {
        let time = frames.time(k);
        let steps = time / step;
        let nearest = steps.round();
        if (steps - nearest).abs() < CLOSE * steps.max(1.0) || k == frames.count {
            let n = (nearest as u64).min(last);
            // A state past this one may be kept for interpolation.
            if n >= simulation.steps() {
                let n = if k == frames.count { last } else { n };
                if !to_step(simulation, frames, n, go_on)? {
                    return Ok(false);
                }
                looks.look(|visit| visit(&at_end(simulation, k)));
                continue;
            }
        }
        // Ends before and after the frame, and one more before these if there is one.
        let begun = (steps.floor() as u64).min(last);
        let oldest = begun
            .saturating_sub(1)
            .min((last + 1).saturating_sub(NODES));
        let at = oldest.max(simulation.steps());
        if !to_step(simulation, frames, at, go_on)? {
            return Ok(false);
        }
        if ends.last().is_none_or(|end: &End| end.number != at) {
            ends.clear();
            looks.look(|_| keep(&mut ends, simulation));
        }
        let newest = (begun + 1).max(ends[0].number + NODES - 1).min(last);
        while simulation.steps() < newest {
            let next = simulation.steps() + 1;
            if !to_step(simulation, frames, next, go_on)? {
                return Ok(false);
            }
            looks.look(|_| keep(&mut ends, simulation));
        }
        looks.look(|visit| {
            interpolate(simulation, &ends, time, &mut state);
            let far = |end: &&End| (end.t - time).abs();
            let nearest = ends.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
            visit(&Look {
                frame: k,
                run: simulation,
                state: &state,
                within: nearest.map(|end| Between {
                    times: [begun, begun + 1].map(|n| (n as f64 * step).min(frames.until)),
                    nearest: (end.t, &end.y[..]),
                }),
            });
        });
    }
    Ok(true)
}

/// Keeps the state at the end of the last step, and forgets the oldest one of too many.
fn keep(ends: &mut Vec<End>, simulation: &Simulation) {
    let y = simulation.state();
    let mut end = if ends.len() < NODES as usize {
        End {
            number: 0,
            t: 0.0,
            y: y.to_vec(),
            f: y.to_vec(),
        }
    } else {
        ends.remove(0)
    };
    (end.number, end.t) = (simulation.steps(), simulation.time());
    end.y.copy_from_slice(y);
    let system = simulation.model().system();
    system.eval_f(end.t, &end.y, &mut end.f);
    ends.push(end);
}

/// Writes the state at a time (s) within the steps whose ends are given to `state`.
fn interpolate(simulation: &Simulation, ends: &[End], time: f64, state: &mut [f64]) {
    let system = simulation.model().system();
    // Times in units of a step, so that the weights are of ordinary size.
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
