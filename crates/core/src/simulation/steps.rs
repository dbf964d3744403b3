//! Steps of a run: fixed ones, and those of an adaptive method, which looks ahead of the time
//! shown.

use super::blow_up::blow_up_by;
use super::{Simulation, Stepper};
use crate::contact::{Contact, Impulses, Obstacle, Squeezed, Statistics, StrainLimiter, Strained};
use crate::control::Control;
use crate::error::{Cause, Error};
use crate::network::Network;
use crate::scene::Model;
use crate::system::{Mechanics, ParticleSystem};
use crate::threads::among_threads;

/// Largest depth, as a share of the scene's radius, to which a step of an adaptive method may take
/// a particle into an obstacle: a state between the ends of the step is shown as it is, and must
/// not sink visibly.
const SUNK: f64 = 1e-3;

/// Largest growth of the excess length of a spring in a step of an adaptive method, over the
/// longest length that a limit of strain allows it: for the same reason.
const STRETCHED: f64 = 1e-2;

/// Least share of a step that is taken again because a spring became too long.
const SHORTENED: f64 = 0.1;

/// Price of a sweep over the springs that a limit of strain applies to, in evaluations.
const SWEEP: f64 = 2.0;

/// Length (s) below which a step is not shortened for that.
const SHORT: f64 = 1e-6;

/// Length (s) below which a step of an adaptive method is not shortened for impulses of surfaces.
const IMPACT: f64 = 1e-4;

impl Simulation {
    /// Share of a step by which its end may miss a time that is asked for: 1/60 s written as
    /// 0.01666667 meets sixty frames a second.
    pub const SLIVER: f64 = 1e-6;

    /// Takes `count` steps. When one of them blows up, the state is again the last at the beginning
    /// of such a call that was still in shape, and no more steps are taken until
    /// [`reset`](Self::reset).
    ///
    /// # Errors
    /// The run blew up, now or earlier.
    pub fn take_steps(&mut self, count: u64) -> Result<(), Error> {
        self.keep()?;
        among_threads(self.particles(), || {
            for _ in 0..count {
                if let Control::Step(step) = self.control {
                    self.step_by(step)?;
                    self.taken += 1;
                } else {
                    let until = self.look_ahead()?;
                    self.show(until);
                }
            }
            Ok(())
        })
    }

    /// Goes on to `time` (s) exactly, if it is not past it: the last step is shortened.
    ///
    /// An adaptive method steps past it instead, and the state is read off its step's polynomial: a
    /// frame costs no clipped step, and how often one looks changes nothing. A step that blows up
    /// is treated as by [`take_steps`](Self::take_steps).
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
            let Control::Step(step) = self.control else {
                let until = self.look_ahead()?;
                self.show(until.min(time));
                continue;
            };
            let left = time - self.time();
            // A sliver that is left is no step of its own: the step before it is longer by that.
            if left > step * (1.0 + Self::SLIVER) {
                self.step_by(step)?;
                self.taken += 1;
            } else {
                self.step_by(left)?;
                self.since = time;
                self.taken = 0;
            }
        }
        Ok(())
    }

    /// Takes one step of h (s) with what follows it: contact, the search for a blow-up, and
    /// tearing.
    fn step_by(&mut self, h: f64) -> Result<(), Error> {
        self.list_strained();
        let t = self.time();
        let system = self.model.system();
        let Stepper::Fixed(integrator) = &mut self.stepper else {
            return Ok(());
        };
        look_back(&self.model, &mut self.contact, &self.y, false);
        let cause = match integrator.step(system, t, h, &mut self.y) {
            Ok(work) => {
                self.work += work;
                let phases = (&mut self.limiter, &mut self.contact);
                match settle(&self.model, phases, (t, h), &mut self.y) {
                    Ok(Settled { strained, met }) => {
                        self.work.algebra += SWEEP * strained.sweeps as f64;
                        self.guarded += met.guarded;
                        let lost = self.lost(&self.y);
                        let now = (t + h, self.y.as_slice());
                        self.watch.met(&self.model, now, &met, lost)
                    }
                    Err(cause) => Some(cause),
                }
            }
            Err(error) => Some(blow_up_by(error, self.model.particles())?),
        };
        self.judge(cause, t + h)?;
        self.tear();
        Ok(())
    }

    /// Makes an adaptive method's step reach past the time shown. Returns its end (s).
    fn look_ahead(&mut self) -> Result<f64, Error> {
        self.list_strained();
        let now = self.time();
        let system = self.model.system();
        let Stepper::Adaptive {
            adaptive,
            end,
            until,
        } = &mut self.stepper
        else {
            return Ok(now);
        };
        let begin = match *until {
            Some(until) if until > now => return Ok(until),
            Some(until) => until,
            None => {
                end.copy_from_slice(&self.y);
                adaptive.restart();
                now
            }
        };
        *until = None;
        let limit = SUNK * self.radius;
        let (cause, reached) = loop {
            look_back(&self.model, &mut self.contact, end, true);
            let limit_of_strain = self.model.network().and_then(Network::strained);
            let excess = limit_of_strain.map_or(0.0, |limit| {
                self.contact.remember(end);
                limit.excess(&end[..3 * self.model.particles()])
            });
            let taken = match adaptive.advance(system, begin, end) {
                Ok(taken) => taken,
                Err(error) => {
                    let cause = blow_up_by(error, self.model.particles())?;
                    break (Some(cause), begin);
                }
            };
            self.work += taken.work;
            let phases = (&mut self.limiter, &mut self.contact);
            let Settled { met, strained } = match settle(&self.model, phases, (begin, taken.h), end)
            {
                Ok(settled) => settled,
                Err(cause) => break (Some(cause), begin),
            };
            self.work.algebra += SWEEP * strained.sweeps as f64;
            let grown = strained.excess - excess;
            let touched = met.touched + (1.0 - met.touched) * 0.5 * limit / met.depth;
            let strained = (0.5 * STRETCHED / grown).max(SHORTENED);
            let again = (met.depth > limit).then_some(touched);
            let again = again.or((grown > STRETCHED).then_some(strained));
            // Contact of surfaces is the force's: its error decides, once a step is so short that
            // the guard does nothing.
            let held = met.guarded.impulses > 0 && taken.h > IMPACT;
            let again = again.or(held.then_some((0.5 * met.guarded.first).max(SHORTENED)));
            if let Some(share) = again.filter(|_| taken.h > SHORT) {
                // The step is taken again, to just after the particle touched the obstacle, or
                // the spring became too long, or surfaces would have met.
                end.copy_from_slice(self.contact.y0());
                adaptive.restart();
                adaptive.try_first(taken.h * share);
                self.work.rejections += 1;
                continue;
            }
            self.guarded += met.guarded;
            if met.depth > 0.0 {
                // Under a constant force the depth grows with the square of the step.
                adaptive.try_at_most(taken.h * 0.9 * (limit / met.depth).sqrt());
            }
            if grown > 0.0 {
                adaptive.try_at_most(taken.h * 0.9 * (STRETCHED / grown).sqrt());
            }
            let reached = begin + taken.h;
            *until = Some(reached);
            let Stepper::Adaptive { end, .. } = &self.stepper else {
                return Ok(now);
            };
            let (lost, now) = (self.lost(end), (reached, end.as_slice()));
            break (self.watch.met(&self.model, now, &met, lost), reached);
        };
        self.judge(cause, reached)?;
        Ok(reached)
    }

    /// Shows the state at a time (s) up to the end of an adaptive method's step: between its ends
    /// as its polynomial has it, with pins in their places.
    fn show(&mut self, time: f64) {
        let system = self.model.system();
        if let Stepper::Adaptive {
            adaptive,
            end,
            until,
        } = &mut self.stepper
        {
            if *until == Some(time) {
                self.y.copy_from_slice(end);
            } else {
                self.work += adaptive.interpolate(system, time, &mut self.y);
                system.hold(time, &mut self.y);
                let (begin, y0) = (adaptive.last().t, self.contact.y0());
                if let Some(network) = self.model.network()
                    && let Some(layer) = network.contact_layer()
                    && y0.len() == self.y.len()
                {
                    // A polynomial knows of no surfaces. Where what is led leaves no room, the step
                    // itself has ended the run.
                    let way = (begin, time - begin);
                    let none = &mut Impulses::default();
                    let _ = layer.guard(network.inverse_masses(), way, y0, &mut self.y, none);
                    network.hold(time, &mut self.y);
                }
            }
            self.since = time;
            self.tear();
        }
    }

    /// Lists the springs that are limited anew, if springs or pins have changed.
    fn list_strained(&mut self) {
        if let Model::Network(network) = &mut self.model {
            network.list_strained();
        }
    }

    /// Breaks what is stretched too far in the state shown.
    fn tear(&mut self) {
        if let Model::Network(network) = &mut self.model
            && network.tear(network.halves(&self.y).0) > 0
        {
            self.look_again();
            self.refit();
        }
    }

    /// Forgets the last step of an adaptive method: the state or the system is no longer the one
    /// that it began with.
    pub(super) fn look_again(&mut self) {
        if let Stepper::Adaptive { until, .. } = &mut self.stepper {
            *until = None;
        }
        self.watch.disturbed = true;
    }
}

/// Obstacles of the model.
fn obstacles(model: &Model) -> &[Obstacle] {
    model.network().map_or(&[], Network::obstacles)
}

/// Remembers the state that a step begins with, as far as contact needs it.
fn look_back(model: &Model, contact: &mut Contact, y0: &[f64], always: bool) {
    match model.network().and_then(Network::contact_layer) {
        Some(_) => contact.remember(y0),
        None => contact.begin(obstacles(model), y0, always),
    }
}

/// What the phases after a step did.
#[derive(Default)]
struct Settled {
    strained: Strained,
    met: Statistics,
}

/// What follows a step of h (s) from t (s) to y1: springs that are too long are shortened,
/// particles leave obstacles, or surfaces do not pass through one another, and pins are in their
/// places.
fn settle(
    model: &Model,
    (limiter, contact): (&mut StrainLimiter, &mut Contact),
    (t, h): (f64, f64),
    y1: &mut [f64],
) -> Result<Settled, Cause> {
    let mut settled = Settled::default();
    let Some(network) = model.network() else {
        model.system().hold(t + h, y1);
        return Ok(settled);
    };
    let inverse_masses = network.inverse_masses();
    if let Some(limit) = network.strained() {
        settled.strained = limiter.resolve(limit, inverse_masses, h, y1);
    }
    let Some(layer) = network.contact_layer() else {
        settled.met = contact.resolve(network.obstacles(), inverse_masses, (t, h), y1);
        network.hold(t + h, y1);
        return Ok(settled);
    };
    network.hold(t + h, y1);
    // A state that is lost is found to be so afterwards.
    if y1.iter().all(|y| y.is_finite()) {
        let guarded = contact.guard(layer, inverse_masses, (t, h), y1);
        settled.met = guarded.map_err(|Squeezed { vertices }| Cause::Squeezed { vertices })?;
        if !network.bodies().is_empty() {
            network.hold(t + h, y1);
        }
    }
    Ok(settled)
}
