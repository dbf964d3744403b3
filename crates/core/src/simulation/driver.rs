//! Driver of a run, which takes whole steps only. If a requested time is within a step, the run
//! continues to the end of that step, and the state at the time is interpolated by the step's
//! polynomial. How often a run is shown therefore does not change it.

use serde::{Deserialize, Serialize};

use super::balance::Balance;
use super::failure::Failure;
use super::power::End;
use super::reach::STEP_END_TOLERANCE;
use super::state::RunState;
use super::step::Pipeline;
use super::stepper::Stepper;
use super::within::{Span, Within};
use crate::control::Control;
use crate::error::Error;
use crate::integrators::AdaptiveState;
use crate::network::{next_break, pass_to};
use crate::scene::Model;
use crate::threads::among_threads;

/// Progress of a run within a step, and the memory of an adaptive method.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// Memory of an adaptive method.
    pub method: Option<AdaptiveState>,
    /// Step that contains the time shown, if one does.
    pub within: Option<Span>,
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
        self.pipeline.watch.resume();
        self.pipeline.phases.contact.forget_impulses();
        Ok(())
    }

    /// Forgets the last step, because the run continues from another state.
    pub fn forget(&mut self) {
        self.within.leave();
        self.pipeline.stepper.forget();
        self.pipeline.watch.resume();
        self.pipeline.phases.contact.forget_impulses();
    }

    /// Returns the progress of the run: all of it or, without `whole`, only what a new step needs.
    pub fn progress(&self, whole: bool) -> Progress {
        Progress {
            method: self.pipeline.stepper.memory(whole),
            within: self.within.span().filter(|_| whole),
        }
    }

    /// Returns whether the time shown is within a step.
    pub fn is_within(&self) -> bool {
        self.within.times().is_some()
    }

    /// Returns the balance of energy at the end of the last step.
    pub fn balance(&self, model: &Model, state: &RunState) -> Balance {
        let (watch, end) = (&self.pipeline.watch, self.last_end(state));
        watch.balance_at(model, state.balance, end).0
    }

    /// Checks the energy at the end of the last step.
    ///
    /// # Errors
    /// The run has blown up.
    pub fn conclude(&self, model: &Model, state: &RunState) -> Result<(), Failure> {
        let (watch, end) = (&self.pipeline.watch, self.last_end(state));
        match watch.balance_at(model, state.balance, end).1 {
            Some(cause) => Err(Failure::BlowUp { cause, time: end.t }),
            None => Ok(()),
        }
    }

    /// Returns the end of the last step.
    fn last_end<'a>(&'a self, state: &'a RunState) -> End<'a> {
        let within = self.within.end();
        let (t, y) = within.unwrap_or_else(|| (state.time(), &state.y));
        let order = state.method.order;
        End { order, t, y }
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
    ) -> Result<(), Failure> {
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

    /// Takes steps up to `time` (s), and shows the state there.
    ///
    /// # Errors
    /// The run blew up, or a step failed.
    pub fn advance_to(
        &mut self,
        model: &mut Model,
        state: &mut RunState,
        time: f64,
    ) -> Result<(), Failure> {
        among_threads(model.particles(), || self.advance(model, state, time))
    }

    fn advance(
        &mut self,
        model: &mut Model,
        state: &mut RunState,
        time: f64,
    ) -> Result<(), Failure> {
        loop {
            let step = self.pipeline.stepper.step_size(state.control);
            // Where nothing accelerates, an adaptive method takes steps far beyond the time.
            let sliver = STEP_END_TOLERANCE * step.unwrap_or(0.0).min(time.abs());
            if let Some(end) = self.within.until() {
                if time <= state.time() {
                    return Ok(());
                }
                if time < end - sliver {
                    self.show(model, state, time);
                    return Ok(());
                }
                self.arrive(model, state);
            }
            let begin = state.end();
            if time <= begin + sliver {
                if time >= begin - sliver {
                    // The last step ends there, except for rounding.
                    state.shown = Some(time).filter(|time| *time != begin);
                }
                return Ok(());
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
                return Ok(());
            }
            self.pipeline.end_step(model, state);
        }
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
    fn show(&mut self, model: &mut Model, state: &mut RunState, time: f64) {
        let Some([begin, end]) = self.within.times() else {
            return;
        };
        pass_model_to(model, begin);
        let fixed = model.network().filter(|_| state.control.step().is_some());
        let breaks = fixed.is_some_and(|it| next_break(it, begin, state.sliver()) < end);
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
            phases.settle_shown(network, (begin, time - begin), knows_contact, y);
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
        let mut succeeds = true;
        while succeeds && t < time {
            let Pipeline {
                stepper, phases, ..
            } = &mut self.pipeline;
            let next = model.network().map(|it| next_break(it, t, state.sliver()));
            let y = &mut state.y;
            let end = next.unwrap_or(time).min(time);
            phases.begin(model, y, false);
            let step = Control::Step(end - t);
            let taken = stepper.integrate(model.system(), step, t, end - t, y);
            let settled = phases.settle(model, (t, end - t), y);
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
