//! Scenes. A scene is data: a model, the state it starts from, and what a hand or an eye needs.

use std::sync::Arc;

use nalgebra::Vector3;

use crate::control::Control;
use crate::elements::Wind;
use crate::grid::Grid;
use crate::integrators::Method;
use crate::network::Network;
use crate::surface::Surface;
use crate::system::ParticleSystem;

/// A first-order system that can be shared with its runs.
pub type FirstOrder = Arc<dyn ParticleSystem + Send + Sync>;

/// What is simulated.
#[derive(Clone)]
pub enum Model {
    /// Any y' = f(t, y) whose state is n x 3 positions, column-major.
    FirstOrder(FirstOrder),
    /// Masses and springs.
    Network(Box<Network>),
}

impl Model {
    /// The model as an integrator sees it.
    #[must_use]
    pub fn system(&self) -> &dyn ParticleSystem {
        match self {
            Self::FirstOrder(system) => system.as_ref(),
            Self::Network(network) => network.as_ref(),
        }
    }

    /// The masses and springs, if it has any.
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
}

/// How pins swing: to and fro by `amplitude`, at `rate`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// In m.
    pub amplitude: Vector3<f64>,
    /// In rad/s.
    pub rate: f64,
}

/// Where an eye looks from, and at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// In m.
    pub eye: Vector3<f64>,
    /// In m.
    pub target: Vector3<f64>,
}

/// A model with the state it starts from.
#[derive(Clone)]
pub struct Scene {
    /// As in the table, or in its file.
    pub name: String,
    /// What is simulated.
    pub model: Model,
    /// y at t = 0.
    pub state: Vec<f64>,
    /// The grid of its cloth.
    pub grid: Option<Grid>,
    /// What is drawn as a surface.
    pub surface: Arc<Surface>,
    /// What key `s` does to the pins.
    pub swing: Option<Swing>,
    /// What key `d` lets blow.
    pub wind: Option<Wind>,
    /// The particle whose way is drawn.
    pub trail: Option<usize>,
    /// Where to look from.
    pub view: View,
    /// A method's default step times this holds: less than 1 for a cloth finer than its own grid.
    pub step_scale: f64,
    /// The method to begin with, if the scene says one.
    pub solver: Option<&'static Method>,
    /// Its step or tolerance.
    pub control: Option<Control>,
    /// How long it is run where no one says (s).
    pub duration: Option<f64>,
    /// A hand stretches the springs it holds to this many times their rest length, and then waits for the other end.
    /// Less than 10 only where more would blow up a run that otherwise holds.
    pub reach: f64,
}

impl Scene {
    /// A model and the state it starts from, without surface, hands and wind, seen from the front and a little from the
    /// right and from above.
    #[must_use]
    pub fn new(name: impl Into<String>, model: Model, state: Vec<f64>) -> Self {
        let (target, radius) = bounds(&state[..(3 * model.particles()).min(state.len())]);
        let eye = target + Vector3::new(0.5, 0.15, 1.0).normalize() * (2.8 * radius);
        Self {
            name: name.into(),
            model,
            state,
            grid: None,
            surface: Arc::default(),
            swing: None,
            wind: None,
            trail: None,
            view: View { eye, target },
            step_scale: 1.0,
            solver: None,
            control: None,
            duration: None,
            reach: 10.0,
        }
    }

    /// The middle of the smallest upright box around the particles at t = 0 (m), and the distance of the farthest from it
    /// (m), at least 1.
    #[must_use]
    pub fn extent(&self) -> (Vector3<f64>, f64) {
        bounds(&self.state[..3 * self.model.particles()])
    }

    /// The method's step on this scene to two digits, as one would type it, or its tolerance: the scene's own, or the
    /// method's default.
    #[must_use]
    pub fn default_control(&self, method: &Method) -> Control {
        let own = self.control.filter(|_| {
            self.solver
                .is_some_and(|solver| std::ptr::eq(solver, method))
        });
        match own.unwrap_or(method.default_control) {
            Control::Step(step) if self.step_scale != 1.0 => {
                let step = step * self.step_scale;
                Control::Step(format!("{step:.1e}").parse().unwrap_or(step))
            }
            control => control,
        }
    }
}

/// The middle of the smallest upright box around the particles, and the distance of the farthest from it, at least 1.
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
