//! Interface of a method that steps a system.

use crate::error::Error;
use crate::system::ParticleSystem;
use crate::work::Work;

/// Integrator of a system: a method with its scratch.
///
/// A step of the classical Runge-Kutta method multiplies a decay y' = -y by the first terms of
/// exp(-h), in four evaluations:
///
/// ```
/// # use a3_core::{ParticleSystem, integrators};
/// # struct Decay;
/// # impl ParticleSystem for Decay {
/// #     fn dim(&self) -> usize { 1 }
/// #     fn eval_f(&self, _t: f64, y: &[f64], dydt: &mut [f64]) { dydt[0] = -y[0]; }
/// # }
/// let mut rk4 = integrators::find("rk4").unwrap().integrator(&Decay)?;
/// let (h, mut y) = (0.5_f64, [1.0]);
/// let work = rk4.step(&Decay, 0.0, h, &mut y)?;
/// let exact = 1.0 - h + h.powi(2) / 2.0 - h.powi(3) / 6.0 + h.powi(4) / 24.0;
/// assert!((y[0] - exact).abs() < 1e-15);
/// assert_eq!(work.total(), 4.0);
/// # Ok::<(), a3_core::Error>(())
/// ```
pub trait Integrator: Send {
    /// Advances the state y from t to t + h (s), and returns the work. The result depends on the
    /// arguments alone. Allocates nothing.
    ///
    /// # Errors
    /// The length of the state is not that of the system, the system lacks the forces and masses
    /// that the method needs, or the equations of an implicit method were not solved.
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error>;
}

/// Checks that `y` has the length `expected`.
pub(super) fn check_dim(expected: usize, y: &[f64]) -> Result<(), Error> {
    if y.len() == expected { Ok(()) } else { Err(Error::Dimension { expected, found: y.len() }) }
}
