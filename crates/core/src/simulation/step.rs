//! A step of a run.
//!
//! It has five phases: *integrate* (the method takes the state from t to t + h), *shorten* (springs
//! that are too long), *contact* (particles leave obstacles, surfaces do not pass through one
//! another), *watch* (blow-ups, and the balance of energy) and *tear* (springs that are stretched
//! too far). Fixed and adaptive steps share them. They differ in two questions: whether a step ends
//! at the first event within it, and whether it is taken again, shorter (see
//! [`retry`](super::retry)).

use super::bounds::Bounds;
use super::depths::{Depths, NONE};
use super::events::{Event, EventKind};
use super::failure::{Failure, cause_of};
use super::located::Locator;
use super::phases::{Phases, Settled};
use super::power::{End, energy_of};
use super::reach::{Part, Reach};
use super::retry::{MIN_RETRY_SHARE, MIN_RETRY_STEP, limit_next, share_of_bulge, share_of_retry};
use super::state::RunState;
use super::stepper::Stepper;
use super::watch::Watch;
use crate::control::Control;
use crate::error::{Cause, Error};
use crate::scene::{Model, Scene, StepLimits};
use crate::system::ParticleSystem;

/// Share of a step by which its end may miss a time that is asked for: 1/60 s written as 0.01666667
/// meets sixty frames a second.
pub(super) const SLIVER: f64 = 1e-6;

/// Price of a sweep over the springs that a limit of strain applies to, in evaluations.
const SWEEP: f64 = 2.0;

/// Price of a plane between two surfaces, in evaluations of one particle on springs.
const PLANE: f64 = 7.0;

/// Pipeline of the phases of a step.
pub(super) struct Pipeline {
    pub stepper: Stepper,
    pub phases: Phases,
    pub locator: Locator,
    pub watch: Watch,
    pub bounds: Bounds,
    limits: StepLimits,
}

impl Pipeline {
    /// Pipeline for steps of a scene.
    pub fn new(stepper: Stepper, scene: &Scene) -> Self {
        let (middle, radius) = scene.extent();
        Self {
            stepper,
            phases: Phases::new(scene.model.system().dim()),
            locator: Locator::new(&scene.model),
            watch: Watch::new(radius, scene.limits),
            bounds: Bounds { middle, radius },
            limits: scene.limits,
        }
    }

    /// Takes a step from the end of the last one: in parts, where a fixed step that locates events
    /// meets some.
    ///
    /// # Errors
    /// The run is lost at the end of the step, or the step failed.
    pub fn step(&mut self, model: &mut Model, state: &mut RunState) -> Result<(), Failure> {
        let mut begin = state.end();
        let whole = state.control.step();
        let target = whole.map(|h| state.since + (state.taken + 1) as f64 * h);
        loop {
            if let Model::Network(network) = model {
                network.list_strained();
            }
            self.watch.begin_step(model, begin, &state.y);
            let (cause, part) = match self.integrate_and_settle(model, state, begin, target)? {
                Err(cause) => (Some(cause), Part::of(begin, whole.unwrap_or(0.0))),
                Ok((part, settled)) => (self.end_part(model, state, part.end, &settled), part),
            };
            let is_last =
                cause.is_some() || !self.locator.cuts(&self.stepper) || target == Some(part.end);
            state.steps += u64::from(is_last);
            if let Some(cause) = cause {
                let time = part.end;
                return Err(Failure::Lost { cause, time });
            }
            if whole.is_none() {
                state.set_time(part.end);
            } else if is_last {
                state.taken += 1;
            }
            if is_last {
                return Ok(());
            }
            self.tear(model, state);
            begin = part.end;
        }
    }

    /// Takes a step from time t (s), and settles its end; again and shorter, if an adaptive method
    /// has to. One that locates events ends at the first of them; a fixed one ends at `target` at
    /// the latest. Returns the step, or the cause of a blow-up.
    fn integrate_and_settle(
        &mut self,
        model: &Model,
        state: &mut RunState,
        t: f64,
        target: Option<f64>,
    ) -> Result<Result<(Part, Settled), Cause>, Error> {
        let is_adaptive = self.stepper.is_adaptive();
        let depths = Depths::new(self.bounds.radius, self.limits, state.control);
        let locates = self.locator.serves(&self.stepper);
        let reach = if locates {
            Reach::of_step(model, self.limits, is_adaptive, t, target)
        } else {
            Reach::default()
        };
        self.locator
            .list_rests(model, state, &mut self.stepper, t, depths);
        loop {
            let resting = self.locator.view(model);
            let system = resting.as_ref().map_or(model.system(), |view| view);
            self.phases.begin(model, &state.y, locates);
            let control = match state.control {
                // What rounding leaves of a step is no part of its own.
                Control::Step(h) if reach.longest <= h * (1.0 + SLIVER) => {
                    Control::Step(reach.longest)
                }
                control => control,
            };
            let y = &mut state.y;
            let taken = match self.stepper.integrate(system, control, t, reach.longest, y) {
                Ok(taken) => taken,
                Err(error) => return cause_of(error, model.particles()).map(Err),
            };
            state.work += taken.work;
            let mut part = reach.part(t, taken.h);
            let event = if locates {
                let (stepper, y0) = (&mut self.stepper, self.phases.y0());
                self.locator
                    .first_event(model, state, stepper, y0, (t, taken.h), depths)
            } else {
                None
            };
            match event {
                Some(Event {
                    kind: EventKind::Sunk,
                    share,
                }) if taken.h > MIN_RETRY_STEP && is_adaptive => {
                    self.take_again(state, taken.h, MIN_RETRY_SHARE.max(0.9 * share));
                    continue;
                }
                Some(Event { kind, share }) if !matches!(kind, EventKind::Sunk) => {
                    part = Part::of(t, share * taken.h);
                    state.y.copy_from_slice(self.locator.state());
                    if let (EventKind::Touch { .. }, Some(network)) = (kind, model.network()) {
                        let times = (part.end, part.h);
                        self.phases.strike(network, times, depths, &mut state.y);
                    }
                }
                _ => {}
            }
            let bulge = if is_adaptive && state.method.implicit {
                self.phases.bulge(model, (t, part.h), &state.y)
            } else {
                0.0
            };
            if let Some(share) = share_of_bulge(bulge, part.h) {
                self.take_again(state, part.h, share);
                continue;
            }
            let (order, t1, y) = (state.method.order, part.end, &state.y[..]);
            let end = End { order, t: t1, y };
            if let Some(cause) = self.watch.look_before_guard(model, &state.balance, end) {
                return Ok(Err(cause));
            }
            let settled = match self.phases.settle(model, (t, part.h), &mut state.y) {
                Ok(settled) => settled,
                Err(cause) => return Ok(Err(cause)),
            };
            let planes = PLANE * settled.met.guarded.planes as f64 / model.work();
            state.work.algebra += SWEEP * settled.strained.sweeps as f64 + planes;
            if let Stepper::Adaptive(adaptive) = &mut self.stepper {
                if let Some(share) = share_of_retry(&settled, part.h, depths) {
                    self.take_again(state, part.h, share);
                    continue;
                }
                limit_next(adaptive, &settled, bulge, part.h, depths);
                if part.is_cut {
                    adaptive.restart();
                }
            }
            if part.is_cut
                && let Some(network) = model.network()
            {
                network.hold(part.end, &mut state.y);
            }
            state.guarded += settled.met.guarded;
            return Ok(Ok((part, settled)));
        }
    }

    /// Goes back to the beginning of a step of h (s), of which that share is taken next.
    fn take_again(&mut self, state: &mut RunState, h: f64, share: f64) {
        state.y.copy_from_slice(self.phases.y0());
        if let Stepper::Adaptive(adaptive) = &mut self.stepper {
            adaptive.restart();
            adaptive.try_first(h * share);
        }
        state.work.rejections += 1;
    }

    /// Notes the end of a part of a step at time t (s). Returns why the run is lost, if it is.
    fn end_part(
        &mut self,
        model: &Model,
        state: &mut RunState,
        t: f64,
        settled: &Settled,
    ) -> Option<Cause> {
        let lost = self.bounds.lost(model, &state.y);
        let RunState { y, balance, .. } = state;
        let order = state.method.order;
        let end = End { order, t, y };
        self.watch.end_step(model, balance, end, &settled.met, lost)
    }

    /// Breaks what is stretched too far at the end of a step, or was located to be there: that
    /// changes the energy. The run is there: a state that is shown within the step still has what
    /// breaks at its end.
    pub fn tear(&mut self, model: &mut Model, state: &mut RunState) {
        let share = if self.locator.serves(&self.stepper) {
            NONE
        } else {
            0.0
        };
        let (t, y) = (state.end(), &state.y);
        if let Model::Network(network) = model
            && network.is_overstretched(network.halves(y).0, share)
        {
            let before = energy_of(network, t, y).total();
            network.tear(network.halves(y).0, share);
            let after = energy_of(network, t, y).total();
            state.balance.allow(after - before);
            self.watch.forget_power();
            self.stepper.forget();
            self.stepper.refit(state.method, model.system());
        }
    }
}
