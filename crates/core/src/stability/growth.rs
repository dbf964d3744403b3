//! Growth of modes by a method.

use super::mode::Mode;
use super::tied::Tied;
use crate::error::Error;
use crate::failure::succeeded;
use crate::integrators::{Integrator, Method};

/// Growth of a mode in one step of a method.
///
/// Explicit Euler lets an undamped mode of frequency w grow by the root of 1 + (h w)^2 in a step,
/// and symplectic Euler not at all up to h w = 2:
///
/// ```
/// use a3_core::integrators;
/// use a3_core::stability::{Growth, Mode};
///
/// let mode = Mode { stiffness: 4.0, ..Mode::default() };
/// let growth = |name: &str, h: f64| -> Result<f64, a3_core::Error> {
///     let method = integrators::find(name).unwrap();
///     Ok(Growth::new(method, mode)?.of_step(h))
/// };
/// assert!((growth("euler", 0.1)? - 1.04_f64.sqrt()).abs() < 1e-15);
/// assert!((growth("symplectic", 0.99)? - 1.0).abs() < 1e-12);
/// assert!(growth("symplectic", 1.01)? > 1.3);
/// # Ok::<(), a3_core::Error>(())
/// ```
pub struct Growth {
    system: Tied,
    integrator: Box<dyn Integrator>,
    /// Failure of a callback in a step, if there was one.
    failure: Option<Error>,
}

impl Growth {
    /// Creates the growth of `mode` by `method`.
    ///
    /// # Errors
    /// The method does not support damped springs, which damp the mode.
    pub fn new(method: &Method, mode: Mode) -> Result<Self, Error> {
        let system = Tied(mode);
        let integrator = method.integrator(&system)?;
        Ok(Self {
            system,
            integrator,
            failure: None,
        })
    }

    /// Checks that no callback has failed in a step.
    ///
    /// # Errors
    /// That failure.
    pub(super) fn check(&mut self) -> Result<(), Error> {
        self.failure.take().map_or(Ok(()), Err)
    }

    /// Returns the matrix of a step of h (s) on x times the frequency and on v: a, b, c, d, row by
    /// row. `None` if the step fails.
    fn matrix(&mut self, h: f64) -> Option<[f64; 4]> {
        let mut y = [0.0; 18];
        // Particle 0 starts with x = 1, particle 1 with v = `unit`: v is scaled by the frequency,
        // so that x and v have similar magnitudes.
        let unit = self.system.0.frequency().max(1e-3);
        (y[0], y[10]) = (1.0, unit);
        let stepped = self.integrator.step(&self.system, 0.0, h, &mut y);
        let stepped = succeeded(stepped).unwrap_or_else(|failure| {
            self.failure = Some(failure);
            false
        });
        let matrix = [y[0], y[1], y[9] / unit, y[10] / unit];
        (stepped && matrix.iter().all(|m| m.is_finite())).then_some(matrix)
    }

    /// Returns the spectral radius of the matrix of a step of h (s); for a Runge-Kutta method, the
    /// larger |R(h l)| of both eigenvalues l. It is infinite if the step fails.
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

    /// Returns the ratio of the largest to the smallest energy of a mode in steps of h (s), without
    /// growth and decay, and relative to that of the exact motion.
    ///
    /// Steps move (x w, v) round an ellipse, c x^2 + (d - a) x v - b v^2 = const. The result is the
    /// squared ratio of its axes over that of the exact motion, (1 + z) / (1 - z) with the damping
    /// ratio z. It is 1 for a Runge-Kutta method; for Verlet's method without damping it is
    /// 1 / (1 - (h w)^2 / 4), which is unbounded at the limit. The result is also 1 if the step
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
        let Mode { drag, damping, .. } = self.system.0;
        let ratio = 0.5 * (drag + damping) / self.system.0.frequency();
        let own = ((1.0 + ratio) / (1.0 - ratio)).max(1.0);
        ((half + root) / (half - root) / own).max(1.0)
    }
}
