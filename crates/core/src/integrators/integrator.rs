//! Interface of a method that steps a system.

use crate::error::Error;
use crate::system::ParticleSystem;
use crate::work::Work;

/// Integrator of a system: a method with its scratch.
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
    if y.len() == expected {
        Ok(())
    } else {
        Err(Error::Dimension {
            expected,
            found: y.len(),
        })
    }
}
