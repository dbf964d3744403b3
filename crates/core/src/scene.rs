//! Scenes: models, the states they start from, and the disturbances that their runs allow.

use std::borrow::Cow;
use std::sync::Arc;

use nalgebra::Vector3;

use crate::elements::{Sheet, Wind};
use crate::error::{Error, positive};
use crate::geometry::Shape;
use crate::grid::Grid;
use crate::integrators::Tolerance;
use crate::network::{Least, Network, Touch, fit, settle};
use crate::system::ParticleSystem;

/// Cost of an evaluation where surfaces touch, with the collision safeguard after a step, over the
/// cost with springs alone.
const CONTACT_COST: f64 = 100.0;

/// Cost of an evaluation of a fluid, whose particles have dozens of neighbours each, over the cost
/// with springs alone.
const FLUID_COST: f64 = 10.0;

/// Absolute tolerance of plain numbers over the relative one and the largest number at the start:
/// numbers that much smaller do not count. It separates a patient from a population of 10^9.
const PLAIN_SHARE: f64 = 1e-9;

/// Least absolute tolerance of plain numbers over the largest number at the start: a few rounding
/// errors. A number that is a difference of equal numbers is no more than these.
const PLAIN_ROUNDING: f64 = 1e-15;

/// First-order system, shared among runs.
pub type FirstOrder = Arc<dyn ParticleSystem + Send + Sync>;

/// Model of a scene.
#[derive(Clone)]
pub enum Model {
    /// First-order system y' = f(t, y) of any length. If it offers its
    /// [`mechanics`](ParticleSystem::mechanics), it has the particles of these; otherwise it has
    /// none, and errors are those of its plain numbers.
    FirstOrder(FirstOrder),
    /// First-order system whose state is the positions (m) of points, n x 3 in column-major order:
    /// f is their velocity.
    Points(FirstOrder),
    /// Network of masses and springs.
    Network(Box<Network>),
}

impl From<Network> for Model {
    fn from(network: Network) -> Self {
        Self::Network(Box::new(network))
    }
}

impl Model {
    /// Returns the model as the system that an integrator steps.
    #[must_use]
    pub fn system(&self) -> &dyn ParticleSystem {
        match self {
            Self::FirstOrder(system) | Self::Points(system) => system.as_ref(),
            Self::Network(network) => network.as_ref(),
        }
    }

    /// Returns the network of masses and springs; `None` for a first-order system.
    #[must_use]
    pub fn network(&self) -> Option<&Network> {
        match self {
            Self::FirstOrder(_) | Self::Points(_) => None,
            Self::Network(network) => Some(network),
        }
    }

    /// Returns the number of particles, whose positions the state begins with; 0 where it is plain
    /// numbers.
    #[must_use]
    pub fn particles(&self) -> usize {
        match self {
            Self::FirstOrder(system) => system.mechanics().map_or(0, |m| m.inverse_masses().len()),
            Self::Points(system) => system.dim() / 3,
            Self::Network(network) => network.particles(),
        }
    }

    /// Returns the energy (J) in the state y at time t (s) of a system of one's own that knows it.
    #[must_use]
    pub fn own_energy(&self, t: f64, y: &[f64]) -> Option<f64> {
        self.system().mechanics()?.energy(t, y)
    }

    /// Returns the number of particles whose velocities follow the positions in the state.
    pub(crate) fn particles_with_velocities(&self) -> usize {
        match self {
            Self::Points(_) => 0,
            Self::FirstOrder(_) | Self::Network(_) => self.particles(),
        }
    }

    /// Returns the number of coordinates that two states differ by, which come first in them: three
    /// of each particle or, where there are none, all numbers.
    pub(crate) fn coordinates(&self) -> usize {
        match self.particles() {
            0 => self.system().dim(),
            n => 3 * n,
        }
    }

    /// Returns the coordinates of a state y at time t (s), and their rates of change.
    pub(crate) fn motion<'a>(&self, t: f64, y: &'a [f64]) -> (&'a [f64], Cow<'a, [f64]>) {
        let n = 3 * self.particles_with_velocities();
        if n > 0 {
            return (&y[..n], Cow::Borrowed(&y[n..2 * n]));
        }
        let mut rates = vec![0.0; y.len()];
        self.system().eval_f(t, y, &mut rates);
        (y, Cow::Owned(rates))
    }

    /// Returns the cost of an evaluation, with the collision safeguard after a step, in evaluations
    /// of one particle on springs. Searches count it, so that they end at the same run on every
    /// machine. Three plain numbers count as a particle.
    #[must_use]
    pub fn work(&self) -> f64 {
        let each = |network: &Network| {
            if network.contact_layer().is_some() {
                CONTACT_COST
            } else if network.fluid().is_some() {
                FLUID_COST
            } else {
                1.0
            }
        };
        let particles = (self.coordinates() as f64 / 3.0).max(1.0);
        particles * self.network().map_or(1.0, each)
    }
}

/// Swing of all pins together: a displacement of `amplitude sin(rate t)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// Amplitude (m).
    pub amplitude: Vector3<f64>,
    /// Angular frequency (rad/s).
    pub rate: f64,
}

/// Disturbances of a scene, each on or off.
///
/// ```
/// use a3_core::{Disturbances, Network, Scene, Vector3, elements::Wind};
///
/// let mut scene = Scene::new("leaf", Network::new(vec![0.01])?, vec![0.0; 6]);
/// scene.wind = Some(Wind::new(1, Vector3::new(0.1, 0.0, 0.0)));
/// let on = Disturbances { wind: true, ..Disturbances::default() };
/// assert!(scene.disturbed(on)?.model.network().unwrap().wind().is_some());
/// # Ok::<(), a3_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Disturbances {
    /// Whether the scene's wind blows.
    pub wind: bool,
    /// Whether the pins swing.
    pub swing: bool,
    /// Whether surfaces touch one another and themselves.
    pub contact: bool,
}

/// Scene: a model, the state it starts from, and the disturbances that a run of it allows.
///
/// A decay y' = -50 y as a scene: explicit Euler is stable on it up to a step of 2 / 50 s.
///
/// ```
/// use std::sync::Arc;
///
/// use a3_core::stability::{largest_step, spectrum};
/// use a3_core::{Model, ParticleSystem, Scene, integrators};
///
/// struct Decay;
///
/// impl ParticleSystem for Decay {
///     fn dim(&self) -> usize { 1 }
///
///     fn eval_f(&self, _t: f64, y: &[f64], dydt: &mut [f64]) {
///         dydt[0] = -50.0 * y[0];
///     }
/// }
///
/// let scene = Scene::new("decay", Model::FirstOrder(Arc::new(Decay)), vec![1.0]);
/// let modes = spectrum(scene.model.system(), 0.0, &scene.state);
/// let euler = integrators::find("euler").unwrap();
/// let limit = largest_step(euler, &modes)?.unwrap();
/// assert!((limit.bounded - 0.04).abs() < 1e-8);
/// # Ok::<(), a3_core::Error>(())
/// ```
#[derive(Clone)]
pub struct Scene {
    /// Name, for messages and files.
    pub name: String,
    /// Model that is simulated.
    pub model: Model,
    /// State y at t = 0.
    pub state: Vec<f64>,
    /// Swing that the pins can be set to.
    pub swing: Option<Swing>,
    /// Wind that can be turned on.
    pub wind: Option<Wind>,
    /// Surfaces that can be made to touch one another and themselves.
    pub touch: Option<Arc<Touch>>,
    /// Largest length, in rest lengths, to which a hand pulls the springs of the particle it holds.
    pub reach: f64,
    /// Limits of adaptive steps.
    pub limits: StepLimits,
    /// Largest change (m/s) by which the velocities of the state were made to fit the constraints:
    /// 0 if they did.
    pub fitted: f64,
}

/// Limits of adaptive steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepLimits {
    /// Error of positions that a step may make (m); by default the tolerance times the scene's
    /// radius.
    pub absolute: Option<f64>,
    /// Longest step (s); by default the error and the prescribed motions alone limit it.
    pub max_step: Option<f64>,
}

impl StepLimits {
    /// Returns these limits, and the scene's `own` ones in place of those that are `None`.
    #[must_use]
    pub fn or(self, own: Self) -> Self {
        Self { absolute: self.absolute.or(own.absolute), max_step: self.max_step.or(own.max_step) }
    }
}

impl Scene {
    /// Creates a scene without swing, wind and surfaces that can touch, in which a hand pulls
    /// springs to at most ten rest lengths. It starts from `state` with the pins in the places and
    /// with the velocities of their paths: any others would act on the springs in the first step
    /// alone. Velocities that do not fit rods, joints and other constraints are changed least,
    /// weighted by the masses, so that they do, as by an impact.
    #[must_use]
    pub fn new(name: impl Into<String>, model: impl Into<Model>, mut state: Vec<f64>) -> Self {
        let mut model = model.into();
        let mut fitted = 0.0;
        if state.len() == model.system().dim() {
            model.system().hold(0.0, &mut state);
            if let Model::Network(network) = &mut model {
                let jump = fit(network, 0.0, &mut state, Least::AT_START);
                fitted = jump.map_or(0.0, |jump| jump.change);
                settle(network, 0.0, &state, 0.0);
            }
        }
        Self {
            name: name.into(),
            model,
            state,
            swing: None,
            wind: None,
            touch: None,
            reach: 10.0,
            limits: StepLimits::default(),
            fitted,
        }
    }

    /// Returns the grid of the first sheet of cloth, if there is one.
    #[must_use]
    pub fn grid(&self) -> Option<Grid> {
        self.model.network()?.sheets().next().map(Sheet::grid)
    }

    /// Returns the centre of the bounding box of the particles at t = 0 (m), and the radius of the
    /// scene (m): that of a ball about this centre with all particles and bodies, or half the rest
    /// length of the longest spring if that is more. If all particles are in one place, it is the
    /// first of these that is not 0: the length of the pins' motion, the distance of the nearest
    /// obstacle, the distance moved in a second at the initial speed or by gravity; or else 1.
    /// Without particles, the centre is the origin, and the radius the size of the largest number
    /// of the state.
    #[must_use]
    pub fn extent(&self) -> (Vector3<f64>, f64) {
        let n = self.model.particles();
        if self.state.len() != self.model.system().dim() {
            return (Vector3::zeros(), 1.0);
        }
        if n == 0 {
            let largest = self.state.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
            return (Vector3::zeros(), if largest > 0.0 { largest } else { 1.0 });
        }
        let positions = &self.state[..3 * n];
        let middle = middle(positions);
        let apart = |i: usize| (row(positions, i) - middle).norm();
        let mut radius = (0..n).map(apart).fold(0.0, f64::max);
        let fallback = match self.model.network() {
            None => middle.norm(),
            Some(network) => {
                for body in network.bodies() {
                    radius = radius.max(apart(body.center()) + body.radius());
                }
                let rests = network.all_springs().map(|spring| 0.5 * spring.law.rest_length);
                radius = rests.fold(radius, f64::max);
                self.reach_of_a_point(network, middle)
            }
        };
        let lengths = [radius, fallback, 1.0];
        let length = lengths.into_iter().find(|length| *length > 0.0);
        (middle, length.unwrap_or(1.0))
    }

    /// Returns the length (m) of a scene whose particles are all in one place, or 0.
    fn reach_of_a_point(&self, network: &Network, place: Vector3<f64>) -> f64 {
        let motions = network.pins().map(|(_, path)| path.length());
        let obstacles = network.obstacles().iter().map(|obstacle| {
            let away = place - obstacle.path.at(0.0).position;
            match obstacle.shape {
                Shape::Floor => away.y.abs(),
                _ => away.norm(),
            }
        });
        let nearest = obstacles.filter(|away| *away > 0.0).reduce(f64::min);
        let (_, v) = network.halves(&self.state);
        let speed = (0..network.particles()).map(|i| row(v, i).norm()).fold(0.0, f64::max);
        let fall = network.gravity().map_or(0.0, |g| 0.5 * g.norm());
        let motion = motions.fold(0.0, f64::max);
        let lengths = [motion, nearest.unwrap_or(0.0), speed.max(fall)];
        lengths.into_iter().find(|length| *length > 0.0).unwrap_or(0.0)
    }

    /// Returns the errors that a step may make under a relative tolerance.
    ///
    /// # Errors
    /// The tolerance, the scene's absolute one or its longest step is not a finite number above 0,
    /// or the system has [scales](ParticleSystem::scales) in place of an absolute one.
    pub fn tolerance(&self, relative: f64) -> Result<Tolerance, Error> {
        let own = || {
            let size = self.extent().1;
            match self.model.particles() {
                0 => (PLAIN_SHARE * relative).max(PLAIN_ROUNDING) * size,
                _ => relative * size,
            }
        };
        if self.limits.absolute.is_some() && !self.model.system().scales().is_empty() {
            let why = "errors are relative to the scales of the system: leave out the scales, or \
                       the absolute tolerance";
            return Err(Error::Invalid(why.into()));
        }
        if let Some(longest) = self.limits.max_step {
            positive("the longest step", longest)?;
        }
        let absolute = self.limits.absolute.unwrap_or_else(own);
        Tolerance::with_absolute(relative, absolute)
    }
}

/// Returns the centre of the bounding box of positions x (m).
fn middle(x: &[f64]) -> Vector3<f64> {
    let n = x.len() / 3;
    Vector3::from_fn(|axis, _| {
        let column = x[axis * n..(axis + 1) * n].iter();
        let (low, high) = column
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)));
        0.5 * (low + high)
    })
}

/// Returns row i of an n x 3 matrix.
fn row(a: &[f64], i: usize) -> Vector3<f64> {
    let n = a.len() / 3;
    Vector3::new(a[i], a[n + i], a[2 * n + i])
}
