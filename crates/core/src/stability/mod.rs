//! Stability: modes of motion, their growth in one step of a method, and the largest step with
//! which none grows.
//!
//! A mode is x'' = -w2 x - (drag + damping) x', with eigenvalues l = -(drag + damping)/2 +- i
//! sqrt(w2 - ...). A Runge-Kutta method multiplies it by R(h l); a splitting method's step is a
//! matrix that no single R(z) gives. So neither is written down here: the method takes a step on
//! the mode, and the largest eigenvalue of what it did is its growth.

mod observed;
mod spectrum;

use std::array;

use nalgebra::Vector3;

use crate::columns::columns_mut;
use crate::elements::Flow;
use crate::error::Error;
use crate::integrators::{Integrator, Method};
use crate::path::Place;
use crate::system::{AxialCoupling, Coupling, Linearized, Mechanics, Splitting, place_pins};

pub use observed::{
    Observation, Rest, Truth, modes_in_motion, observe_at_rest, observe_from_start, rest,
};
pub use spectrum::{LargestMode, spectrum};

/// A run is stable if no mode grows more than [`GROWTH`] times in this time (s), or in [`STEPS`] if
/// they take longer. Methods that have a limit are as good as strict about it then; those that
/// always grow, and slowly, get the step with which they do for so long.
pub const HORIZON: f64 = 10.0;
/// See [`HORIZON`].
pub const STEPS: f64 = 1000.0;
/// See [`HORIZON`].
pub const GROWTH: f64 = 10.0;

/// Number of steps of h (s) in which no mode may grow.
fn steps(h: f64) -> f64 {
    (HORIZON / h).ceil().max(STEPS)
}

/// A mode of motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mode {
    /// Stiffness over mass, the angular frequency squared (1/s2).
    pub stiffness: f64,
    /// Viscous drag over mass (1/s).
    pub drag: f64,
    /// Damping of the springs over mass (1/s).
    pub damping: f64,
}

impl Mode {
    /// The mode with the eigenvalue re + i im (1/s) and its conjugate, damped by drag.
    #[must_use]
    pub fn of_eigenvalue(re: f64, im: f64) -> Self {
        Self {
            stiffness: re * re + im * im,
            drag: -2.0 * re,
            damping: 0.0,
        }
    }

    /// Angular frequency w (rad/s).
    #[must_use]
    pub fn frequency(&self) -> f64 {
        self.stiffness.max(0.0).sqrt()
    }

    /// Both eigenvalues, [re, im] (1/s).
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

/// The mode as a system: particle 0 starts from x = 1, particle 1 from v = 1, and both are tied to
/// particle 2, which is pinned. They move along one axis.
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
}

impl Splitting for Tied {
    fn kick_forces(&self, _t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        for ((f, x), v) in f.iter_mut().zip(x).zip(v) {
            *f = -self.0.stiffness * x - self.0.damping * v;
        }
    }

    fn kick_reads_velocity(&self) -> bool {
        self.0.damping != 0.0
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

    fn couplings(&self, _x: &[f64], _clamped: bool, visit: &mut dyn FnMut(Coupling)) {
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
    /// A method and a mode.
    ///
    /// # Errors
    /// Never fails for a method in [`METHODS`](crate::integrators::METHODS).
    pub fn new(method: &Method, mode: Mode) -> Result<Self, Error> {
        let system = Tied(mode);
        let integrator = method.integrator(&system)?;
        Ok(Self { system, integrator })
    }

    /// The spectral radius of a step of h (s): |R(h l)| of a Runge-Kutta method, of the larger of
    /// both eigenvalues. Infinite where the step fails.
    pub fn of_step(&mut self, h: f64) -> f64 {
        let mut y = [0.0; 18];
        // In a unit of time in which neither x nor v is small.
        let unit = self.system.0.frequency().max(1e-3);
        (y[0], y[10]) = (1.0, unit);
        if self.integrator.step(&self.system, 0.0, h, &mut y).is_err() {
            return f64::INFINITY;
        }
        let [a, b, c, d] = [y[0], y[1], y[9] / unit, y[10] / unit];
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
}

/// Limit of stability of a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Largest stable step (s); infinite if every step is stable.
    pub step: f64,
    /// Whether no mode grows at all with shorter steps. If not, modes grow less than [`GROWTH`]
    /// times within [`HORIZON`].
    pub strict: bool,
    /// Index of the mode that sets the limit.
    pub mode: usize,
}

/// The largest step (s) with which no mode grows, as [`HORIZON`] says: all shorter steps hold too.
/// Modes without a restoring force are left out: falling and buckling are no fault of the method.
/// `None` without any mode.
///
/// # Errors
/// Never fails for a method in [`METHODS`](crate::integrators::METHODS).
pub fn largest_step(method: &Method, modes: &[Mode]) -> Result<Option<Limit>, Error> {
    let mut limit: Option<Limit> = None;
    for (k, mode) in modes.iter().enumerate().filter(|(_, m)| m.stiffness > 0.0) {
        let mut growth = Growth::new(method, *mode)?;
        let fails = |growth: &mut Growth, h: f64| growth.of_step(h).ln() * steps(h) > GROWTH.ln();
        // Fast motion by stiffness or by damping.
        let rate = mode.frequency().max(mode.drag + mode.damping);
        let longest = limit.map_or(1e4 / rate, |limit| limit.step.min(1e4 / rate));
        let mut h = 1e-3 / rate;
        let mut below = 0.0;
        while h < longest && !fails(&mut growth, h) {
            below = h;
            // Finely for the first mode; for the others the search is as a rule in vain.
            h *= if limit.is_none() { 1.05 } else { 1.25 };
        }
        if h >= longest && !fails(&mut growth, longest) {
            let unlimited = Limit {
                step: f64::INFINITY,
                strict: true,
                mode: k,
            };
            limit = limit.or(Some(unlimited));
            continue;
        }
        let [mut low, mut high] = [below, h.min(longest)];
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if fails(&mut growth, middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        let strict = array::from_fn::<_, 8, _>(|i| 0.1 * (i + 1) as f64 * low)
            .iter()
            .all(|&h| growth.of_step(h) < 1.0 + 1e-13);
        limit = Some(Limit {
            step: low,
            strict,
            mode: k,
        });
    }
    Ok(limit)
}
