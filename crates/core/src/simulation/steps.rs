//! Times of a run: it takes whole steps only. A time that is asked for may be within one: the run
//! goes to the end of that step, and the state shown is read off the step's polynomial.

use super::Simulation;
use super::stepper::Kind;
use crate::control::Control;
use crate::error::Error;
use crate::threads::among_threads;

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
            for _ in 0..count {
                if !self.arrive() {
                    self.step()?;
                    self.tear();
                }
            }
            Ok(())
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
        loop {
            let sliver = Self::SLIVER * self.step_size().unwrap_or(0.0);
            if let Some(end) = self.stepper.within.until() {
                if time <= self.time() {
                    return Ok(());
                }
                if time < end - sliver {
                    self.show(time);
                    return Ok(());
                }
                self.arrive();
            }
            let begin = self.state.end();
            if time <= begin + sliver {
                if time >= begin - sliver {
                    // The last step ends there, except for rounding.
                    self.state.shown = Some(time).filter(|time| *time != begin);
                }
                return Ok(());
            }
            self.state.shown = None;
            let ends_later = |h: f64| begin + h * (1.0 - Self::SLIVER) > time;
            if self.state.control.step().is_some_and(ends_later) {
                self.stepper.within.begin(&self.state.y);
            }
            self.step()?;
            let end = self.state.end();
            if ends_later(end - begin) {
                self.stepper.within.enter([begin, end], &self.state.y);
                self.show(time);
                return Ok(());
            }
            self.tear();
        }
    }

    /// Goes on to the end of the step that the time shown is within. Returns whether it was within
    /// one.
    fn arrive(&mut self) -> bool {
        self.state.shown = None;
        let end = self.stepper.within.leave();
        let is_within = end.is_some();
        if let Some(end) = end {
            std::mem::swap(end, &mut self.state.y);
            self.tear();
        }
        is_within
    }

    /// Shows the state at a time (s) within the step: as its polynomial has it, with contact and
    /// pins as at the end of a step.
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
        if let Some(network) = self.model.network() {
            let knows_contact = !self.stepper.is_adaptive();
            self.phases
                .settle_shown(network, (begin, time - begin), knows_contact, y);
        }
        self.state.shown = Some(time);
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
