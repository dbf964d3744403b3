//! Scenes: models, the states they start from, and what their runs can be disturbed by.

use std::sync::Arc;

use nalgebra::Vector3;

use crate::elements::{Element, Sheet, Wind};
use crate::grid::Grid;
use crate::network::{Network, Touch};
use crate::system::ParticleSystem;

/// What an evaluation with its guard costs where surfaces touch, over one of springs alone.
const TOUCHING: f64 = 100.0;

/// What an evaluation of a fluid, each of whose particles has dozens of neighbours, costs over that.
const FLUID: f64 = 10.0;

/// First-order system, shared among runs.
pub type FirstOrder = Arc<dyn ParticleSystem + Send + Sync>;

/// Model of a scene.
#[derive(Clone)]
pub enum Model {
    /// First-order system y' = f(t, y) whose state is n x 3 positions in column-major order.
    FirstOrder(FirstOrder),
    /// Network of masses and springs.
    Network(Box<Network>),
}

impl Model {
    /// Model as the system that an integrator steps.
    #[must_use]
    pub fn system(&self) -> &dyn ParticleSystem {
        match self {
            Self::FirstOrder(system) => system.as_ref(),
            Self::Network(network) => network.as_ref(),
        }
    }

    /// Network of masses and springs; `None` for a first-order system.
    #[must_use]
    pub fn network(&self) -> Option<&Network> {
        match self {
            Self::FirstOrder(_) => None,
            Self::Network(network) => Some(network),
        }
    }

    /// Number of particles.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.network()
            .map_or(self.system().dim() / 3, Network::particles)
    }

    /// Work of an evaluation, with the guard after a step, in evaluations of one particle on
    /// springs: what searches count to end at the same run on every machine.
    #[must_use]
    pub fn work(&self) -> f64 {
        let each = |network: &Network| {
            let mut elements = network.elements().iter();
            if network.contact_layer().is_some() {
                TOUCHING
            } else if elements.any(|element| matches!(element, Element::Fluid(_))) {
                FLUID
            } else {
                1.0
            }
        };
        self.particles() as f64 * self.network().map_or(1.0, each)
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

/// Scene: a model, the state it starts from, and what a run of it can be disturbed by.
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
}

impl Scene {
    /// Scene without swing, wind and surfaces that can touch, in which a hand pulls springs to at
    /// most ten rest lengths. It starts from `state` with the pins in their places, at rest or with
    /// the velocity of their paths: whatever else they were given would be felt by the springs in
    /// the first step alone.
    #[must_use]
    pub fn new(name: impl Into<String>, model: Model, mut state: Vec<f64>) -> Self {
        if state.len() == model.system().dim() {
            model.system().hold(0.0, &mut state);
        }
        Self {
            name: name.into(),
            model,
            state,
            swing: None,
            wind: None,
            touch: None,
            reach: 10.0,
        }
    }

    /// Grid of the first sheet of cloth, if there is one.
    #[must_use]
    pub fn grid(&self) -> Option<Grid> {
        self.model.network()?.sheets().next().map(Sheet::grid)
    }

    /// Centre of the bounding box of the particles at t = 0 (m), and the distance of the farthest
    /// particle from it (m), at least 1.
    #[must_use]
    pub fn extent(&self) -> (Vector3<f64>, f64) {
        bounds(&self.state[..(3 * self.model.particles()).min(self.state.len())])
    }
}

/// Centre of the bounding box of positions x (m), and the distance of the farthest of them from it
/// (m), at least 1.
pub(crate) fn bounds(x: &[f64]) -> (Vector3<f64>, f64) {
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
