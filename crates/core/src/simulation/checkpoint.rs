//! Checkpoints of a run: all data from which it continues bit for bit.

use serde::{Deserialize, Serialize};

use super::disturbances::{let_touch, touches_itself};
use super::driver::{Driver, Progress};
use super::pins::strayed;
use super::state::RunState;
use crate::contact::Shape;
use crate::elements::Wind;
use crate::error::Error;
use crate::network::{Network, drained, go_back, pass_to, set_drained, set_taut, taut};
use crate::path::Path;
use crate::pin::Pin;
use crate::rigid::{Body, ROTATION, Rotation};
use crate::scene::{Model, Scene};

/// Largest distance of a particle from the origin in a run, over the radius of its scene; also the
/// largest speed, over that radius in a second.
const MAX_SHARE: f64 = 1e12;
/// Radius (m) of a smaller scene for that: a run may leave a scene of one place far behind.
const LEAST_RADIUS: f64 = 1.0;

/// A run at one time: all data, except its scene, from which it continues bit for bit.
///
/// It contains neither the scene nor its [adjustments](crate::Simulation::adjust), such as a
/// changed stiffness of springs: restore it in a run of the same scene, adjusted alike. It contains
/// the last step of an adaptive method if [`checkpoint`](crate::Simulation::checkpoint) made it,
/// but not if [`record`](crate::Simulation::record) did.
///
/// ```
/// use a3_core::{Control, Ode, Scene, Simulation, integrators};
///
/// let growth = Ode::new(1, |_t, y, dydt| dydt[0] = y[0] * (1.0 - y[0]))?;
/// let scene = Scene::new("growth", growth, vec![0.1]);
/// let dopri5 = integrators::find("dopri5").unwrap();
/// let mut run = Simulation::new(scene, dopri5, Control::Tolerance(1e-8))?;
/// run.advance_to(1.0)?;
/// let kept = run.checkpoint();
/// run.advance_to(2.0)?;
/// let end = run.state().to_vec();
/// run.restore(&kept)?;
/// run.advance_to(2.0)?;
/// assert_eq!(run.state(), end);
/// # Ok::<(), a3_core::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// State of the run.
    pub run: RunState,
    /// Pins, also those that have let go.
    pub pins: Vec<Pin>,
    /// Numbers and paths of the obstacles, except floors.
    pub obstacles: Vec<(usize, Path)>,
    /// The wind that blows.
    pub wind: Option<Wind>,
    /// Whether surfaces touch one another and themselves.
    pub touching: bool,
    /// Springs that have broken, by the particles at their ends, the lower number first, in order.
    pub torn: Vec<[usize; 2]>,
    /// Particles that have left the fluid, in order.
    pub drained: Vec<u32>,
    /// Ropes that are taut, by their numbers among the constraints, in order.
    pub taut: Vec<usize>,
    /// Progress within a step, and of an adaptive method.
    pub progress: Progress,
}

impl Checkpoint {
    /// Creates a checkpoint of a run in a state, without the last step of an adaptive method.
    pub(super) fn of(state: &RunState, model: &Model, driver: &Driver) -> Self {
        let mut moment = Self {
            run: state.clone(),
            pins: vec![],
            obstacles: vec![],
            wind: None,
            touching: false,
            torn: vec![],
            drained: vec![],
            taut: vec![],
            progress: Progress::default(),
        };
        moment.record_changes(state, model, driver);
        moment
    }

    /// Overwrites this checkpoint with a new one, and reuses its memory.
    pub(super) fn record(&mut self, state: &RunState, model: &Model, driver: &Driver) {
        self.run.copy_from(state);
        self.record_changes(state, model, driver);
    }

    /// Records how hands, time and tears have changed the model.
    fn record_changes(&mut self, state: &RunState, model: &Model, driver: &Driver) {
        self.pins.clear();
        self.obstacles.clear();
        self.torn.clear();
        self.drained.clear();
        self.taut.clear();
        let network = model.network();
        if let Some(network) = network {
            self.pins.extend(network.all_pins());
            let obstacles = network.obstacles().iter().enumerate();
            self.obstacles.extend(
                obstacles
                    .filter(|(_, obstacle)| obstacle.shape != Shape::Floor)
                    .map(|(k, obstacle)| (k, obstacle.path)),
            );
            self.torn.extend_from_slice(network.torn());
            self.drained.extend_from_slice(drained(network));
            self.taut.extend(taut(network));
        }
        self.wind = network.and_then(Network::wind).copied();
        self.touching = model.network().is_some_and(touches_itself);
        self.progress = driver.progress(false);
        if driver.is_within() {
            self.run.set_time(state.time());
        }
    }

    /// Returns the simulated time (s).
    #[must_use]
    pub fn time(&self) -> f64 {
        self.run.time()
    }

    /// Returns the memory of a checkpoint without the last step of an adaptive method (bytes).
    #[must_use]
    pub fn size(&self) -> usize {
        size_of::<Self>()
            + size_of_val(&self.run.y[..])
            + size_of_val(&self.pins[..])
            + size_of_val(&self.obstacles[..])
            + size_of_val(&self.torn[..])
            + size_of_val(&self.drained[..])
            + size_of_val(&self.taut[..])
    }

    /// Checks that the state is one of a system of this dimension, and finite, and that no time is
    /// before the start.
    pub(super) fn check(&self, dim: usize) -> Result<(), Error> {
        let y = &self.run.y;
        if y.len() != dim {
            return Err(Error::Dimension { expected: dim, found: y.len() });
        }
        let times = [self.run.since, self.run.end(), self.time()];
        let is_time = |t: &f64| t.is_finite() && *t >= 0.0;
        if !times.iter().all(is_time) || y.iter().any(|y| !y.is_finite()) {
            return Err(Error::Invalid(
                "the state and the time of a checkpoint must be finite, and not before the start"
                    .into(),
            ));
        }
        Ok(())
    }

    /// Returns the model of a scene with this checkpoint's pins, obstacles, wind, contact and
    /// tears.
    pub(super) fn model(&self, scene: &Scene) -> Result<Model, Error> {
        let mut model = scene.model.clone();
        if let (Model::Network(network), Some(whole)) = (&mut model, scene.model.network()) {
            if self.touching != scene.model.network().is_some_and(touches_itself) {
                let_touch(network, scene, self.touching)?;
            }
            self.bind(network, whole)?;
            self.check_motion(network, scene.extent().1)?;
        }
        Ok(model)
    }

    /// Checks that a run of a network of that radius (m) can be in this state: nothing is too far
    /// away or too fast, and pins hold their particles.
    fn check_motion(&self, network: &Network, radius: f64) -> Result<(), Error> {
        let (n, y) = (network.particles(), &self.run.y);
        let wrong = |what: &str, i: usize| {
            Error::Invalid(format!("no run can have {what} {i} as this checkpoint has it"))
        };
        let (motion, rotations) = y.split_at(6 * n);
        let radius = radius.max(LEAST_RADIUS);
        let is_far = |number: &f64| number.abs() > MAX_SHARE * radius;
        if let Some(k) = motion.iter().position(is_far) {
            return Err(wrong("particle", k % n));
        }
        if let Some(i) = strayed(network, y, self.time(), radius).first() {
            return Err(wrong("the pinned particle", *i));
        }
        let rotations = rotations.chunks_exact(ROTATION).map(Rotation::read);
        let mut bodies = network.bodies().iter().zip(rotations);
        let is_wrong = |(body, Rotation { q, momentum }): (&Body, Rotation)| {
            body.speed() * momentum.norm() > MAX_SHARE * radius || q.norm() == 0.0
        };
        match bodies.position(is_wrong) {
            Some(k) => Err(wrong("body", k)),
            None => Ok(()),
        }
    }

    /// Applies this checkpoint's pins, obstacles, wind, tears and outflow to a fresh copy of the
    /// scene's network.
    fn bind(&self, network: &mut Network, whole: &Network) -> Result<(), Error> {
        if network.torn() != self.torn {
            network.mend(whole, &self.torn)?;
        }
        for (i, _) in whole.pins() {
            network.unpin(i);
        }
        network.pin_all(self.pins.clone())?;
        set_drained(network, &self.drained);
        pass_to(network, self.time());
        for (k, path) in &self.obstacles {
            network.lead_obstacle(*k, *path)?;
        }
        set_taut(network, &self.taut);
        network.set_wind(self.wind);
        if let Some(grabbed) = &self.run.grabbed {
            network.check_particle(grabbed.particle)?;
            grabbed.attract(network);
        }
        if let Some(k) = self.run.grabbed_obstacle {
            network.check_obstacle(k)?;
        }
        Ok(())
    }

    /// Restores torn springs, the liquid that has flowed out, the paths of obstacles and
    /// self-contact in a network of the run, and lets its pins hold that hold then.
    /// Returns whether that changes its forces.
    fn mend(&self, network: &mut Network, scene: &Scene) -> Result<bool, Error> {
        let drained = go_back(network, &self.run.y, &self.drained);
        pass_to(network, self.time());
        let touching = network.touch().is_some_and(|touch| touch.bodies);
        for (k, path) in &self.obstacles {
            network.lead_obstacle(*k, *path)?;
        }
        set_taut(network, &self.taut);
        let torn = network.torn() != self.torn;
        if torn && let Some(whole) = scene.model.network() {
            network.mend(whole, &self.torn)?;
        }
        if self.touching != touching {
            let_touch(network, scene, self.touching)?;
        }
        Ok(torn || drained || self.touching != touching)
    }

    /// Sets a run of a scene back to this moment; it continues from there by its own method.
    ///
    /// # Errors
    /// The moment is of another scene.
    pub(super) fn put_back(
        &self,
        scene: &Scene,
        model: &mut Model,
        state: &mut RunState,
        driver: &mut Driver,
    ) -> Result<(), Error> {
        if let Model::Network(network) = model
            && self.mend(network, scene)?
        {
            driver.pipeline.stepper.refit(state.method, model.system());
        }
        state.go_back(&self.run);
        driver.forget();
        driver.stop(model, state);
        Ok(())
    }
}
