//! A step of a run.
//!
//! It has five phases: *integrate* (the method takes the state from t to t + h), *shorten* (springs
//! that are too long), *contact* (particles leave obstacles, surfaces do not pass through one
//! another), *watch* (blow-ups, and the balance of energy) and *tear* (springs that are stretched
//! too far). Fixed and adaptive steps share them. They differ in two questions: whether a step ends
//! at the first event within it, and whether it is taken again, shorter ([`share_of_retry`]).

use super::Simulation;
use super::blow_up::blow_up_by;
use super::drive::{End, energy_of};
use super::events::{Event, EventKind};
use super::phases::Settled;
use super::resting;
use super::stepper::Kind;
use crate::control::Control;
use crate::error::{Cause, Error};
use crate::integrators::Adaptive;
use crate::network::Network;
use crate::scene::Model;
use crate::system::ParticleSystem;

/// Largest depth, as a share of the scene's radius, to which a step of an adaptive method may take
/// a particle into an obstacle: a state between the ends of the step is shown as it is, and must
/// not sink visibly.
pub(super) const MAX_PENETRATION: f64 = 1e-3;

/// Largest growth of the excess length of a spring in a step of an adaptive method, over the
/// longest length that a limit of strain allows it: for the same reason.
const MAX_STRAIN_GROWTH: f64 = 1e-2;

/// Largest distance of a surface's vertex from the straight course on which the guard takes it,
/// over the least thickness, in a step of an adaptive method that sees forces at its end alone.
const MAX_BULGE: f64 = 0.25;

/// Least share of a step that is taken again because a spring became too long.
const MIN_RETRY_SHARE: f64 = 0.1;

/// Price of a sweep over the springs that a limit of strain applies to, in evaluations.
const SWEEP: f64 = 2.0;

/// Price of a plane between two surfaces, in evaluations of one particle on springs.
const PLANE: f64 = 7.0;

/// Distance from an obstacle, over the radius of the scene, that counts as none.
pub(super) const NONE: f64 = 1e-9;

/// Length (s) below which a step is not shortened for contact or strain.
const MIN_RETRY_STEP: f64 = 1e-6;

/// Length (s) below which a step of an adaptive method is not shortened for impulses of surfaces.
const MIN_IMPACT_STEP: f64 = 1e-4;

impl Simulation {
    /// Takes a step from the end of the last one: in parts, where a fixed step that locates events
    /// meets some.
    pub(super) fn step(&mut self) -> Result<(), Error> {
        let mut begin = self.state.end();
        let whole = self.state.control.step();
        let target = whole.map(|h| self.state.since + (self.state.taken + 1) as f64 * h);
        loop {
            self.list_strained();
            self.watch.begin_step(&self.model, begin, &self.state.y);
            let (cause, part) = match self.integrate_and_settle(begin, target)? {
                Err(cause) => (Some(cause), Part::of(begin, whole.unwrap_or(0.0))),
                Ok((part, settled)) => (self.watch_step(part.end, &settled), part),
            };
            let is_last = cause.is_some() || !self.locates_in_parts() || target == Some(part.end);
            if is_last {
                self.judge(cause, part.end)?;
            }
            if whole.is_none() {
                self.state.set_time(part.end);
            } else if is_last {
                self.state.taken += 1;
            }
            if is_last {
                return Ok(());
            }
            self.tear();
            begin = part.end;
        }
    }

    /// Whether fixed steps are taken in parts, each up to an event.
    fn locates_in_parts(&self) -> bool {
        self.locates && !self.stepper.is_adaptive()
    }

    /// Takes a step from time t (s), and settles its end; again and shorter, if an adaptive method
    /// has to. One that locates events ends at the first of them; a fixed one ends at `target` at
    /// the latest. Returns the step, or the cause of a blow-up.
    fn integrate_and_settle(
        &mut self,
        t: f64,
        target: Option<f64>,
    ) -> Result<Result<(Part, Settled), Cause>, Error> {
        let n = self.particles();
        let max_depth = MAX_PENETRATION * self.radius;
        let heights = [NONE * self.radius, self.shallow()];
        let locates = self.stepper.is_adaptive() || self.locates;
        let reach = if locates {
            self.reach(t, target)
        } else {
            Reach::default()
        };
        self.list_rests(t);
        loop {
            let resting = resting::view(&self.model, self.rests.split().0);
            let system = resting.as_ref().map_or(self.model.system(), |view| view);
            let y = &mut self.state.y;
            self.phases.begin(&self.model, y, locates);
            let control = match self.state.control {
                // What rounding leaves of a step is no part of its own.
                Control::Step(h) if reach.longest <= h * (1.0 + Self::SLIVER) => {
                    Control::Step(reach.longest)
                }
                control => control,
            };
            let taken = self.stepper.integrate(system, control, t, reach.longest, y);
            let taken = match taken {
                Ok(taken) => taken,
                Err(error) => return blow_up_by(error, n).map(Err),
            };
            self.state.work += taken.work;
            let mut part = reach.part(t, taken.h);
            let mut event = None;
            if locates {
                event = self.first_event(t, taken.h);
            }
            let y = &mut self.state.y;
            match event {
                Some(Event {
                    kind: EventKind::Sunk,
                    share,
                }) if taken.h > MIN_RETRY_STEP && self.stepper.is_adaptive() => {
                    self.take_again(taken.h, MIN_RETRY_SHARE.max(0.9 * share));
                    continue;
                }
                Some(Event { kind, share }) if !matches!(kind, EventKind::Sunk) => {
                    part = Part::of(t, share * taken.h);
                    y.copy_from_slice(&self.events.state);
                    if let (EventKind::Touch { .. }, Some(network)) = (kind, self.model.network()) {
                        self.phases.strike(network, (part.end, part.h), heights, y);
                    }
                }
                _ => {}
            }
            let bulge = self.bulge((t, part.h));
            if bulge > MAX_BULGE && part.h > MIN_RETRY_STEP {
                self.take_again(part.h, 0.9 * (MAX_BULGE / bulge).sqrt());
                continue;
            }
            let (y, order, t1) = (&mut self.state.y, self.state.method.order, part.end);
            let balance = &self.state.balance;
            let end = End { order, t: t1, y };
            if let Some(cause) = self.watch.look_before_guard(&self.model, balance, end) {
                return Ok(Err(cause));
            }
            let settled = match self.phases.settle(&self.model, (t, part.h), y) {
                Ok(settled) => settled,
                Err(cause) => return Ok(Err(cause)),
            };
            let planes = PLANE * settled.met.guarded.planes as f64 / self.model.work();
            self.state.work.algebra += SWEEP * settled.strained.sweeps as f64 + planes;
            if let Kind::Adaptive(adaptive) = &mut self.stepper.kind {
                if let Some(share) = share_of_retry(&settled, part.h, max_depth, heights[1]) {
                    self.take_again(part.h, share);
                    continue;
                }
                limit_next(adaptive, &settled, part.h, max_depth);
                if bulge > 0.0 {
                    adaptive.try_at_most(part.h * 0.9 * (MAX_BULGE / bulge).sqrt());
                }
                if part.is_cut {
                    adaptive.restart();
                }
            }
            if part.is_cut
                && let Some(network) = self.model.network()
            {
                network.hold(part.end, &mut self.state.y);
            }
            self.state.guarded += settled.met.guarded;
            return Ok(Ok((part, settled)));
        }
    }

    /// Distance of vertices of surfaces from their chords in a step of h (s) from time t (s), over
    /// the least thickness; 0 for methods that see forces on the way.
    fn bulge(&self, (t, h): (f64, f64)) -> f64 {
        let sees_ends_alone = self.stepper.is_adaptive() && self.state.method.is_implicit();
        let layer = self.model.network().and_then(Network::contact_layer);
        let states = [self.phases.contact.y0(), &self.state.y];
        let is_known = states[0].len() == states[1].len();
        layer
            .filter(|_| sees_ends_alone && is_known)
            .map_or(0.0, |layer| layer.bulge((t, h), states))
    }

    /// Goes back to the beginning of a step of h (s), of which that share is taken next.
    fn take_again(&mut self, h: f64, share: f64) {
        self.state.y.copy_from_slice(self.phases.contact.y0());
        if let Kind::Adaptive(adaptive) = &mut self.stepper.kind {
            adaptive.restart();
            adaptive.try_first(h * share);
        }
        self.state.work.rejections += 1;
    }

    /// Limits of a step from time t (s).
    fn reach(&self, t: f64, target: Option<f64>) -> Reach {
        let mut reach = Reach::default();
        if let Some(network) = self.model.network() {
            let until = network.next_known_time(t);
            if until.is_finite() {
                reach = Reach::up_to(t, until);
            }
            if self.stepper.is_adaptive() {
                let longest = network.quarter_period(t, t + reach.longest.min(f64::MAX));
                reach.limit(longest);
            }
        }
        if self.stepper.is_adaptive() {
            reach.limit(self.scene.limits.max_step.unwrap_or(f64::INFINITY));
        }
        if let Some(target) = target.filter(|target| *target <= reach.until.unwrap_or(f64::MAX)) {
            reach = Reach {
                longest: target - t,
                until: Some(target),
            };
        }
        reach
    }

    /// Depth (m) into an obstacle that an adaptive method's tolerance allows a particle that comes
    /// to it within a step.
    pub(super) fn shallow(&self) -> f64 {
        let relative = self.state.control.tolerance().unwrap_or(0.0);
        let absolute = self.scene.limits.absolute;
        let absolute = absolute.unwrap_or(relative * self.radius);
        absolute.min(MAX_PENETRATION * self.radius)
    }

    /// Notes the end of a step at time t (s). Returns why the run is lost, if it is.
    fn watch_step(&mut self, t: f64, settled: &Settled) -> Option<Cause> {
        let lost = self.lost(&self.state.y);
        let state = &mut self.state;
        let (balance, y, order) = (&mut state.balance, &state.y[..], state.method.order);
        let end = End { order, t, y };
        self.watch
            .end_step(&self.model, balance, end, &settled.met, lost)
    }

    /// Time (s) and state at the end of the last step.
    pub(super) fn last_end(&self) -> (f64, &[f64]) {
        let within = self.stepper.within.end();
        within.unwrap_or_else(|| (self.state.time(), &self.state.y))
    }

    /// Lists the springs that are limited again, if springs or pins have changed.
    fn list_strained(&mut self) {
        if let Model::Network(network) = &mut self.model {
            network.list_strained();
        }
    }

    /// Breaks what is stretched too far at the end of a step, or was located to be there: that
    /// changes the energy. The run is there: a state that is shown within the step still has what
    /// breaks at its end.
    pub(super) fn tear(&mut self) {
        let locates = self.stepper.is_adaptive() || self.locates;
        let (share, t) = (if locates { NONE } else { 0.0 }, self.state.end());
        let y = &self.state.y;
        if let Model::Network(network) = &mut self.model
            && network.is_overstretched(network.halves(y).0, share)
        {
            let before = energy_of(network, t, y).total();
            network.tear(network.halves(y).0, share);
            let after = energy_of(network, t, y).total();
            self.state.balance.allow(after - before);
            self.watch.forget_drive();
            self.stepper.forget();
            self.refit();
        }
    }
}

/// Part of a run that a step takes it on by: a length and the time at its end (s).
#[derive(Clone, Copy)]
struct Part {
    h: f64,
    end: f64,
    /// Whether it ends at an event, after which the motion is no longer smooth.
    is_cut: bool,
}

impl Part {
    fn of(t: f64, h: f64) -> Self {
        Self {
            h,
            end: t + h,
            is_cut: true,
        }
    }
}

/// Limits of a step: its longest length, and the time (s) at which one of that length ends.
#[derive(Clone, Copy)]
struct Reach {
    longest: f64,
    until: Option<f64>,
}

impl Default for Reach {
    fn default() -> Self {
        Self {
            longest: f64::INFINITY,
            until: None,
        }
    }
}

impl Reach {
    /// Limits of a step from t up to a time `until` (s) at which a motion changes: no evaluation is
    /// at or after that.
    fn up_to(t: f64, until: f64) -> Self {
        // The last digits of a short step are lost in the time.
        let (mut longest, digit) = (until - t, 0.25 * (until - until.next_down()));
        while t + longest >= until && longest > 0.0 {
            longest = longest.next_down().min(longest - digit);
        }
        Self {
            longest,
            until: Some(until),
        }
    }

    /// Limits the length (s). A step of a shorter one does not end at the time.
    fn limit(&mut self, longest: f64) {
        if longest < self.longest {
            *self = Self {
                longest,
                until: None,
            };
        }
    }

    /// The step from t that takes h (s).
    fn part(&self, t: f64, h: f64) -> Part {
        let until = self.until.filter(|_| h == self.longest);
        Part {
            h,
            end: until.unwrap_or(t + h),
            is_cut: until.is_some(),
        }
    }
}

/// Share of a step of h (s) at which an adaptive method takes it again: to just after a particle
/// touched an obstacle, or a slide ended, or a spring became too long, or surfaces would have met.
/// An error of `shallow` (m) is tolerated.
fn share_of_retry(settled: &Settled, h: f64, max_depth: f64, shallow: f64) -> Option<f64> {
    let Settled { met, grown, .. } = settled;
    if h <= MIN_RETRY_STEP {
        return None;
    }
    if met.depth > max_depth {
        return Some(met.touched + (1.0 - met.touched) * 0.5 * max_depth / met.depth);
    }
    if met.stop.way > shallow {
        return Some(met.stop.share.max(MIN_RETRY_SHARE));
    }
    if *grown > MAX_STRAIN_GROWTH {
        return Some((0.5 * MAX_STRAIN_GROWTH / grown).max(MIN_RETRY_SHARE));
    }
    // Contact of surfaces is the force's: its error decides, once a step is so short that the
    // safeguard does nothing.
    let held = met.guarded.impulses > 0 && h > MIN_IMPACT_STEP;
    held.then_some((0.5 * met.guarded.first).max(MIN_RETRY_SHARE))
}

/// Limits the next step of an adaptive method by the depth and the growth of the last one, of
/// h (s): under a constant force both grow with the square of the step. Where they do not, as where
/// a limit of strain and an obstacle contradict each other, shorter steps do not help: the limit is
/// then at least the shortest step that is retried.
fn limit_next(adaptive: &mut Adaptive, settled: &Settled, h: f64, max_depth: f64) {
    let Settled { met, grown, .. } = settled;
    let mut limit = |allowed: f64| {
        let next = h * 0.9 * allowed.sqrt();
        let least = if next < h { MIN_RETRY_STEP } else { 0.0 };
        adaptive.try_at_most(next.max(least));
    };
    if met.depth > 0.0 {
        limit(max_depth / met.depth);
    }
    if *grown > 0.0 {
        limit(MAX_STRAIN_GROWTH / grown);
    }
}
