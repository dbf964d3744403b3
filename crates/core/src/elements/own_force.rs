//! A force that is a function, F(t, x, v).

use std::fmt;
use std::sync::Arc;

use super::force::{At, Force};
use crate::error::Error;
use crate::failure::{Failure, Outcome};

/// Function of t, x and v that adds forces.
type Function = dyn Fn(f64, &[f64], &[f64], &mut [f64]) -> Result<(), String> + Send + Sync;

/// Force of one's own on the particles of a network. Implicit methods leave its differential out of
/// their equations: they hold it constant within an iteration.
///
/// A wind that turns:
///
/// ```
/// use a3_core::Network;
/// use a3_core::elements::OwnForce;
///
/// let mut network = Network::new(vec![1.0; 4])?;
/// network.add(OwnForce::new(|t: f64, _x: &[f64], _v: &[f64], f: &mut [f64]| {
///     let (along_x, others) = f.split_at_mut(4);
///     along_x.iter_mut().for_each(|f| *f += t.cos());
///     others[4..].iter_mut().for_each(|f| *f += t.sin());
/// }))?;
/// # Ok::<(), a3_core::Error>(())
/// ```
#[derive(Clone)]
pub struct OwnForce {
    function: Arc<Function>,
    failure: Arc<Failure>,
}

impl OwnForce {
    /// Creates a force from a function of the time (s), the positions (m) and the velocities (m/s),
    /// each n x 3 in column-major order, that adds the forces (N) to its last argument, and may
    /// fail. What it adds must depend on its arguments alone.
    pub fn new<R: Outcome>(
        function: impl Fn(f64, &[f64], &[f64], &mut [f64]) -> R + Send + Sync + 'static,
    ) -> Self {
        Self {
            function: Arc::new(move |t, x, v, f| function(t, x, v, f).outcome()),
            failure: Arc::default(),
        }
    }
}

impl fmt::Debug for OwnForce {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("OwnForce")
    }
}

impl Force for OwnForce {
    fn name(&self) -> &'static str {
        "own force"
    }

    fn is_driven(&self) -> bool {
        true
    }

    fn add_forces(&self, at: &At, f: &mut [f64]) {
        let add = |f: &mut [f64]| (self.function)(at.t, at.x, at.v, f);
        self.failure.guard(f, add);
    }

    fn add_differential(&self, _: &At, _: [&[f64]; 2], _: &mut [f64]) {}

    fn reads_velocity(&self) -> bool {
        true
    }

    fn take_failure(&self) -> Option<Error> {
        self.failure.take()
    }
}
