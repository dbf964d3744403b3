//! The interface of the forces of a network.

use nalgebra::Vector3;

use crate::coupling::{Coupling, Diagonal, Matrix};
use crate::energy::Energy;
use crate::error::Error;
use crate::geometry::Triangles;
use crate::products::ITERATION;
use crate::spring::Spring;

/// The time, the state and the particles for which a force is evaluated.
#[derive(Clone, Copy)]
pub(crate) struct At<'a> {
    /// Time (s).
    pub t: f64,
    /// Positions (m), n x 3.
    pub x: &'a [f64],
    /// Velocities (m/s), n x 3.
    pub v: &'a [f64],
    /// Mass of each particle (kg).
    pub masses: &'a [f64],
    /// Triangles of the network.
    pub triangles: &'a Triangles,
}

/// Uniform gravity and viscous drag, which the drift of a splitting method solves exactly. Other
/// evaluations add them last, while they divide by the masses.
#[derive(Clone, Copy, Default)]
pub(crate) struct DriftForces {
    /// Acceleration (m/s2).
    pub gravity: Vector3<f64>,
    /// Coefficient of viscous drag (kg/s).
    pub drag: f64,
}

/// Cost of a force.
#[derive(Clone, Copy, Default)]
pub(crate) struct Cost {
    /// Number of couplings.
    pub couplings: f64,
    /// Price of an evaluation, in evaluations of one single spring.
    pub price: f64,
}

/// Kind of matter whose internal forces a force is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Matter {
    /// Springs of constant stiffness and damping, which a network lists one by one.
    Springs,
    /// Another elastic body, which such springs do not describe.
    Elastic,
    /// A fluid.
    Fluid,
}

/// Price of the assembly of the couplings of springs, in evaluations of these springs. It was
/// measured on cloth and on chains.
pub(crate) const ASSEMBLY: f64 = 4.0;

/// A force of a network: its values, its differential, and its properties. Matrices of positions,
/// velocities and forces are n x 3, column-major; forces are in N.
pub(crate) trait Force {
    /// Returns the name in lists of forces.
    fn name(&self) -> &'static str;

    /// Returns the name of the damping in lists of forces, if the force is elastic.
    fn damping_name(&self) -> &'static str {
        "spring damping"
    }

    /// Returns the kind of matter whose internal forces these are; `None` for external forces and
    /// for contact.
    fn matter(&self) -> Option<Matter> {
        None
    }

    /// Returns whether the force depends on time, and so does work on the network from outside.
    fn is_driven(&self) -> bool {
        false
    }

    /// Returns whether the force is that of the wind.
    fn is_wind(&self) -> bool {
        false
    }

    /// Checks that every particle index is below `particles`, their number.
    fn check(&self, _particles: usize) -> Result<(), Error> {
        Ok(())
    }

    /// Adds the forces F to f.
    fn add_forces(&self, at: &At, f: &mut [f64]);

    /// Adds dF = dF/dx dx + dF/dv dv to df.
    fn add_differential(&self, at: &At, d: [&[f64]; 2], df: &mut [f64]);

    /// Visits the pairs of particles that the force couples, always in the same order. With
    /// `clamped`, each stiffness is positive semi-definite.
    fn couplings(&self, _t: f64, _x: &[f64], _clamped: bool, _visit: &mut dyn FnMut(Coupling)) {}

    /// Returns whether [`couplings`](Self::couplings) visits all pairs. If not, implicit methods
    /// refuse the network.
    fn lists_all_couplings(&self) -> bool {
        true
    }

    /// Returns whether products with the couplings are computed together, and not one by one.
    fn multiplies_together(&self) -> bool {
        false
    }

    /// Adds the blocks on the diagonal of an implicit step's matrix that come from the couplings,
    /// if they are [multiplied together](Self::multiplies_together). Returns their number.
    fn add_diagonal(&self, _matrix: &Matrix, _diagonal: &mut Diagonal) -> usize {
        0
    }

    /// Returns the potential energy; 0 for forces without a potential.
    fn energy(&self, _at: &At) -> Energy {
        Energy::default()
    }

    /// Returns the reason why an evaluation has failed since the last call, and forgets it. That
    /// evaluation has filled f with NaN.
    fn take_failure(&self) -> Option<Error> {
        None
    }

    /// Returns whether the forces depend on velocities.
    fn reads_velocity(&self) -> bool {
        false
    }

    /// Returns the cost of the force; 0 for forces that couple no particles.
    fn cost(&self) -> Cost {
        Cost::default()
    }

    /// Returns the price of the assembly of the couplings, in evaluations of one single spring.
    fn assembly(&self) -> f64 {
        ASSEMBLY * self.cost().couplings
    }

    /// Returns the price of an iteration of conjugate gradients with the damping of the force, in
    /// evaluations of the force.
    fn iteration(&self) -> f64 {
        ITERATION
    }

    /// Returns gravity and drag, if the force consists of these.
    fn drift_forces(&self) -> Option<DriftForces> {
        None
    }

    /// Returns the view of a force that acts on each particle by itself, if it is such a one.
    fn by_particle(&self) -> Option<&dyn ByParticle> {
        None
    }

    /// Multiplies the stiffness and the damping by factors, if the force is that of matter.
    fn scale(&mut self, _stiffness: f64, _damping: f64) {}

    /// Removes the springs between the pairs of particles in `torn`, which is sorted and has the
    /// lower number of each pair first.
    fn remove_springs(&mut self, _torn: &[[usize; 2]]) {}
}

/// A force on each particle that depends on the time and on its own position alone.
pub(crate) trait ByParticle {
    /// Adds the forces at time t (s) on particles at x (m) to f, by axis.
    fn add(&self, t: f64, x: [&[f64]; 3], f: &mut [&mut [f64]; 3]);
}

/// Returns the particles at the ends of a spring, the lower number first.
pub(crate) fn ends(spring: &Spring) -> [usize; 2] {
    let Spring { i, j, .. } = *spring;
    [i.min(j), i.max(j)]
}

/// Returns the square of the distance (m2) of particles i and j at x.
pub(crate) fn distance_squared(x: &[f64], i: usize, j: usize) -> f64 {
    let n = x.len() / 3;
    let d = |axis: usize| x[axis * n + i] - x[axis * n + j];
    d(0) * d(0) + d(1) * d(1) + d(2) * d(2)
}

/// Returns the distance (m) of particles i and j at x.
pub(crate) fn distance(x: &[f64], i: usize, j: usize) -> f64 {
    distance_squared(x, i, j).sqrt()
}

/// Checks that particle i is one of `particles`.
pub(crate) fn check_particle(i: usize, particles: usize) -> Result<(), Error> {
    if i < particles {
        return Ok(());
    }
    Err(Error::Invalid(format!(
        "there is no particle {i}: they are numbered 0 to {}",
        particles - 1
    )))
}

/// Checks that i and j are two different particles of `particles`.
pub(crate) fn check_ends([i, j]: [usize; 2], particles: usize) -> Result<(), Error> {
    check_particle(i, particles)?;
    check_particle(j, particles)?;
    if i == j {
        return Err(Error::Invalid(format!(
            "a spring needs two different particles, not {i} twice"
        )));
    }
    Ok(())
}
