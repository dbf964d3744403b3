//! A network of particles as its parts.

use super::bodies::Bodies;
use super::elements::Elements;
use super::particles::Particles;
use super::surfaces::Surfaces;
use super::tearing::{StrainLimits, Tears};
use crate::constraints::Constraints;

/// Particles, and the elements and constraints that act on them. Elements that a scene does not use
/// cost nothing.
///
/// A particle of 2 kg hangs from a pin by a spring of 100 N/m, which its weight makes 0.1962 m
/// longer than its rest length of 1 m:
///
/// ```
/// use a3_core::{Mechanics, Network, Path, Spring, SpringKind, SpringLaw, Vector3};
///
/// let mut network = Network::new(vec![2.0; 2])?;
/// let law = SpringLaw::new(100.0, 1.0, 0.0)?;
/// network.add_spring(Spring { kind: SpringKind::Structural, i: 0, j: 1, law })?;
/// network.pin(0, Path::Still(Vector3::zeros()))?;
/// network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
///
/// // All x, all y and all z (m).
/// let positions = [0.0, 0.0, 0.0, -1.1962, 0.0, 0.0];
/// let mut accelerations = [0.0; 6];
/// network.accelerations(0.0, &positions, &[0.0; 6], &mut accelerations);
/// assert!(accelerations.iter().all(|a| a.abs() < 1e-12));
/// # Ok::<(), a3_core::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Network {
    pub(super) particles: Particles,
    pub(super) elements: Elements,
    pub(super) constraints: Constraints,
    pub(super) bodies: Bodies,
    pub(super) surfaces: Surfaces,
    pub(super) tears: Tears,
    pub(super) strain_limits: StrainLimits,
}
