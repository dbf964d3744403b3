//! Scene x method x time.

mod hands;

use std::ops::Range;

use nalgebra::{DMatrixView, Vector3};

use crate::error::{BlowUp, Cause, Error, positive};
use crate::integrators::{Integrator, Method, Work};
use crate::network::Energy;
use crate::scenes::{Model, Scene};

/// A particle this many times the scene's radius away from its middle is lost.
const LOST: f64 = 100.0;

/// The state to go back to when one is lost has all of them within this many radii: still a picture of the scene.
const GOOD: f64 = 3.0;

/// A run of a scene.
pub struct Simulation {
    scene: Scene,
    model: Model,
    method: &'static Method,
    integrator: Box<dyn Integrator>,
    step: f64,
    y: Vec<f64>,
    /// Time is `since + taken * step`, which gathers no rounding errors.
    since: f64,
    taken: u64,
    steps: u64,
    work: Work,
    swinging: bool,
    /// The swing's: while it swings, sin(rate t + phase); while it stands, sin(phase) (rad).
    swing_phase: f64,
    /// The grabbed particle, and whether it was pinned before.
    grabbed: Option<(usize, bool)>,
    blow_up: Option<BlowUp>,
    good: Good,
    middle: Vector3<f64>,
    radius: f64,
}

/// The state to go back to when a step fails.
struct Good {
    y: Vec<f64>,
    time: f64,
    steps: u64,
}

impl Simulation {
    /// A run from the scene's beginning, in steps of `step` (s).
    ///
    /// # Errors
    /// The method does not serve the scene, the scene's state has not the length of its model's, or the step is not
    /// above 0.
    pub fn new(scene: Scene, method: &'static Method, step: f64) -> Result<Self, Error> {
        positive("the step", step)?;
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
        let integrator = method.integrator(model.system())?;
        let y = scene.state.clone();
        let (middle, radius) = bounds(&y[..3 * model.particles()]);
        let good = Good {
            y: y.clone(),
            time: 0.0,
            steps: 0,
        };
        Ok(Self {
            scene,
            model,
            method,
            integrator,
            step,
            y,
            since: 0.0,
            taken: 0,
            steps: 0,
            work: Work::default(),
            swinging: false,
            swing_phase: 0.0,
            grabbed: None,
            blow_up: None,
            good,
            middle,
            radius,
        })
    }

    /// The scene as it was built.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The model as it is now: pins led, wind on or off.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The method.
    #[must_use]
    pub fn method(&self) -> &'static Method {
        self.method
    }

    /// The step asked for (s).
    #[must_use]
    pub fn step_size(&self) -> f64 {
        self.step
    }

    /// Simulated time (s).
    #[must_use]
    pub fn time(&self) -> f64 {
        self.since + self.taken as f64 * self.step
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
            self.advance(self.step)?;
            self.taken += 1;
        }
        Ok(())
    }

    /// Goes on to `time` (s) exactly, if it is not past it: the last step is shortened. As
    /// [`take_steps`](Self::take_steps) when a step blows up.
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
            let left = time - self.time();
            // A last sliver of a rounding error's size is no step of its own.
            if left > self.step * (1.0 + 1e-9) {
                self.advance(self.step)?;
                self.taken += 1;
            } else {
                self.advance(left)?;
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
        if self.beyond(GOOD).is_none() {
            self.good.y.copy_from_slice(&self.y);
            self.good.time = self.time();
            self.good.steps = self.steps;
        }
        Ok(())
    }

    /// One step of h, and what follows it: constraints, and the look whether it went well.
    fn advance(&mut self, h: f64) -> Result<(), Error> {
        let t = self.time();
        let system = self.model.system();
        let work = self.integrator.step(system, t, h, &mut self.y)?;
        self.work += work;
        self.steps += 1;
        if let Some(mechanics) = system.mechanics() {
            let half = self.y.len() / 2;
            let (x, v) = self.y.split_at_mut(half);
            mechanics.constrain(t + h, x, v);
        }
        if let Some(cause) = self.beyond(LOST) {
            let blow_up = BlowUp {
                method: self.method.title,
                setting: self.step,
                step: self.steps,
                time: t + h,
                cause,
            };
            self.blow_up = Some(blow_up);
            self.y.copy_from_slice(&self.good.y);
            self.since = self.good.time;
            self.taken = 0;
            self.steps = self.good.steps;
            return Err(blow_up.into());
        }
        Ok(())
    }

    /// The first particle that is farther than this many radii from the middle, if there is one.
    fn beyond(&self, radii: f64) -> Option<Cause> {
        let n = self.particles();
        let x = &self.y[..3 * n];
        let v = &self.y[3 * n..];
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

    /// Back to the beginning. Wind and swing stay on if they are; the hand lets go.
    pub fn reset(&mut self) {
        let (windy, swinging) = (self.windy(), self.swinging);
        self.model = self.scene.model.clone();
        self.y.copy_from_slice(&self.scene.state);
        (self.since, self.taken, self.steps) = (0.0, 0, 0);
        (self.work, self.blow_up, self.grabbed) = (Work::default(), None, None);
        (self.swinging, self.swing_phase) = (false, 0.0);
        self.set_wind(windy);
        self.set_swinging(swinging);
    }

    /// Goes on with another method.
    ///
    /// # Errors
    /// The method does not serve the scene; the run goes on as before.
    pub fn set_method(&mut self, method: &'static Method) -> Result<(), Error> {
        self.integrator = method.integrator(self.model.system())?;
        self.method = method;
        Ok(())
    }

    /// Goes on in other steps (s).
    ///
    /// # Errors
    /// The step is not above 0; the run goes on as before.
    pub fn set_step(&mut self, step: f64) -> Result<(), Error> {
        positive("the step", step)?;
        self.since = self.time();
        self.taken = 0;
        self.step = step;
        Ok(())
    }
}

/// The middle of the smallest upright box around the particles, and the distance of the farthest from it, at least 1.
fn bounds(x: &[f64]) -> (Vector3<f64>, f64) {
    let n = x.len() / 3;
    let range = |axis: usize| {
        let column = &x[axis * n..(axis + 1) * n];
        column
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| {
                (low.min(x), high.max(x))
            })
    };
    let middle = Vector3::from_fn(|axis, _| {
        let (low, high) = range(axis);
        0.5 * (low + high)
    });
    let radius = (0..n)
        .map(|i| (Vector3::new(x[i], x[n + i], x[2 * n + i]) - middle).norm())
        .fold(1.0, f64::max);
    (middle, radius)
}
