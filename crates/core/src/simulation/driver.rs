//! Driver of a run, which takes whole steps only. If a requested time is within a step, the run
//! continues to the end of that step, and the state at the time is interpolated by the step's
//! polynomial. How often a run is shown therefore does not change it.
//!
//! The step that contains the time shown: states at its ends, and a polynomial between them.
//!
//! In a fixed step, positions are the polynomial of degree 5 through the positions, velocities and
//! accelerations at both ends, and velocities are its derivative (Hermite interpolation: Hairer,
//! Norsett, Wanner, *Solving Ordinary Differential Equations I*, 1993, II.6); its error is of order
//! h^6. After an impact, or in a step that is long compared with the fastest motion, the polynomial
//! oscillates: its acceleration in the middle of the step differs from that of the system, and a
//! straight line replaces it.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::balance::Balance;
use super::power::End;
use super::reach::{Reach, STEP_END_TOLERANCE, begin_of, next_change};
use super::state::RunState;
use super::step::{Pipeline, StepFailure};
use super::stepper::Stepper;
use super::watch::Watched;
use crate::control::Control;
use crate::error::Error;
use crate::integrators::AdaptiveState;
use crate::interval::Interval;
use crate::network::pass_to;
use crate::scene::Model;
use crate::system::ParticleSystem;
use crate::threads::among_threads;

/// Progress of a run within a step, and the memory of an adaptive method.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// Memory of an adaptive method.
    pub method: Option<AdaptiveState>,
    /// Step that contains the time shown, if one does.
    pub within: Option<Span>,
    /// Memory of the watch over the run.
    pub watched: Option<Box<Watched>>,
}

/// Driver of a run.
pub(super) struct Driver {
    pub pipeline: Pipeline,
    within: Within,
}

impl Driver {
    /// Creates a driver at the beginning of a run.
    pub fn new(pipeline: Pipeline) -> Self {
        let within = Within::default();
        Self { pipeline, within }
    }

    /// Continues with another stepper from the time shown.
    pub fn change_stepper(&mut self, stepper: Stepper) {
        self.pipeline.stepper = stepper;
        self.within.leave();
    }

    /// Continues with another stepper, from saved progress in a system of that dimension.
    ///
    /// # Errors
    /// The progress is of another method or of another system.
    pub fn resume(
        &mut self,
        mut stepper: Stepper,
        progress: &Progress,
        dim: usize,
    ) -> Result<(), Error> {
        stepper.resume(progress.method.as_ref())?;
        self.within = Within::of(progress.within.as_ref(), dim)?;
        self.pipeline.stepper = stepper;
        self.pipeline.watch.forget();
        self.pipeline.phases.contact.forget_impulses();
        Ok(())
    }

    /// Continues the watch over the run from the saved progress.
    pub fn watch_again(&mut self, model: &Model, state: &RunState, progress: &Progress) {
        if let Some(watched) = &progress.watched {
            let Self { pipeline, within } = self;
            let end = last_end(within, state);
            pipeline.watch.resume(model, end, watched);
        }
    }

    /// Forgets the last step, because the run continues from another state.
    pub fn forget(&mut self) {
        self.within.leave();
        self.pipeline.stepper.forget();
        self.pipeline.watch.forget();
        self.pipeline.phases.contact.forget_impulses();
    }

    /// Returns the progress of the run: all of it or, without `whole`, only what a new step needs.
    pub fn progress(&self, whole: bool) -> Progress {
        Progress {
            method: self.pipeline.stepper.memory(whole),
            within: self.within.span().filter(|_| whole),
            watched: whole.then(|| Box::new(self.pipeline.watch.watched())),
        }
    }

    /// Returns whether the time shown is within a step.
    pub fn is_within(&self) -> bool {
        self.within.times().is_some()
    }

    /// Returns the balance of energy at the end of the last step.
    pub fn balance(&self, model: &Model, state: &RunState) -> Balance {
        let (watch, end) = (&self.pipeline.watch, last_end(&self.within, state));
        watch.balance_at(model, state.balance, end).0
    }

    /// Checks the energy at the end of the last step.
    ///
    /// # Errors
    /// The run has blown up.
    pub fn conclude(&self, model: &Model, state: &RunState) -> Result<(), StepFailure> {
        let (watch, end) = (&self.pipeline.watch, last_end(&self.within, state));
        match watch.balance_at(model, state.balance, end).1 {
            Some(cause) => Err(StepFailure::BlowUp { cause, time: end.t }),
            None => Ok(()),
        }
    }

    /// Takes `count` steps. If the time shown is within a step, that step is finished first, and
    /// counts.
    ///
    /// # Errors
    /// The run blew up, or a step failed.
    pub fn take_steps(
        &mut self,
        model: &mut Model,
        state: &mut RunState,
        count: u64,
    ) -> Result<(), StepFailure> {
        among_threads(model.particles(), || {
            for _ in 0..count {
                if !self.arrive(model, state) {
                    self.pipeline.step(model, state)?;
                    self.pipeline.end_step(model, state);
                }
            }
            Ok(())
        })
    }

    /// Takes at most `count` whole steps and one more towards `time` (s), and shows the state there
    /// if it is reached. Returns whether it is.
    ///
    /// # Errors
    /// The run blew up, or a step failed.
    pub fn advance(
        &mut self,
        model: &mut Model,
        state: &mut RunState,
        (time, count): (f64, u64),
    ) -> Result<bool, StepFailure> {
        let particles = model.particles();
        among_threads(particles, || self.advance_here(model, state, (time, count)))
    }

    fn advance_here(
        &mut self,
        model: &mut Model,
        state: &mut RunState,
        (time, count): (f64, u64),
    ) -> Result<bool, StepFailure> {
        for _ in 0..=count {
            let step = self.pipeline.stepper.step_size(state.control);
            // Where nothing accelerates, an adaptive method takes steps far beyond the time.
            let sliver = STEP_END_TOLERANCE * step.unwrap_or(0.0).min(time.abs());
            if let Some(end) = self.within.until() {
                if time <= state.time() {
                    return Ok(true);
                }
                if time < end - sliver {
                    self.show(model, state, time);
                    return Ok(true);
                }
                self.arrive(model, state);
            }
            let begin = state.end();
            if time <= begin + sliver {
                if time >= begin - sliver {
                    // The last step ends there, except for rounding.
                    state.shown = Some(time).filter(|time| *time != begin);
                }
                return Ok(true);
            }
            state.shown = None;
            let ends_later = |h: f64| begin + h * (1.0 - STEP_END_TOLERANCE) > time;
            if state.control.step().is_some_and(ends_later) {
                self.within.begin(&state.y);
            }
            self.pipeline.step(model, state)?;
            let end = state.end();
            if ends_later(end - begin) {
                self.within.enter([begin, end], &state.y);
                self.show(model, state, time);
                return Ok(true);
            }
            self.pipeline.end_step(model, state);
        }
        Ok(false)
    }

    /// Takes a step, unless the time shown is within one and before its end, so that any time from
    /// the one shown to the end of the step can be [shown](Self::show). Returns both times (s).
    ///
    /// # Errors
    /// The run blew up, or the step failed.
    pub fn look_ahead(
        &mut self,
        model: &mut Model,
        state: &mut RunState,
    ) -> Result<[f64; 2], StepFailure> {
        let begin = state.time();
        if let Some(end) = self.within.until().filter(|end| begin < *end) {
            return Ok([begin, end]);
        }
        self.arrive(model, state);
        let begin = state.end();
        self.within.begin(&state.y);
        among_threads(model.particles(), || self.pipeline.step(model, state))?;
        self.within.enter([begin, state.end()], &state.y);
        Ok([begin, state.end()])
    }

    /// Finishes the step that contains the time shown. Returns whether there was one.
    fn arrive(&mut self, model: &mut Model, state: &mut RunState) -> bool {
        state.shown = None;
        let end = self.within.leave();
        let is_within = end.is_some();
        if let Some(end) = end {
            std::mem::swap(end, &mut state.y);
            // The step itself has let go of the pins within it.
            pass_model_to(model, state.end().next_down());
            self.pipeline.end_step(model, state);
        }
        is_within
    }

    /// Shows the state at a time (s) within the step: interpolated, then corrected for contact and
    /// pins as at the end of a step. If pins let go or jump in a fixed step, it is taken again up
    /// to there: no polynomial follows the motion past such a time.
    pub fn show(&mut self, model: &mut Model, state: &mut RunState, time: f64) {
        let Some([begin, end]) = self.within.times() else {
            return;
        };
        pass_model_to(model, begin);
        let (is_fixed, sliver) = (state.control.step().is_some(), state.sliver());
        let breaks = is_fixed
            && match model.network() {
                Some(_) => next_change(model, begin, sliver) < end,
                // f at the ends is not that between them.
                None => model.system().next_jump(begin) <= end + sliver,
            };
        if breaks && self.shorten_step(model, state, begin, time) {
            state.shown = Some(time);
            return;
        }
        let (system, network) = (model.system(), model.network());
        let y = &mut state.y;
        match &mut self.pipeline.stepper {
            Stepper::Fixed(_) => {
                let n = model.particles_with_velocities();
                self.within.interpolate((system, n), time, y);
            }
            Stepper::Adaptive(adaptive) => {
                state.work += adaptive.interpolate(system, time, y);
                system.hold(time, y);
            }
        }
        if let Some(network) = network {
            let knows_contact = !self.pipeline.stepper.is_adaptive();
            let phases = &self.pipeline.phases;
            let (t, h) = (begin, time - begin);
            let shown = Interval { t, h };
            phases.settle_shown(network, shown, knows_contact, y);
        }
        state.shown = Some(time);
    }

    /// Ends the step at the time shown, before the state or the system changes there: an adaptive
    /// step by its polynomial, a fixed step by a shorter one, whose end is as stable.
    pub fn stop(&mut self, model: &mut Model, state: &mut RunState) {
        let time = state.time();
        let end = self.within.until().unwrap_or(time);
        if let Some([begin, _]) = self.within.times() {
            if !self.pipeline.stepper.is_adaptive() {
                self.shorten_step(model, state, begin, time);
            }
            state.set_time(time);
        }
        state.shown = None;
        self.within.leave();
        self.pipeline.stepper.forget();
        self.pipeline.watch.disturb(model, state, time, end);
    }

    /// Takes the step that began at time t (s) again, up to a time (s): in parts, if pins let go or
    /// jump before. Returns whether that succeeded; if not, the state stays as it is.
    fn shorten_step(
        &mut self,
        model: &mut Model,
        state: &mut RunState,
        mut t: f64,
        time: f64,
    ) -> bool {
        let shown = std::mem::replace(&mut state.y, self.within.y0().to_vec());
        pass_model_to(model, t);
        t = begin_of(model, t, state.sliver());
        let mut succeeds = true;
        while succeeds && t < time {
            let Pipeline { stepper, phases, .. } = &mut self.pipeline;
            let next = next_change(model, t, state.sliver());
            let y = &mut state.y;
            let end = next.min(time);
            let h = match model.network() {
                None if end == next => Reach::up_to(t, end).longest,
                _ => end - t,
            };
            phases.begin(model, y, false);
            let taken = stepper.integrate(model.system(), Control::Step(h), t, h, y);
            let settled = phases.settle(model, Interval { t, h }, y);
            succeeds = taken.is_ok() && settled.is_ok() && y.iter().all(|y| y.is_finite());
            pass_model_to(model, end);
            self.pipeline.fit_at_jump(model, state, end);
            t = end;
        }
        pass_model_to(model, time);
        if !succeeds {
            state.y = shown;
        }
        succeeds
    }
}

/// Lets the pins of a model hold that hold at time t (s).
fn pass_model_to(model: &mut Model, t: f64) {
    if let Model::Network(network) = model {
        pass_to(network, t);
    }
}

/// Largest difference between the accelerations of the polynomial and of the system in the middle
/// of the step, over the largest acceleration at its ends; above it, a straight line replaces the
/// polynomial.
const MAX_UNEXPLAINED: f64 = 0.375;

/// Largest number of times that the middle of a step is checked: each straight line changes the
/// forces on other particles.
const MAX_ROUNDS: usize = 4;

/// Step that contains the time shown.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Span {
    /// Times of its beginning and its end (s).
    pub times: [f64; 2],
    /// States at its beginning, which only a fixed step needs, and at its end.
    pub ends: [Vec<f64>; 2],
}

/// Returns the end of the last step of a run.
fn last_end<'a>(within: &'a Within, state: &'a RunState) -> End<'a> {
    let (t, y) = (within.end()).unwrap_or_else(|| (state.time(), &state.y));
    let (order, is_adaptive) = (state.method.order, state.control.step().is_none());
    End { order, is_adaptive, t, y }
}

/// Step that contains the time shown, if one does.
#[derive(Default)]
pub(super) struct Within {
    /// Times of its beginning and its end (s).
    times: Option<[f64; 2]>,
    /// States at its beginning and its end.
    ends: [Vec<f64>; 2],
    /// Rates of change there; empty until a state between them is shown.
    rates: [Vec<f64>; 2],
    /// Whether each particle, and then each other number, follows its polynomial; empty until a
    /// state between the ends is shown.
    is_smooth: Vec<bool>,
    /// State and rates of change in the middle.
    middle: [Vec<f64>; 2],
}

impl Within {
    /// Returns the time at the end of the step (s), if the time shown is within one.
    pub fn until(&self) -> Option<f64> {
        self.times.map(|times| times[1])
    }

    /// Returns the time (s) and state at the end of the step, if the time shown is within one.
    pub fn end(&self) -> Option<(f64, &[f64])> {
        self.times.map(|times| (times[1], &self.ends[1][..]))
    }

    /// Returns the times of both ends of the step (s), if the time shown is within one.
    pub fn times(&self) -> Option<[f64; 2]> {
        self.times
    }

    /// Returns the state at the beginning of a fixed step.
    pub fn y0(&self) -> &[f64] {
        &self.ends[0]
    }

    /// Remembers the state at the beginning of a step that will contain the time shown.
    pub fn begin(&mut self, y0: &[f64]) {
        self.ends[0].clear();
        self.ends[0].extend_from_slice(y0);
    }

    /// Enters the step between these times (s), which ends at y1.
    pub fn enter(&mut self, times: [f64; 2], y1: &[f64]) {
        self.ends[1].clear();
        self.ends[1].extend_from_slice(y1);
        self.times = Some(times);
        self.is_smooth.clear();
    }

    /// Leaves the step, and returns the state at its end.
    pub fn leave(&mut self) -> Option<&mut Vec<f64>> {
        self.times.take().map(|_| &mut self.ends[1])
    }

    /// Writes the state at a time (s) within a fixed step to `out`: first positions and velocities
    /// of n particles, then other numbers.
    pub fn interpolate(
        &mut self,
        (system, n): (&dyn ParticleSystem, usize),
        time: f64,
        out: &mut [f64],
    ) {
        let Some([t0, t1]) = self.times else { return };
        if self.is_smooth.is_empty() {
            self.judge(system, n, [t0, t1]);
        }
        self.write(n, (time - t0) / (t1 - t0), t1 - t0, out);
        system.hold(time, out);
    }

    /// Finds the rates of change at both ends, and which numbers follow their polynomials.
    fn judge(&mut self, system: &dyn ParticleSystem, n: usize, [t0, t1]: [f64; 2]) {
        let ends = self.ends.iter().zip([t0, t1]);
        for ((y, t), rates) in ends.zip(&mut self.rates) {
            rates.resize(y.len(), 0.0);
            system.eval_f(t, y, rates);
        }
        let (h, dim) = (t1 - t0, self.ends[0].len());
        self.is_smooth.resize(n + (dim - 6 * n), true);
        let [mut y, mut f] = std::mem::take(&mut self.middle);
        y.resize(dim, 0.0);
        f.resize(dim, 0.0);
        for _ in 0..MAX_ROUNDS {
            self.write(n, 0.5, h, &mut y);
            system.hold(t0 + 0.5 * h, &mut y);
            system.eval_f(t0 + 0.5 * h, &y, &mut f);
            let swings_out = |k: &usize| {
                self.is_smooth[*k]
                    && if *k < n {
                        !self.is_explained((3 * n + k..6 * n).step_by(n), &f, h)
                    } else {
                        !self.is_explained(std::iter::once(5 * n + k), &f, h)
                    }
            };
            let out: Vec<_> = (0..self.is_smooth.len()).filter(swings_out).collect();
            if out.is_empty() {
                break;
            }
            for k in out {
                self.is_smooth[k] = false;
            }
        }
        self.middle = [y, f];
    }

    /// Returns whether the polynomials of these numbers have about the rates of change f in the
    /// middle of a step of h (s).
    fn is_explained(&self, numbers: impl Iterator<Item = usize>, f: &[f64], h: f64) -> bool {
        let ([y0, y1], [f0, f1]) = (&self.ends, &self.rates);
        let [mut missed, mut first, mut last] = [0.0; 3];
        for k in numbers {
            // The same for the polynomials of degree 5 and 3.
            let middle = 1.5 * (y1[k] - y0[k]) / h - 0.25 * (f0[k] + f1[k]);
            missed += (f[k] - middle).powi(2);
            first += f0[k].powi(2);
            last += f1[k].powi(2);
        }
        missed <= MAX_UNEXPLAINED.powi(2) * first.max(last)
    }

    /// Writes the state at the fraction theta of a step of h (s), without pins.
    fn write(&self, n: usize, theta: f64, h: f64, out: &mut [f64]) {
        for i in 0..n {
            self.move_particle(n, i, h, theta, out);
        }
        let ([y0, y1], [f0, f1]) = (&self.ends, &self.rates);
        for k in 6 * n..out.len() {
            let (value, slope) = ([y0[k], y1[k]], [h * f0[k], h * f1[k]]);
            out[k] = between(value, slope, theta, self.is_smooth[k - 5 * n]);
        }
    }

    /// Writes position and velocity of particle i of n at the fraction theta of a step of h (s).
    fn move_particle(&self, n: usize, i: usize, h: f64, theta: f64, out: &mut [f64]) {
        let row = |a: &[f64], first: usize| {
            Vector3::new(a[first + i], a[first + n + i], a[first + 2 * n + i])
        };
        let [x0, x1] = self.ends.each_ref().map(|y| row(y, 0));
        let [v0, v1] = self.ends.each_ref().map(|y| row(y, 3 * n) * h);
        let d = x1 - x0;
        let (x, v) = if self.is_smooth[i] {
            let [a0, a1] = self.rates.each_ref().map(|f| row(f, 3 * n) * (h * h));
            let c3 = 10.0 * d - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1;
            let c4 = -15.0 * d + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1;
            let c5 = 6.0 * d - 3.0 * (v0 + v1) - 0.5 * a0 + 0.5 * a1;
            let x =
                x0 + (v0 + (0.5 * a0 + (c3 + (c4 + c5 * theta) * theta) * theta) * theta) * theta;
            let v = v0 + (a0 + (3.0 * c3 + (4.0 * c4 + 5.0 * c5 * theta) * theta) * theta) * theta;
            (x, v)
        } else {
            (x0 + d * theta, v0 + (v1 - v0) * theta)
        };
        for axis in 0..3 {
            out[axis * n + i] = x[axis];
            out[(3 + axis) * n + i] = v[axis] / h;
        }
    }

    /// Returns the step, if the time shown is within one.
    pub fn span(&self) -> Option<Span> {
        self.times.map(|times| Span { times, ends: self.ends.clone() })
    }

    /// Creates the step of saved progress, in a system of that dimension.
    ///
    /// # Errors
    /// It is of another system, or its times are not those of a step.
    pub fn of(span: Option<&Span>, dim: usize) -> Result<Self, Error> {
        let mut within = Self::default();
        let Some(Span { times, ends }) = span else {
            return Ok(within);
        };
        let [t0, t1] = *times;
        if !(t0 < t1 && (t1 - t0).is_finite()) {
            return Err(Error::Invalid(format!(
                "a step must end after it begins, not begin at {t0} s and end at {t1} s"
            )));
        }
        for end in ends.iter().filter(|end| !end.is_empty()) {
            if end.len() != dim {
                return Err(Error::Dimension { expected: dim, found: end.len() });
            }
        }
        within.begin(&ends[0]);
        within.enter(*times, &ends[1]);
        Ok(within)
    }
}

/// Returns the value at the fraction theta of a step. It is on the polynomial of degree 3 if that
/// is smooth, else on a straight line.
fn between([y0, y1]: [f64; 2], [s0, s1]: [f64; 2], theta: f64, is_smooth: bool) -> f64 {
    let d = y1 - y0;
    if is_smooth {
        y0 + (s0 + (3.0 * d - 2.0 * s0 - s1 + (s0 + s1 - 2.0 * d) * theta) * theta) * theta
    } else {
        y0 + d * theta
    }
}
