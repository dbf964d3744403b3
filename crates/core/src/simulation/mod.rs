//! Scene x method x time.

mod checkpoint;
mod hands;
mod stepper;
mod tuning;

pub use checkpoint::{Checkpoint, Grabbed};
use stepper::Stepper;

use std::ops::Range;

use nalgebra::{DMatrixView, Vector3};

use crate::contact::{Contact, Obstacle, Statistics};
use crate::control::Control;
use crate::error::{BlowUp, Cause, Error};
use crate::integrators::{Method, Work};
use crate::network::{Energy, Network};
use crate::scene::{Model, Scene, bounds};
use crate::system::{Mechanics, ParticleSystem, place_pins};

/// A particle this many times the scene's radius away from its middle is lost.
const LOST: f64 = 100.0;

/// The state to go back to when one is lost has all of them within this many radii: still a picture of the scene.
const GOOD: f64 = 3.0;

/// An adaptive method's step takes no particle farther into an obstacle than this share of the scene's radius, so that
/// states between its ends do not sink visibly ...
const SUNK: f64 = 1e-3;

/// ... unless it is shorter than this (s).
const SHORT: f64 = 1e-6;

/// A run of a scene.
pub struct Simulation {
    scene: Scene,
    model: Model,
    method: &'static Method,
    stepper: Stepper,
    control: Control,
    y: Vec<f64>,
    /// Time is `since + taken * step`, which gathers no rounding errors; under a tolerance it is `since` (s).
    since: f64,
    taken: u64,
    steps: u64,
    work: Work,
    contact: Contact,
    swinging: bool,
    /// The swing's: while it swings, sin(rate t + phase); while it stands, sin(phase) (rad).
    swing_phase: f64,
    grabbed: Option<Grabbed>,
    grabbed_obstacle: Option<usize>,
    /// Whether the scene's pins hold nothing.
    unpinned: bool,
    blow_up: Option<BlowUp>,
    /// The last state in shape, to go back to when a step fails.
    good: Checkpoint,
    middle: Vector3<f64>,
    radius: f64,
}

impl Simulation {
    /// A run from the scene's beginning, in fixed steps or, with an adaptive method, to a tolerance.
    ///
    /// # Errors
    /// The method does not serve the scene or does not take that control; or the scene's state has another length
    /// than its model's.
    pub fn new(scene: Scene, method: &'static Method, control: Control) -> Result<Self, Error> {
        let stepper = Stepper::new(method, scene.model.system(), control)?;
        let model = scene.model.clone();
        let (dim, length) = (model.system().dim(), scene.state.len());
        if length != dim {
            return Err(Error::Dimension {
                expected: dim,
                found: length,
            });
        }
        if dim == 0 || dim % 3 != 0 {
            return Err(Error::Invalid(format!(
                "a scene's state is n x 3 positions, and this has {dim} numbers"
            )));
        }
        let y = scene.state.clone();
        let (middle, radius) = bounds(&y[..3 * model.particles()]);
        let contact = Contact::new(dim);
        let mut run = Self {
            scene,
            model,
            method,
            stepper,
            control,
            y,
            since: 0.0,
            taken: 0,
            steps: 0,
            work: Work::default(),
            contact,
            swinging: false,
            swing_phase: 0.0,
            grabbed: None,
            grabbed_obstacle: None,
            unpinned: false,
            blow_up: None,
            good: Checkpoint::empty(method, control),
            middle,
            radius,
        };
        run.keep_good();
        Ok(run)
    }

    /// The scene as it was built.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The model as it is now: pins led, wind on or off, springs broken.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The method.
    #[must_use]
    pub fn method(&self) -> &'static Method {
        self.method
    }

    /// The step or the tolerance.
    #[must_use]
    pub fn control(&self) -> Control {
        self.control
    }

    /// The step (s): the fixed one, or the last one under a tolerance, if there was one yet.
    #[must_use]
    pub fn step_size(&self) -> Option<f64> {
        match &self.stepper {
            Stepper::Fixed(_) => self.control.step(),
            Stepper::Adaptive { adaptive, .. } => Some(adaptive.last().h).filter(|h| *h > 0.0),
        }
    }

    /// Simulated time (s).
    #[must_use]
    pub fn time(&self) -> f64 {
        self.since + self.taken as f64 * self.control.step().unwrap_or(0.0)
    }

    /// Steps taken since the beginning.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// What they cost.
    #[must_use]
    pub fn work(&self) -> Work {
        self.work
    }

    /// What contact did in the last step, up to the end of it.
    #[must_use]
    pub fn contact(&self) -> Statistics {
        self.contact.last()
    }

    /// y: of a network [x | v], in m and m/s.
    #[must_use]
    pub fn state(&self) -> &[f64] {
        &self.y
    }

    /// Number of particles.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.model.particles()
    }

    /// Positions (m), n x 3.
    #[must_use]
    pub fn positions(&self) -> DMatrixView<'_, f64> {
        let n = self.particles();
        DMatrixView::from_slice(&self.y[..3 * n], n, 3)
    }

    /// Position of particle i (m).
    #[must_use]
    pub fn position(&self, i: usize) -> Vector3<f64> {
        let n = self.particles();
        Vector3::new(self.y[i], self.y[n + i], self.y[2 * n + i])
    }

    /// Velocities (m/s), column-major: of a mechanical scene from its state, of a first-order one from f.
    #[must_use]
    pub fn velocities(&self) -> Vec<f64> {
        if self.model.network().is_some() {
            return self.y[self.y.len() / 2..].to_vec();
        }
        let mut v = vec![0.0; self.y.len()];
        self.model.system().eval_f(self.time(), &self.y, &mut v);
        v
    }

    /// The energy (J), if the scene has forces.
    #[must_use]
    pub fn energy(&self) -> Option<Energy> {
        let (x, v) = self.y.split_at(self.y.len() / 2);
        self.model.network().map(|network| network.energy(x, v))
    }

    /// Height of the lowest particle (m).
    #[must_use]
    pub fn lowest(&self) -> f64 {
        self.positions().column(1).min()
    }

    /// Length over rest length of the most stretched structural spring, if there are springs.
    #[must_use]
    pub fn largest_stretch(&self) -> Option<f64> {
        let x = &self.y[..3 * self.particles()];
        self.model
            .network()
            .map(|network| network.largest_stretch(x))
    }

    /// Springs that have broken: as the number changes, what is drawn of them does.
    #[must_use]
    pub fn tears(&self) -> usize {
        self.model.network().map_or(0, Network::tears)
    }

    /// The middle of the scene as it began, and the distance of its farthest particle from there, at least 1 (m).
    #[must_use]
    pub fn extent(&self) -> (Vector3<f64>, f64) {
        (self.middle, self.radius)
    }

    /// Where the run was lost, if it was.
    #[must_use]
    pub fn blow_up(&self) -> Option<BlowUp> {
        self.blow_up
    }

    /// Takes this many steps. When one of them blows up, the state is again the last at the beginning of such a call
    /// that was still in shape, and no more steps are taken until [`reset`](Self::reset).
    ///
    /// # Errors
    /// The run blew up, now or earlier.
    pub fn take_steps(&mut self, count: u64) -> Result<(), Error> {
        self.keep()?;
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
    }

    /// Goes on to `time` (s) exactly, if it is not past it: the last step is shortened. An adaptive method steps past
    /// it instead, and the state is read off its step's polynomial: a frame costs no clipped step, and how often
    /// one looks changes nothing. As [`take_steps`](Self::take_steps) when a step blows up.
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
        while self.time() < time {
            let Control::Step(step) = self.control else {
                let until = self.look_ahead()?;
                self.show(until.min(time));
                continue;
            };
            let left = time - self.time();
            // A last sliver of a rounding error's size is no step of its own.
            if left > step * (1.0 + 1e-9) {
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

    /// Remembers the state if it is in shape, unless the run is lost.
    fn keep(&mut self) -> Result<(), Error> {
        if let Some(blow_up) = self.blow_up {
            return Err(blow_up.into());
        }
        if self.beyond(GOOD, &self.y).is_none() {
            self.keep_good();
        }
        Ok(())
    }

    /// One step of h, and what follows it: contact, and the look whether it went well.
    fn step_by(&mut self, h: f64) -> Result<(), Error> {
        let t = self.time();
        let system = self.model.system();
        let Stepper::Fixed(integrator) = &mut self.stepper else {
            return Ok(());
        };
        self.contact.begin(obstacles(&self.model), &self.y, false);
        let cause = match integrator.step(system, t, h, &mut self.y) {
            Ok(work) => {
                self.work += work;
                settle(&self.model, &mut self.contact, (t, h), &mut self.y);
                self.beyond(LOST, &self.y)
            }
            Err(error) => Some(cause(error)?),
        };
        self.judge(cause, t + h)?;
        self.tear();
        Ok(())
    }

    /// Sees to it that an adaptive method's step reaches past the time shown. Where it ends.
    fn look_ahead(&mut self) -> Result<f64, Error> {
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
            self.contact.begin(obstacles(&self.model), end, true);
            let taken = match adaptive.advance(system, begin, end) {
                Ok(taken) => taken,
                Err(error) => break (Some(cause(error)?), begin),
            };
            self.work += taken.work;
            let met = settle(&self.model, &mut self.contact, (begin, taken.h), end);
            if met.depth > limit && taken.h > SHORT {
                // Again, to just after the touch.
                end.copy_from_slice(self.contact.y0());
                adaptive.restart();
                let share = met.touched + (1.0 - met.touched) * 0.5 * limit / met.depth;
                adaptive.try_first(taken.h * share);
                self.work.rejections += 1;
                continue;
            }
            if met.depth > 0.0 {
                // Under a constant force the depth grows with the square of the step.
                adaptive.try_at_most(taken.h * 0.9 * (limit / met.depth).sqrt());
            }
            let reached = begin + taken.h;
            *until = Some(reached);
            let Stepper::Adaptive { end, .. } = &self.stepper else {
                return Ok(now);
            };
            break (self.beyond(LOST, end), reached);
        };
        self.judge(cause, reached)?;
        Ok(reached)
    }

    /// Shows the state at a time (s) up to the end of an adaptive method's step: between its ends as its polynomial has
    /// it, with pins in their places.
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
                hold_pins(system, time, &mut self.y);
            }
            self.since = time;
            self.tear();
        }
    }

    /// Breaks what is stretched too far in the state shown.
    fn tear(&mut self) {
        if let Model::Network(network) = &mut self.model
            && network.tear(&self.y[..self.y.len() / 2]) > 0
        {
            self.look_again();
            self.refit();
        }
    }

    /// The state or the system is no longer the one that an adaptive method's last step knows.
    fn look_again(&mut self) {
        if let Stepper::Adaptive { until, .. } = &mut self.stepper {
            *until = None;
        }
    }

    /// Counts a step that ends at `time`. One that was lost goes back to the last state in shape.
    fn judge(&mut self, cause: Option<Cause>, time: f64) -> Result<(), Error> {
        self.steps += 1;
        let Some(cause) = cause else { return Ok(()) };
        let blow_up = BlowUp {
            method: self.method.title,
            control: self.control,
            step: self.steps,
            time,
            cause,
        };
        self.blow_up = Some(blow_up);
        let good = std::mem::replace(&mut self.good, Checkpoint::empty(self.method, self.control));
        let result = self.go_back(&good);
        self.good = good;
        result.and(Err(blow_up.into()))
    }

    /// The first particle that is farther than this many radii from the middle, if there is one.
    fn beyond(&self, radii: f64, y: &[f64]) -> Option<Cause> {
        let n = self.particles();
        let (x, v) = y.split_at(3 * n);
        let c = self.middle;
        let limit = (radii * self.radius).powi(2);
        let squared = |i: usize| {
            (x[i] - c.x).powi(2) + (x[n + i] - c.y).powi(2) + (x[2 * n + i] - c.z).powi(2)
        };
        // By blocks without a branch inside. Written so that NaN, which compares as false, is lost too.
        let near = |block: Range<usize>| block.fold(true, |near, i| near & (squared(i) <= limit));
        if !(0..n)
            .step_by(64)
            .all(|start| near(start..n.min(start + 64)))
        {
            let particle = (0..n).find(|&i| !near(i..i + 1))?;
            let distance = squared(particle).sqrt();
            return Some(if distance.is_finite() {
                Cause::Away { particle, distance }
            } else {
                Cause::NotFinite { particle }
            });
        }
        // Multiplying by zero leaves zero, unless the number is not finite.
        if v.iter().map(|v| v * 0.0).sum::<f64>() == 0.0 {
            return None;
        }
        v.iter()
            .position(|v| !v.is_finite())
            .map(|k| Cause::NotFinite { particle: k % n })
    }

    /// Back to the beginning, with what was torn mended. Wind and swing stay on if they are, and pins free;
    /// the hand lets go.
    pub fn reset(&mut self) {
        let (windy, swinging) = (self.windy(), self.swinging);
        self.model = self.scene.model.clone();
        self.y.copy_from_slice(&self.scene.state);
        (self.since, self.taken, self.steps) = (0.0, 0, 0);
        (self.work, self.blow_up) = (Work::default(), None);
        (self.grabbed, self.grabbed_obstacle) = (None, None);
        // The first step is chosen anew too: a run that was reset is the same run.
        if let Ok(stepper) = Stepper::new(self.method, self.model.system(), self.control) {
            self.stepper = stepper;
        }
        (self.swinging, self.swing_phase) = (false, 0.0);
        if std::mem::take(&mut self.unpinned) {
            self.set_pinned(false);
        }
        self.set_wind(windy);
        self.set_swinging(swinging);
    }

    /// Goes on with another method, in fixed steps or to a tolerance.
    ///
    /// # Errors
    /// The method does not serve the scene or does not take that control; the run goes on as before.
    pub fn set_method(&mut self, method: &'static Method, control: Control) -> Result<(), Error> {
        self.stepper = Stepper::new(method, self.model.system(), control)?;
        self.since = self.time();
        self.taken = 0;
        (self.method, self.control) = (method, control);
        Ok(())
    }

    /// Goes on in other steps, or to another tolerance.
    ///
    /// # Errors
    /// The method does not take that control; the run goes on as before.
    pub fn set_control(&mut self, control: Control) -> Result<(), Error> {
        let (Control::Step(_), Control::Step(_)) = (self.control, control) else {
            return self.set_method(self.method, control);
        };
        self.method.check_control(control)?;
        self.since = self.time();
        self.taken = 0;
        self.control = control;
        Ok(())
    }
}

fn obstacles(model: &Model) -> &[Obstacle] {
    model.network().map_or(&[], Network::obstacles)
}

/// What follows a step of h (s) from t (s) to y1: particles leave obstacles, and pins are in their places.
fn settle(model: &Model, contact: &mut Contact, (t, h): (f64, f64), y1: &mut [f64]) -> Statistics {
    let met = model.network().map_or_else(Statistics::default, |network| {
        contact.resolve(network.obstacles(), network.inverse_masses(), (t, h), y1)
    });
    hold_pins(model.system(), t + h, y1);
    met
}

/// Puts pins in their places at time t (s).
fn hold_pins(system: &dyn ParticleSystem, t: f64, y: &mut [f64]) {
    if let Some(mechanics) = system.mechanics() {
        let (x, v) = y.split_at_mut(y.len() / 2);
        place_pins(mechanics, t, x, v);
    }
}

/// The cause of a blow-up, if the error is of that kind.
fn cause(error: Error) -> Result<Cause, Error> {
    match error {
        Error::StepTooSmall { step, .. } => Ok(Cause::StepTooSmall { step }),
        Error::NoConvergence { residual } => Ok(Cause::NoConvergence { residual }),
        error => Err(error),
    }
}
