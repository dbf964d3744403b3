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

    /// Takes a step from the end of the last one.
    fn step(&mut self) -> Result<(), Error> {
        self.list_strained();
        let begin = self.state.end();
        self.watch.begin_step(&self.model, begin, &self.state.y);
        let (cause, end) = match self.integrate_and_settle(begin)? {
            Err(cause) => (
                Some(cause),
                begin + self.state.control.step().unwrap_or(0.0),
            ),
            Ok((h, settled)) => (self.watch_step(begin + h, &settled), begin + h),
        };
        self.judge(cause, end)?;
        if self.state.control.step().is_some() {
            self.state.taken += 1;
        } else {
            self.state.set_time(end);
        }
        self.tear();
        Ok(())
    }

    /// Takes a step from time t (s), and settles its end; again and shorter, if an adaptive method
    /// has to. Returns its length (s), or the cause of a blow-up.
    fn integrate_and_settle(&mut self, t: f64) -> Result<Result<(f64, Settled), Cause>, Error> {
        let n = self.particles();
        let max_depth = MAX_PENETRATION * self.radius;
        loop {
            let (system, y) = (self.model.system(), &mut self.state.y);
            self.phases
                .begin(&self.model, y, self.stepper.is_adaptive());
            let taken = self.stepper.integrate(system, self.state.control, t, y);
            let taken = match taken {
                Ok(taken) => taken,
                Err(error) => return blow_up_by(error, n).map(Err),
            };
            self.state.work += taken.work;
            let settled = match self.phases.settle(&self.model, (t, taken.h), y) {
                Ok(settled) => settled,
                Err(cause) => return Ok(Err(cause)),
            };
            self.state.work.algebra += SWEEP * settled.strained.sweeps as f64;
            if let Kind::Adaptive(adaptive) = &mut self.stepper.kind {
                if let Some(share) = share_of_retry(&settled, taken.h, max_depth) {
                    y.copy_from_slice(self.phases.contact.y0());
                    adaptive.restart();
                    adaptive.try_first(taken.h * share);
                    self.state.work.rejections += 1;
                    continue;
                }
                limit_next(adaptive, &settled, taken.h, max_depth);
            }
            self.state.guarded += settled.met.guarded;
            return Ok(Ok((taken.h, settled)));
        }
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

    /// Breaks what is stretched too far at the end of a step.
    fn tear(&mut self) {
        let (t, y) = (self.state.time(), &self.state.y);
        if let Model::Network(network) = &mut self.model
            && network.is_overstretched(network.halves(y).0)
        {
            let before = energy_of(network, t, y).total();
            network.tear(network.halves(y).0);
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
        let taken = self.stepper.integrate(system, step, t, &mut y);
        let settled = self.phases.settle(&self.model, (t, time - t), &mut y);
        if taken.is_ok() && settled.is_ok() && y.iter().all(|y| y.is_finite()) {
            self.state.y = y;
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
