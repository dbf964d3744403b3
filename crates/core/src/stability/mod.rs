//! Stability of methods: modes of motion, their growth in one step, and the largest step with which
//! a run stays bounded, at rest (`rest`) and in motion (`motion`).
//!
//! A mode is x'' = -w^2 x - 2 d x', where 2 d is the sum of drag and damping over mass. Its
//! eigenvalues are l = -d +- i sqrt(w^2 - d^2). A Runge-Kutta method multiplies the mode by R(h l);
//! the step of a splitting method is a 2 x 2 matrix that no single R(z) gives. No formula is
//! written down here for either: the method takes a step on the mode, and the spectral radius of
//! the matrix of that step is the growth.

mod eigenvalues;
mod limit;
mod linearised;
mod motion;
mod normalised;
mod observation;
mod pencil;
mod rest;
mod search;
mod spectrum;

use nalgebra::Vector3;

use crate::columns::columns_mut;
use crate::coupling::{AxialCoupling, Coupling};
use crate::elements::Flow;
use crate::error::Error;
use crate::integrators::{Integrator, Method};
use crate::path::Place;
use crate::spring::SpringLaw;
use crate::system::{Compliant, Linearized, Mechanics, Splitting, place_pins};

pub use limit::{GROWTH, HORIZON, Limit, STEPS, largest_step, tenfold_time};
pub use motion::Motion;
pub use observation::Observation;
pub use rest::{RestState, observe_at_rest, rest};
pub use search::Budget;
pub use spectrum::{LargestMode, spectrum};

/// Rate of growth, over the frequency, that differences of forces may show of a mode that does not
/// grow.
const ROUNDING: f64 = 1e-6;

/// Mode of motion x'' = -stiffness x - (drag + damping) x'.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mode {
    /// Stiffness over mass, the angular frequency squared (1/s2).
    pub stiffness: f64,
    /// Viscous drag over mass (1/s).
    pub drag: f64,
    /// Damping of the springs over mass (1/s).
    pub damping: f64,
    /// Whether forces other than drag depend on velocities in the system, if not in this mode:
    /// splitting methods then have other kicks.
    pub reads_velocity: bool,
}

impl Mode {
    /// Mode with the eigenvalue re + i im (1/s) and its conjugate, damped by drag.
    #[must_use]
    pub fn of_eigenvalue(re: f64, im: f64) -> Self {
        Self {
            stiffness: re * re + im * im,
            drag: -2.0 * re,
            ..Self::default()
        }
    }

    /// Angular frequency w of the undamped mode (rad/s); 0 for negative stiffness.
    #[must_use]
    pub fn frequency(&self) -> f64 {
        self.stiffness.max(0.0).sqrt()
    }

    /// Whether it has a restoring force and does not grow by itself, but for rounding.
    #[must_use]
    pub fn returns(&self) -> bool {
        self.stiffness > 0.0 && self.drag + self.damping >= -ROUNDING * self.frequency()
    }

    /// Both eigenvalues as [re, im] (1/s).
    #[must_use]
    pub fn eigenvalues(&self) -> [[f64; 2]; 2] {
        let half = 0.5 * (self.drag + self.damping);
        let square = half * half - self.stiffness;
        if square < 0.0 {
            let im = (-square).sqrt();
            [[-half, im], [-half, -im]]
        } else {
            let root = square.sqrt();
            [[-half + root, 0.0], [-half - root, 0.0]]
        }
    }
}

/// Mode as a mechanical system along one axis: particles 0 and 1, of unit mass, are each tied to
/// particle 2, which is pinned at the origin.
struct Tied(Mode);

impl Mechanics for Tied {
    fn inverse_masses(&self) -> &[f64] {
        &[1.0, 1.0, 0.0]
    }

    fn forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        self.kick_forces(t, x, v, f);
        for (f, v) in f.iter_mut().zip(v) {
            *f -= self.0.drag * v;
        }
    }

    fn pins(&self, _t: f64, visit: &mut dyn FnMut(usize, Place)) {
        visit(2, Place::still(Vector3::zeros()));
    }

    fn splitting(&self) -> Option<&dyn Splitting> {
        Some(self)
    }

    fn linearized(&self) -> Option<&dyn Linearized> {
        Some(self)
    }

    fn compliant(&self) -> Option<&dyn Compliant> {
        Some(self)
    }
}

impl Compliant for Tied {
    fn springs(&self, visit: &mut dyn FnMut([usize; 2], SpringLaw)) {
        let law = SpringLaw {
            stiffness: self.0.stiffness,
            rest_length: 0.0,
            damping: self.0.damping,
        };
        visit([0, 2], law);
        visit([1, 2], law);
    }

    fn other_forces(&self, _t: f64, _x: &[f64], _v: &[f64], f: &mut [f64]) {
        f.fill(0.0);
    }

    fn drag_coefficient(&self) -> f64 {
        self.0.drag
    }
}

impl Splitting for Tied {
    fn kick_forces(&self, _t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        for ((f, x), v) in f.iter_mut().zip(x).zip(v) {
            *f = -self.0.stiffness * x - self.0.damping * v;
        }
    }

    fn kick_reads_velocity(&self) -> bool {
        self.0.reads_velocity || self.0.damping != 0.0
    }

    fn drift(&self, t: f64, h: f64, x: &mut [f64], v: &mut [f64]) {
        let flow = Flow::new(self.0.drag, Vector3::zeros(), 1.0, h);
        flow.apply(columns_mut(x), columns_mut(v));
        place_pins(self, t + h, x, v);
    }
}

impl Linearized for Tied {
    fn force_differential(
        &self,
        t: f64,
        _x: &[f64],
        _v: &[f64],
        dx: &[f64],
        dv: &[f64],
        df: &mut [f64],
    ) {
        self.forces(t, dx, dv, df);
    }

    fn couplings(&self, _t: f64, _x: &[f64], _clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        for i in 0..2 {
            visit(Coupling::Axial(AxialCoupling {
                i,
                j: 2,
                direction: [1.0, 0.0, 0.0],
                along: self.0.stiffness,
                across: self.0.stiffness,
                damping: self.0.damping,
            }));
        }
    }

    fn drag_coefficient(&self) -> f64 {
        self.0.drag
    }
}

/// Growth of a mode in one step of a method.
pub struct Growth {
    system: Tied,
    integrator: Box<dyn Integrator>,
}

impl Growth {
    /// Growth of `mode` by `method`.
    ///
    /// # Errors
    /// The method does not serve damped springs, which damp the mode.
    pub fn new(method: &Method, mode: Mode) -> Result<Self, Error> {
        let system = Tied(mode);
        let integrator = method.integrator(&system)?;
        Ok(Self { system, integrator })
    }

    /// Matrix of a step of h (s) on x times the frequency and on v: a, b, c, d row by row. `None`
    /// where the step fails.
    fn matrix(&mut self, h: f64) -> Option<[f64; 4]> {
        let mut y = [0.0; 18];
        // Particle 0 starts with x = 1, particle 1 with v = `unit`: v is scaled by the frequency,
        // so that x and v have similar magnitudes.
        let unit = self.system.0.frequency().max(1e-3);
        (y[0], y[10]) = (1.0, unit);
        let stepped = self.integrator.step(&self.system, 0.0, h, &mut y);
        let matrix = [y[0], y[1], y[9] / unit, y[10] / unit];
        (stepped.is_ok() && matrix.iter().all(|m| m.is_finite())).then_some(matrix)
    }

    /// Spectral radius of the matrix of a step of h (s), for a Runge-Kutta method the larger |R(h
    /// l)| of both eigenvalues l. Infinite where the step fails.
    pub fn of_step(&mut self, h: f64) -> f64 {
        let Some([a, b, c, d]) = self.matrix(h) else {
            return f64::INFINITY;
        };
        let (half_trace, determinant) = (0.5 * (a + d), a * d - b * c);
        let square = half_trace * half_trace - determinant;
        let radius = if square < 0.0 {
            determinant.sqrt()
        } else {
            half_trace.abs() + square.sqrt()
        };
        if radius.is_nan() {
            f64::INFINITY
        } else {
            radius
        }
    }

    /// Largest energy over the least that a mode has in steps of h (s) apart from growth and decay.
    ///
    /// Steps move x w and v round an ellipse, c x^2 + (d - a) x v - b v^2 = const., and this is the
    /// square of the ratio of its axes. It is 1 for a Runge-Kutta method without damping; for
    /// Verlet's method it is 1 / (1 - (h w)^2 / 4), and has no bound at the limit. 1 where the step
    /// fails or its matrix has real eigenvalues.
    pub fn swing(&mut self, h: f64) -> f64 {
        let Some([a, b, c, d]) = self.matrix(h) else {
            return 1.0;
        };
        let determinant = -b * c - 0.25 * (d - a).powi(2);
        if determinant <= 0.0 {
            return 1.0;
        }
        let half = 0.5 * (c - b).abs();
        let root = (half * half - determinant).max(0.0).sqrt();
        (half + root) / (half - root)
    }
}
