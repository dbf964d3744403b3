//! A step of a run.
//!
//! It has five phases: *integrate* (the method takes the state from t to t + h), *shorten* (springs
//! that are too long), *contact* (particles leave obstacles, surfaces do not pass through one
//! another), *watch* (blow-ups, and the balance of energy) and *change* (springs that are stretched
//! too far break, liquid flows out, pins let go). Fixed and adaptive steps share them. They differ
//! in two respects: whether a step ends at the first event within it, and whether it is taken again
//! with a shorter length (see [`reach`](super::reach)).

use std::ops::Range;

use nalgebra::Vector3;

use super::depths::Depths;
use super::events::{Event, EventKind};
use super::locator::Locator;
use super::phases::{Phases, Settled};
use super::power::End;
use super::reach::{
    MIN_RETRY_SHARE, MIN_RETRY_STEP, Reach, STEP_END_TOLERANCE, StepPart, begin_of, limit_next,
    share_of_bulge, share_of_retry,
};
use super::state::RunState;
use super::stepper::Stepper;
use super::watch::Watch;
use crate::contact::SIMULTANEOUS_SHARE;
use crate::control::Control;
use crate::error::{Cause, Error, Unmet};
use crate::interval::Interval;
use crate::network::{Network, breaks_between, contradiction, has_ropes, jump_near, outflows};
use crate::refusal::Refusal;
use crate::rigid::{Body, ROTATION};
use crate::scene::{Model, Scene, StepLimits};
use crate::system::ParticleSystem;

/// Largest distance, over the scene's radius, that a particle flies in a step of an adaptive method
/// in which it may arrive somewhere.
const MAX_FLIGHT: f64 = 100.0;

/// Cost of a sweep over the springs with a limit of strain, in evaluations.
const SWEEP_PRICE: f64 = 2.0;

/// Cost of a separating plane between two surfaces, in evaluations of one particle on springs.
const PLANE_PRICE: f64 = 7.0;

/// Number of parts of a fixed step after which ropes tighten in it without rebounds.
const MAX_REBOUNDING_PARTS: usize = 100;

/// Largest number of parts of a fixed step: events within the last one are not located.
const MAX_PARTS: usize = 1000;

/// Largest number of parts into which rebounds divide a fixed step. In the last part, forces do not
/// see further rebounds.
const MAX_PARTS_AT_REBOUNDS: usize = 8;

/// Plan of a step.
#[derive(Clone, Copy)]
struct StepPlan {
    /// Time of its beginning (s).
    t: f64,
    reach: Reach,
    depths: Depths,
    /// Whether it ends at the first event within it.
    locates: bool,
    /// Whether it ends at the first rebound within it, of those found after the step.
    divides: bool,
}

/// Reason why an attempt at a step failed.
enum Setback {
    /// It was too long: that share of its length h (s) is tried next.
    Again { h: f64, share: f64 },
    /// A particle rebounds within it: it is taken up to that time (s), just after the rebound.
    Rebound { until: f64 },
    /// The run has blown up.
    BlowUp(Cause),
    /// Error that is no blow-up.
    Error(Error),
}

/// Pipeline of the phases of a step.
pub(super) struct Pipeline {
    pub stepper: Stepper,
    pub phases: Phases,
    pub locator: Locator,
    pub watch: Watch,
    pub bounds: SceneBounds,
    pub(super) limits: StepLimits,
}

impl Pipeline {
    /// Creates a pipeline for steps of a scene.
    pub fn new(stepper: Stepper, scene: &Scene) -> Self {
        let (middle, radius) = scene.extent();
        Self {
            stepper,
            phases: Phases::new(scene.model.system().dim()),
            locator: Locator::new(&scene.model),
            watch: Watch::new(radius, scene.limits),
            bounds: SceneBounds { middle, radius },
            limits: scene.limits,
        }
    }

    /// Takes a step from the end of the last one: in parts, if events split it.
    ///
    /// # Errors
    /// The run blew up in the step, or the step failed.
    pub fn step(&mut self, model: &mut Model, state: &mut RunState) -> Result<(), StepFailure> {
        let whole = state.control.step();
        let target = whole.map(|h| state.since + (state.taken + 1) as f64 * h);
        let sliver = state.sliver();
        let mut begin = begin_of(model, state.end(), sliver);
        let breaks = target.is_some_and(|target| match model.network() {
            Some(network) => breaks_between(network, [begin, target], sliver),
            None => model.system().next_jump(begin + sliver) <= target + sliver,
        });
        let divides = target.is_some() && may_rebound(model);
        let in_parts = breaks || self.locator.splits(&self.stepper) || divides;
        for number in 1.. {
            let rebounds = number <= MAX_REBOUNDING_PARTS;
            let divides = divides && number < MAX_PARTS_AT_REBOUNDS;
            if let Model::Network(network) = model {
                network.list_strained();
            }
            self.tighten(model, state, begin, rebounds);
            self.choose_taut(model, state, begin, false);
            self.watch.begin_step(model, begin, &state.y);
            let splits = [number < MAX_PARTS, divides];
            let span = (begin, target.filter(|_| in_parts));
            let taken = self.integrate_and_settle(model, state, span, splits)?;
            let (cause, part) = match taken {
                Err(cause) => (Some(cause), StepPart::of(begin, whole.unwrap_or(0.0))),
                Ok((mut part, settled)) => {
                    if !in_parts {
                        // Where the next step begins: t + h may differ in the last place.
                        part.end = target.unwrap_or(part.end);
                    }
                    if settled.met.impulse.max(settled.met.guarded.impulse) > 0.0 {
                        self.choose_taut(model, state, part.end, true);
                    }
                    let cause = self.end_part(model, state, part.end, &settled);
                    self.tighten(model, state, part.end, rebounds);
                    (cause, part)
                }
            };
            let is_last = cause.is_some() || !in_parts || target == Some(part.end);
            state.steps += u64::from(is_last);
            if let Some(cause) = cause {
                let time = part.end;
                return Err(StepFailure::BlowUp { cause, time });
            }
            if whole.is_none() {
                state.set_time(part.end);
            } else if is_last {
                state.taken += 1;
            }
            if is_last {
                break;
            }
            self.change_at(model, state, part.end);
            begin = part.end;
        }
        Ok(())
    }

    /// Takes a step from time t (s), and settles its end; an adaptive method may have to take it
    /// again with a shorter length. If events are located, the step ends at the first one if it
    /// `splits`; else, if it `divides`, at the first rebound. A fixed step in parts ends at
    /// `target` (s) at the latest. Returns the step, or the cause of a blow-up.
    fn integrate_and_settle(
        &mut self,
        model: &Model,
        state: &mut RunState,
        (t, target): (f64, Option<f64>),
        [splits, divides]: [bool; 2],
    ) -> Result<Result<(StepPart, Settled), Cause>, Error> {
        let flying = self.limits_of_flight(model, &state.y);
        let (stepper, limits) = (&mut self.stepper, self.limits);
        let depths = Depths::new(self.bounds.radius, limits, state.control);
        let locates = self.locator.serves(stepper);
        let network = model.network();
        // Where pins let go of springs alone, a part as short as a rounding error does no harm.
        let is_loose = network.is_some_and(|network| !network.is_constrained());
        let none = if is_loose { 0.0 } else { state.sliver() };
        let reach = match (locates, target) {
            (true, _) => Reach::of_step(model, flying, stepper.is_adaptive(), t, (target, none)),
            (false, Some(_)) => Reach::of_part(model, t, none, target),
            (false, None) => Reach::default(),
        };
        let reach = network.map_or(reach, |network| reach.before_jump(network, t, none));
        self.locator.list_rests(model, state, stepper, t, depths);
        let mut plan =
            StepPlan { t, reach, depths, locates: locates && splits, divides: divides && !locates };
        loop {
            match self.attempt(model, state, plan) {
                Ok(taken) => return Ok(Ok(taken)),
                Err(Setback::Again { h, share }) => self.take_again(state, h, share),
                Err(Setback::Rebound { until }) => {
                    state.y.copy_from_slice(self.phases.y0());
                    plan.reach = plan.reach.or_before(t, Some(until), 0.0);
                    plan.divides = false;
                }
                Err(Setback::BlowUp(cause)) => return Ok(Err(cause)),
                Err(Setback::Error(error)) => return Err(error),
            }
        }
    }

    /// Limits of a step of an adaptive method from the state y. Where particles can arrive
    /// somewhere, none crosses the scene so often in a step that the arrival is missed.
    fn limits_of_flight(&self, model: &Model, y: &[f64]) -> StepLimits {
        let network = model.network();
        let arrives = |it: &&Network| !it.obstacles().is_empty() || !outflows(it).is_empty();
        let Some(network) = network.filter(arrives).filter(|_| self.stepper.is_adaptive()) else {
            return self.limits;
        };
        let v = &y[3 * network.particles()..6 * network.particles()];
        let fastest = v.iter().fold(0.0_f64, |fastest, v| fastest.max(v.abs()));
        let longest = MAX_FLIGHT * self.bounds.radius / fastest;
        let max_step = self.limits.max_step.unwrap_or(f64::INFINITY).min(longest);
        StepLimits { max_step: Some(max_step), ..self.limits }
    }

    /// Takes a step once: integrates, ends it at an event, and settles its end.
    fn attempt(
        &mut self,
        model: &Model,
        state: &mut RunState,
        plan: StepPlan,
    ) -> Result<(StepPart, Settled), Setback> {
        let StepPlan { t, depths, .. } = plan;
        self.phases.begin(model, &state.y, plan.locates);
        let mut part = self.integrate(model, state, plan)?;
        if plan.locates {
            part = self.end_at_event(model, state, plan, part)?;
        }
        let h = part.h;
        // An explicit step sees soft surfaces meet at its stages; rigid bodies rebound at once.
        let bulge = if self.stepper.is_adaptive() {
            let is_implicit = state.method.is_implicit();
            let step = Interval { t, h };
            self.phases.bulge(model, step, &state.y, is_implicit)
        } else {
            0.0
        };
        if let Some(share) = share_of_bulge(bulge, h) {
            return Err(Setback::Again { h, share });
        }
        let (order, is_adaptive) = (state.method.order, state.control.step().is_none());
        let y = &state.y[..];
        let end = End { order, is_adaptive, t: part.end, y };
        if let Some(cause) = self.watch.check_before_safeguard(model, &mut state.balance, end) {
            return Err(Setback::BlowUp(cause));
        }
        self.phases.may_lag = !self.stepper.is_adaptive();
        let settled = self.phases.settle(model, Interval { t, h }, &mut state.y);
        let mut settled = settled.map_err(Setback::BlowUp)?;
        settled.met.impulse += self.locator.impulse(model, state, (t + h, h));
        let planes = PLANE_PRICE * settled.met.guarded.planes as f64 / model.work();
        state.work.algebra += SWEEP_PRICE * settled.strained.sweeps as f64 + planes;
        if let Some(share) = settled.met.rebound.filter(|_| plan.divides) {
            let until = t + (share + SIMULTANEOUS_SHARE) * h;
            if t < until && until < part.end {
                return Err(Setback::Rebound { until });
            }
        }
        if let Stepper::Adaptive(adaptive) = &mut self.stepper {
            if let Some(share) = share_of_retry(&settled, h, depths) {
                return Err(Setback::Again { h, share });
            }
            limit_next(adaptive, &settled, bulge, h, depths);
            if part.ends_at_event {
                adaptive.restart();
            }
        }
        if let Some(network) = model.network() {
            let last = last_moment(network, state, part.end);
            if part.ends_at_event || last < part.end {
                network.hold(last, &mut state.y);
            }
        }
        state.guarded += settled.met.guarded;
        Ok((part, settled))
    }

    /// Advances the state by one step of the method.
    fn integrate(
        &mut self,
        model: &Model,
        state: &mut RunState,
        StepPlan { t, reach, .. }: StepPlan,
    ) -> Result<StepPart, Setback> {
        let resting = self.locator.view(model);
        let system = resting.as_ref().map_or(model.system(), |view| view);
        let control = match state.control {
            // If rounding would leave a tiny part of the step, that part is added to this one.
            Control::Step(h) if reach.longest <= h * (1.0 + STEP_END_TOLERANCE) => {
                Control::Step(reach.longest)
            }
            control => control,
        };
        let y = &mut state.y;
        match self.stepper.integrate(system, control, t, reach.longest, y) {
            Ok(taken) => {
                state.work += taken.work;
                if let Some(resting) = &resting {
                    resting.hold(t + taken.h, y);
                }
                Ok(reach.part(t, taken.h))
            }
            Err(error) => {
                let cause = cause_of(error, model);
                Err(cause.map_or_else(Setback::Error, Setback::BlowUp))
            }
        }
    }

    /// Ends a step at its first event, if there is one, and applies the impacts of particles that
    /// touch an obstacle there.
    fn end_at_event(
        &mut self,
        model: &Model,
        state: &mut RunState,
        StepPlan { t, depths, .. }: StepPlan,
        whole: StepPart,
    ) -> Result<StepPart, Setback> {
        let (stepper, y0, h) = (&mut self.stepper, self.phases.y0(), whole.h);
        let event = self.locator.first_event(model, state, stepper, y0, Interval { t, h }, depths);
        let Some(Event { share, kind }) = event else {
            return Ok(whole);
        };
        if matches!(kind, EventKind::Sunk) {
            let share = MIN_RETRY_SHARE.max(0.9 * share);
            let again = h > MIN_RETRY_STEP && self.stepper.is_adaptive();
            return if again { Err(Setback::Again { h, share }) } else { Ok(whole) };
        }
        let part = StepPart::of(t, share * h);
        state.y.copy_from_slice(self.locator.state());
        if let Stepper::Adaptive(adaptive) = &mut self.stepper
            && model.network().is_some_and(has_ropes)
        {
            // Between the impacts of ropes, steps would otherwise become ever longer.
            adaptive.try_at_most(h);
        }
        if let (EventKind::Touch { .. }, Some(network)) = (kind, model.network()) {
            let times = (part.end, part.h);
            self.phases.strike(network, times, depths, &mut state.y);
        }
        Ok(part)
    }

    /// Goes back to the beginning of a step of h (s), of which that share is tried next.
    fn take_again(&mut self, state: &mut RunState, h: f64, share: f64) {
        state.y.copy_from_slice(self.phases.y0());
        if let Stepper::Adaptive(adaptive) = &mut self.stepper {
            adaptive.restart();
            adaptive.try_first(h * share);
        }
        state.work.rejections += 1;
    }

    /// Finishes a part of a step that ends at time t (s). Returns the cause of a blow-up, if there
    /// is one.
    fn end_part(
        &mut self,
        model: &Model,
        state: &mut RunState,
        t: f64,
        settled: &Settled,
    ) -> Option<Cause> {
        let lost = self.bounds.violation(model, &state.y);
        let t = model.network().map_or(t, |it| last_moment(it, state, t));
        let RunState { y, balance, .. } = state;
        let (order, is_adaptive) = (state.method.order, state.control.step().is_none());
        let end = End { order, is_adaptive, t, y };
        let mut met = settled.met;
        let network = model.network().filter(|_| met.impulse.max(met.guarded.impulse) > 0.0);
        let reaction = network.map_or(0.0, |network| self.phases.reaction(network, t, y));
        met.impulse = met.impulse.max(reaction);
        self.watch.end_step(model, balance, end, &met, lost)
    }
}

/// Returns the last moment (s) up to time t (s) at which pins that constraints hold have the
/// velocities of a step that ends there: just before they jump, if they do.
fn last_moment(network: &Network, state: &RunState, t: f64) -> f64 {
    let jump = jump_near(network, t, state.sliver());
    jump.map_or(t, |jump| jump.min(t).next_down())
}

/// Returns whether particles of a model may rebound from obstacles.
fn may_rebound(model: &Model) -> bool {
    let network = model.network();
    let network = network.filter(|network| network.contact_layer().is_none());
    network.is_some_and(|network| network.obstacles().iter().any(|o| o.restitution > 0.0))
}

/// Reason why a run cannot continue.
pub(super) enum StepFailure {
    /// Blow-up by a cause, at a time (s).
    BlowUp { cause: Cause, time: f64 },
    /// Error that is no blow-up.
    Error(Error),
}

impl From<Error> for StepFailure {
    fn from(error: Error) -> Self {
        Self::Error(error)
    }
}

/// Returns the cause of a model's blow-up, if a failed step with this error is one; otherwise the
/// error.
fn cause_of(error: Error, model: &Model) -> Result<Cause, Error> {
    match error {
        Error::NotFinite { component, .. } => Ok(not_finite(model, component)),
        Error::StepTooSmall { step, .. } => Ok(Cause::StepTooSmall { step }),
        Error::NoConvergence { residual } => Ok(Cause::NoConvergence { residual }),
        Error::Unsupported { why: Refusal::ReadsVelocity, .. } => Ok(Cause::ReadsVelocity),
        Error::Unsupported { why: Refusal::TooDense { numbers, most }, .. } => {
            Ok(Cause::TooDense { numbers, most })
        }
        error => Err(error),
    }
}

/// Distance from the scene's middle, in its radii, beyond which a particle that has gained energy
/// ends the run.
const MAX_DISTANCE: f64 = 100.0;

/// Largest distance of particles from the middle, in radii, in a state that a run goes back to
/// after a blow-up: it still shows the whole scene.
const MAX_GOOD_DISTANCE: f64 = 3.0;

/// Number of particles that are checked together, without a branch.
const BLOCK_LENGTH: usize = 64;

/// Bounds of a scene as it begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct SceneBounds {
    pub middle: Vector3<f64>,
    /// Distance of the farthest particle from the middle (m).
    pub radius: f64,
}

impl SceneBounds {
    /// Returns whether all particles of y are close enough to the middle for a state to go back to
    /// after a blow-up.
    pub fn hold_closely(&self, model: &Model, y: &[f64]) -> bool {
        self.beyond(MAX_GOOD_DISTANCE, model, y).is_none()
    }

    /// Returns the cause of a blow-up, if a particle of y is too far away or not finite.
    pub fn violation(&self, model: &Model, y: &[f64]) -> Option<Cause> {
        self.beyond(MAX_DISTANCE, model, y)
    }

    /// Returns a constraint that contradicts others or pins, if there is one, in the state y at
    /// time t (s).
    pub fn contradiction(&self, model: &Model, y: &[f64], t: f64) -> Option<Unmet> {
        let network = model.network()?;
        contradiction(network, t, y, self.radius)
    }

    /// Finds the first particle that is farther than this many radii from the middle, or the first
    /// number that is not finite, if there is one. Numbers of a first-order system may grow far.
    fn beyond(&self, radii: f64, model: &Model, y: &[f64]) -> Option<Cause> {
        let n = match model {
            Model::FirstOrder(_) => 0,
            Model::Points(_) | Model::Network(_) => model.particles(),
        };
        let (x, v) = y.split_at(3 * n);
        let c = self.middle;
        let limit = (radii * self.radius).powi(2);
        let squared = |i: usize| {
            (x[i] - c.x).powi(2) + (x[n + i] - c.y).powi(2) + (x[2 * n + i] - c.z).powi(2)
        };
        // In blocks without a branch inside. The comparison is written so that NaN fails it too.
        let near = |block: Range<usize>| block.fold(true, |near, i| near & (squared(i) <= limit));
        let mut blocks = (0..n).step_by(BLOCK_LENGTH);
        if !blocks.all(|start| near(start..n.min(start + BLOCK_LENGTH))) {
            let particle = (0..n).find(|&i| !near(i..i + 1))?;
            let distance = squared(particle).sqrt();
            return Some(if distance.is_finite() {
                Cause::Away { particle, distance }
            } else {
                Cause::NotFinite { particle }
            });
        }
        let finite = |block: &[f64]| block.iter().fold(true, |finite, v| finite & v.is_finite());
        if v.chunks(BLOCK_LENGTH).all(finite) {
            return None;
        }
        let first = v.iter().position(|v| !v.is_finite());
        first.map(|k| not_finite(model, 3 * n + k))
    }
}

/// Returns the cause of a blow-up where number k of a state is not finite. It names the particle
/// that the number belongs to, which is the centre for the rotation of a rigid body.
fn not_finite(model: &Model, k: usize) -> Cause {
    let n = model.particles();
    if n == 0 {
        return Cause::NumberNotFinite { index: k };
    }
    let body = k.checked_sub(6 * n).map(|k| k / ROTATION);
    let network = model.network();
    let body = body.and_then(|body| network?.bodies().get(body));
    Cause::NotFinite { particle: body.map_or(k % n, Body::center) }
}
