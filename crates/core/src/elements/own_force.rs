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

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::control::Control;
    use crate::integrators::find;
    use crate::network::Network;
    use crate::path::Path;
    use crate::scene::{Model, Scene};
    use crate::simulation::Simulation;
    use crate::spring::{Spring, SpringKind, SpringLaw};

    /// Creates a run of two masses on a spring, one of them pinned.
    fn pendulum(method: &str, change: impl FnOnce(&mut Network)) -> Simulation {
        let mut network = Network::new(vec![2.0; 2]).unwrap();
        let law = SpringLaw::new(50.0, 1.0, 0.0).unwrap();
        let spring = Spring { kind: SpringKind::Structural, i: 0, j: 1, law };
        network.add_spring(spring).unwrap();
        network.pin(0, Path::Still(Vector3::zeros())).unwrap();
        change(&mut network);
        let mut state = vec![0.0; 12];
        state[1] = 1.0;
        let scene = Scene::new("pendulum", Model::Network(Box::new(network)), state);
        Simulation::new(scene, find(method).unwrap(), Control::Step(0.01)).unwrap()
    }

    #[test]
    fn an_own_force_acts_as_the_same_force_of_the_network() {
        for method in ["rk4", "verlet", "symplectic", "implicit-midpoint"] {
            let weight = |_t: f64, _x: &[f64], _v: &[f64], f: &mut [f64]| {
                f[2..4].iter_mut().for_each(|f| *f -= 2.0 * 9.81);
            };
            let mut own = pendulum(method, |network| {
                network.add(OwnForce::new(weight)).unwrap();
            });
            let mut usual = pendulum(method, |network| {
                network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
            });
            own.advance_to(1.0).unwrap();
            usual.advance_to(1.0).unwrap();
            // Verlet solves gravity exactly, and kicks with other forces.
            let apart = (own.position(1) - usual.position(1)).norm();
            assert!(usual.position(1).y < -0.5 && apart < 1e-3, "{method}: {apart}");
        }
    }

    #[test]
    fn a_force_that_fails_ends_the_run_with_its_words() {
        for method in ["rk4", "verlet", "implicit"] {
            let force = |t: f64, _: &[f64], _: &[f64], _: &mut [f64]| {
                if t < 0.5 { Ok(()) } else { Err("no more") }
            };
            let mut run = pendulum(method, |network| {
                network.add(OwnForce::new(force)).unwrap();
            });
            let failed = run.advance_to(1.0);
            assert_eq!(failed, Err(Error::Callback("no more".into())), "{method}");
            assert!(run.time() <= 0.5 && run.state().iter().all(|y| y.is_finite()));
        }
    }
}
