//! The questions that every element of a network answers.

use std::any::Any;

use nalgebra::Vector3;

use super::wind::Wind;
use crate::coupling::{Coupling, Diagonal, Matrix};
use crate::energy::Energy;
use crate::error::Error;
use crate::spring::Spring;

/// The time, the state and the particles for which an element is evaluated.
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
    pub triangles: &'a [[u32; 3]],
}

/// Uniform gravity and viscous drag, which the drift of a splitting method solves exactly, and
/// which other evaluations add last, while they divide by the masses.
#[derive(Clone, Copy, Default)]
pub(crate) struct DriftForces {
    /// Acceleration (m/s2).
    pub gravity: Vector3<f64>,
    /// Coefficient of viscous drag (kg/s).
    pub drag: f64,
}

/// Number of couplings of an element, and the price of its forces in evaluations of as many single
/// springs.
#[derive(Clone, Copy, Default)]
pub(crate) struct Cost {
    pub couplings: f64,
    pub price: f64,
}

/// Kind of matter that a force holds together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Matter {
    /// Springs, each of one stiffness and one damping, which a network lists one by one.
    Springs,
    /// An elastic body that such springs do not describe.
    Elastic,
    /// A fluid.
    Fluid,
}

/// Price of the assembly of couplings of springs, in evaluations of them. It was measured on cloth
/// and on chains.
pub(crate) const ASSEMBLY: f64 = 4.0;

/// A force of a network. Matrices of positions, velocities and forces are n x 3, column-major;
/// forces are in N.
pub(crate) trait Force: Any {
    /// Name in lists of forces.
    fn name(&self) -> &'static str;

    /// Name of the damping in lists of forces, if the force is elastic.
    fn damping_name(&self) -> &'static str {
        "spring damping"
    }

    /// Kind of matter that the force holds together; none for external forces and for contact.
    fn matter(&self) -> Option<Matter> {
        None
    }

    /// Whether the force depends on time, and so does work on the network from outside.
    fn is_driven(&self) -> bool {
        false
    }

    /// The wind that the force comes from, if it is that of a wind.
    fn wind(&self) -> Option<&Wind> {
        None
    }

    /// Checks that every particle index is below the number of `particles`.
    fn check(&self, _particles: usize) -> Result<(), Error> {
        Ok(())
    }

    /// Adds the forces to f.
    fn add_forces(&self, at: &At, f: &mut [f64]);

    /// Adds dF = dF/dx dx + dF/dv dv to df.
    fn add_differential(&self, at: &At, d: [&[f64]; 2], df: &mut [f64]);

    /// Visits the pairs of particles that the element couples, always in the same order. With
    /// `clamped`, each stiffness is positive semi-definite.
    fn couplings(&self, _t: f64, _x: &[f64], _clamped: bool, _visit: &mut dyn FnMut(Coupling)) {}

    /// Whether [`couplings`](Self::couplings) visits all pairs. If not, implicit methods refuse the
    /// network.
    fn lists_all_couplings(&self) -> bool {
        true
    }

    /// Whether the couplings are multiplied together, and not one by one.
    fn multiplies_together(&self) -> bool {
        false
    }

    /// Adds the blocks on the diagonal of an implicit step's matrix that come from the couplings,
    /// if they are [multiplied together](Self::multiplies_together). Returns their number.
    fn add_diagonal(&self, _matrix: &Matrix, _diagonal: &mut Diagonal) -> usize {
        0
    }

    /// Potential energy; none for forces without a potential.
    fn energy(&self, _at: &At) -> Energy {
        Energy::default()
    }

    /// Whether the forces depend on velocities.
    fn reads_velocity(&self) -> bool {
        false
    }

    /// Cost of the couplings; none for elements that couple nothing.
    fn cost(&self) -> Cost {
        Cost::default()
    }

    /// Price of the assembly of couplings, in evaluations of as many single springs.
    fn assembly(&self) -> f64 {
        ASSEMBLY * self.cost().couplings
    }

    /// The force as gravity and drag, if it is nothing else.
    fn drift_forces(&self) -> Option<DriftForces> {
        None
    }

    /// The force as one on each particle by itself, if it is that.
    fn by_particle(&self) -> Option<&dyn ByParticle> {
        None
    }

    /// Multiplies stiffness and damping of springs.
    fn scale(&mut self, _stiffness: f64, _damping: f64) {}

    /// Removes the springs between the pairs of particles in `torn`, each with the lower number
    /// first, in order.
    fn remove_springs(&mut self, _torn: &[[usize; 2]]) {}
}

/// A force on each particle that depends on the time and on its own position alone.
pub(crate) trait ByParticle {
    /// Adds the forces on some particles.
    fn add(&self, t: f64, x: [&[f64]; 3], f: &mut [&mut [f64]; 3]);
}

/// The particles at the ends of a spring, the lower number first.
pub(crate) fn ends(spring: &Spring) -> [usize; 2] {
    let Spring { i, j, .. } = *spring;
    [i.min(j), i.max(j)]
}

/// The square of the distance (m2) of particles i and j at x.
pub(crate) fn distance_squared(x: &[f64], i: usize, j: usize) -> f64 {
    let n = x.len() / 3;
    let d = |axis: usize| x[axis * n + i] - x[axis * n + j];
    d(0) * d(0) + d(1) * d(1) + d(2) * d(2)
}

/// The distance (m) of particles i and j at x.
pub(crate) fn distance(x: &[f64], i: usize, j: usize) -> f64 {
    distance_squared(x, i, j).sqrt()
}

/// `Ok` if particle i exists among so many.
pub(crate) fn check_particle(i: usize, particles: usize) -> Result<(), Error> {
    if i < particles {
        return Ok(());
    }
    Err(Error::Invalid(format!(
        "there is no particle {i}: they are numbered 0 to {}",
        particles - 1
    )))
}

/// `Ok` if i and j are two particles among so many.
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
