//! Steps of a run.
//!
//! A step has five phases: *integrate* (the method takes the state from t to t + h), *shorten*
//! (springs that are too long), *contact* (particles leave obstacles, surfaces do not pass through
//! one another), *watch* (blow-ups, and the balance of energy) and *tear* (springs that are
//! stretched too far). Fixed and adaptive steps share them. They differ in one question, whether
//! the step is taken again, shorter: see [`share_of_retry`].
//!
//! A run takes whole steps only. A time that is asked for may be within one: the run goes to the
//! end of that step, and the state shown is read off the step's polynomial.

use super::Simulation;
use super::balance::energy_of;
use super::blow_up::blow_up_by;
use super::drive::End;
use super::events::{Event, Kind as event, Step as Span};
use super::phases::Settled;
use super::stepper::Kind;
use crate::contact::Impulses;
use crate::control::Control;
use crate::error::{Cause, Error};
use crate::integrators::Adaptive;
use crate::scene::Model;
use crate::system::{Mechanics, ParticleSystem};
use crate::threads::among_threads;

/// Largest depth, as a share of the scene's radius, to which a step of an adaptive method may take
/// a particle into an obstacle: a state between the ends of the step is shown as it is, and must
/// not sink visibly.
const MAX_PENETRATION: f64 = 1e-3;

/// Largest growth of the excess length of a spring in a step of an adaptive method, over the
/// longest length that a limit of strain allows it: for the same reason.
const MAX_STRAIN_GROWTH: f64 = 1e-2;

/// Least share of a step that is taken again because a spring became too long.
const MIN_RETRY_SHARE: f64 = 0.1;

/// Price of a sweep over the springs that a limit of strain applies to, in evaluations.
const SWEEP: f64 = 2.0;

/// Distance from an obstacle, over the radius of the scene, that counts as none.
const NONE: f64 = 1e-9;

/// Length (s) below which a step is not shortened for contact or strain.
const MIN_RETRY_STEP: f64 = 1e-6;

/// Length (s) below which a step of an adaptive method is not shortened for impulses of surfaces.
const MIN_IMPACT_STEP: f64 = 1e-4;

impl Simulation {
    /// Share of a step by which its end may miss a time that is asked for: 1/60 s written as
    /// 0.01666667 meets sixty frames a second.
    pub const SLIVER: f64 = 1e-6;

    /// Takes `count` steps; one that the time shown is within is finished, and counts. When one of
    /// them blows up, the state is again the last at the beginning of such a call that was still in
    /// shape, and no more steps are taken until [`reset`](Self::reset).
    ///
    /// # Errors
    /// The run blew up, now or earlier.
    pub fn take_steps(&mut self, count: u64) -> Result<(), Error> {
        self.keep()?;
        among_threads(self.particles(), || {
            (0..count).try_for_each(|_| if self.arrive() { Ok(()) } else { self.step() })
        })
    }

    /// Goes on to `time` (s), if it is not past it. No step is shortened for that: where none ends
    /// at that time, the state shown is read off the polynomial of the step that it is within, so
    /// how often one looks changes nothing. A step that blows up is treated as by
    /// [`take_steps`](Self::take_steps).
    ///
    /// # Errors
    /// The run blew up, now or earlier; or `time` is not finite.
    pub fn advance_to(&mut self, time: f64) -> Result<(), Error> {
        if !time.is_finite() {
            return Err(Error::Invalid(format!(
                "the end must be a finite number of seconds, not {time}"
            )));
        }
        self.keep()?;
        among_threads(self.particles(), || self.go_on(time))
    }

    /// Takes steps up to `time` (s).
    fn go_on(&mut self, time: f64) -> Result<(), Error> {
        while self.time() < time {
            if self.stepper.within.until().is_some_and(|end| time < end) {
                self.show(time);
                break;
            }
            if self.arrive() {
                continue;
            }
            let begin = self.state.end();
            let ends_later = |h: f64| begin + h * (1.0 - Self::SLIVER) > time;
            if self.state.control.step().is_some_and(ends_later) {
                self.stepper.within.begin(&self.state.y);
            }
            self.step()?;
            let end = self.state.end();
            if ends_later(end - begin) {
                self.stepper.within.enter([begin, end], &self.state.y);
                self.show(time);
            } else if end >= time - Self::SLIVER * (end - begin) {
                // The step ends there, except for rounding.
                self.state.shown = Some(time);
            }
        }
        Ok(())
    }

    /// Goes on to the end of the step that the time shown is within. Returns whether it was within
    /// one.
    fn arrive(&mut self) -> bool {
        self.state.shown = None;
        let end = self.stepper.within.leave();
        let is_within = end.is_some();
        if let Some(end) = end {
            std::mem::swap(end, &mut self.state.y);
        }
        is_within
    }

    /// Takes a step from the end of the last one: in parts, where a fixed step that locates events
    /// meets some.
    fn step(&mut self) -> Result<(), Error> {
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
            self.tear(part.end);
            if is_last {
                return Ok(());
            }
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
        loop {
            let (system, y) = (self.model.system(), &mut self.state.y);
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
                    kind: event::Sunk,
                    share,
                }) if taken.h > MIN_RETRY_STEP => {
                    self.take_again(taken.h, MIN_RETRY_SHARE.max(0.9 * share));
                    continue;
                }
                Some(Event { kind, share }) if !matches!(kind, event::Sunk) => {
                    part = Part::of(t, share * taken.h);
                    y.copy_from_slice(&self.events.state);
                    if let (event::Touch { .. }, Some(network)) = (kind, self.model.network()) {
                        self.phases.strike(network, (part.end, part.h), heights, y);
                    }
                }
                _ => {}
            }
            let settled = match self.phases.settle(&self.model, (t, part.h), y) {
                Ok(settled) => settled,
                Err(cause) => return Ok(Err(cause)),
            };
            self.state.work.algebra += SWEEP * settled.strained.sweeps as f64;
            if let Kind::Adaptive(adaptive) = &mut self.stepper.kind {
                if let Some(share) = share_of_retry(&settled, part.h, max_depth) {
                    self.take_again(part.h, share);
                    continue;
                }
                limit_next(adaptive, &settled, part.h, max_depth);
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
                reach.longest = reach.longest.min(longest);
            }
        }
        if self.stepper.is_adaptive() {
            let longest = self.scene.max_step.unwrap_or(f64::INFINITY);
            reach.longest = reach.longest.min(longest);
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
    fn shallow(&self) -> f64 {
        let relative = self.state.control.tolerance().unwrap_or(0.0);
        let tolerance = self.scene.tolerance(relative);
        let absolute = tolerance.map_or(0.0, |tolerance| tolerance.absolute);
        absolute.min(MAX_PENETRATION * self.radius)
    }

    /// Finds the first event of a step of h (s) from time t (s) to the state as it is now.
    fn first_event(&mut self, t: f64, h: f64) -> Option<Event> {
        let network = self.model.network()?;
        if network.obstacles().is_empty() && network.tear_limit().is_none() {
            return None;
        }
        let shallow = self.shallow();
        let step = Span {
            network,
            t,
            h,
            ends: [self.phases.contact.y0(), &self.state.y],
            none: NONE * self.radius,
            shallow,
            deepest: MAX_PENETRATION * self.radius,
        };
        if step.ends.iter().any(|y| y.len() != self.state.y.len())
            || self.state.y.iter().any(|y| !y.is_finite())
        {
            return None;
        }
        let (stepper, work) = (&mut self.stepper, &mut self.state.work);
        let y0 = self.phases.contact.y0();
        let system = self.model.system();
        self.events.first(&step, &mut |share, out| {
            *work += stepper.state_at(system, t, share * h, y0, out);
            system.hold(t + share * h, out);
        })
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

    /// Shows the state at a time (s) within the step: as its polynomial has it, with pins in their
    /// places.
    fn show(&mut self, time: f64) {
        let (system, n) = (self.model.system(), self.particles());
        let y = &mut self.state.y;
        let within = &mut self.stepper.within;
        let Some([begin, _]) = within.times() else {
            return;
        };
        match &mut self.stepper.kind {
            Kind::Fixed(_) => {
                let n = self.model.network().map_or(0, |_| n);
                within.interpolate((system, n), time, y);
            }
            Kind::Adaptive(adaptive) => {
                self.state.work += adaptive.interpolate(system, time, y);
                system.hold(time, y);
            }
        }
        let y0 = self.phases.contact.y0();
        if let Some(network) = self.model.network()
            && let Some(layer) = network.contact_layer()
            && y0.len() == y.len()
        {
            // A polynomial knows of no surfaces. Where prescribed motion leaves no room, the step
            // itself has ended the run.
            let (span, none) = ((begin, time - begin), &mut Impulses::default());
            let _ = layer.guard(network.inverse_masses(), span, y0, y, none);
            network.hold(time, y);
        }
        self.state.shown = Some(time);
    }

    /// Lists the springs that are limited again, if springs or pins have changed.
    fn list_strained(&mut self) {
        if let Model::Network(network) = &mut self.model {
            network.list_strained();
        }
    }

    /// Breaks what is stretched too far at the end of a step, at time t (s), or was located to be
    /// there. That changes the energy.
    fn tear(&mut self, t: f64) {
        let locates = self.stepper.is_adaptive() || self.locates;
        let (share, y) = (if locates { NONE } else { 0.0 }, &self.state.y);
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

    /// Ends the step at the time shown, before the state or the system changes there: an adaptive
    /// step by its polynomial, and a fixed one by a shorter step, whose end is as stable.
    pub(super) fn look_again(&mut self) {
        let time = self.time();
        let end = self.stepper.within.until().unwrap_or(time);
        if let Some([begin, _]) = self.stepper.within.times() {
            if !self.stepper.is_adaptive() {
                self.shorten_step(begin, time);
            }
            self.state.set_time(time);
        }
        self.state.shown = None;
        self.stepper.forget();
        let (balance, y) = (&mut self.state.balance, &self.state.y[..]);
        self.watch.disturb(&self.model, balance, time, end, y);
    }

    /// Takes the step that began at time t (s) again, to the time shown. A state that is read off
    /// stays where that fails.
    fn shorten_step(&mut self, t: f64, time: f64) {
        let mut y = self.stepper.within.y0().to_vec();
        let system = self.model.system();
        self.phases.begin(&self.model, &y, false);
        let step = Control::Step(time - t);
        let taken = self.stepper.integrate(system, step, t, time - t, &mut y);
        let settled = self.phases.settle(&self.model, (t, time - t), &mut y);
        if taken.is_ok() && settled.is_ok() && y.iter().all(|y| y.is_finite()) {
            self.state.y = y;
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
        let mut longest = until - t;
        while t + longest >= until && longest > 0.0 {
            longest = longest.next_down();
        }
        Self {
            longest,
            until: Some(until),
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
/// touched an obstacle, or a spring became too long, or surfaces would have met.
fn share_of_retry(settled: &Settled, h: f64, max_depth: f64) -> Option<f64> {
    let Settled { met, grown, .. } = settled;
    if h <= MIN_RETRY_STEP {
        return None;
    }
    if met.depth > max_depth {
        return Some(met.touched + (1.0 - met.touched) * 0.5 * max_depth / met.depth);
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
/// h (s): under a constant force both grow with the square of the step.
fn limit_next(adaptive: &mut Adaptive, settled: &Settled, h: f64, max_depth: f64) {
    let Settled { met, grown, .. } = settled;
    if met.depth > 0.0 {
        adaptive.try_at_most(h * 0.9 * (max_depth / met.depth).sqrt());
    }
    if *grown > 0.0 {
        adaptive.try_at_most(h * 0.9 * (MAX_STRAIN_GROWTH / grown).sqrt());
    }
}
