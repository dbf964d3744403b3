//! The pull of a hand on a particle.

use super::parts::Network;
use crate::elements::Attraction;
use crate::path::Path;

/// Attracts a particle to a path, by a spring of a natural frequency (1/s). The hand adds an
/// inertia to the particle, in masses of the particle.
pub(crate) fn attract(
    network: &mut Network,
    particle: usize,
    path: Path,
    (frequency, inertia): (f64, f64),
) {
    let mass = mass_behind(network, particle);
    network.particles.unburden();
    if inertia > 0.0 {
        network.particles.burden(particle, inertia * mass);
    }
    let attraction = Attraction { particle, mass: (1.0 + inertia) * mass, path, frequency };
    network.elements.replace_all(Some(attraction));
}

/// Ends the attraction.
pub(crate) fn let_go(network: &mut Network) {
    network.particles.unburden();
    network.elements.replace_all::<Attraction>(None);
}

/// Returns the mass (kg) that moves with particle i: its own, or that of the body that carries it.
pub(crate) fn mass_behind(network: &Network, i: usize) -> f64 {
    let carrier = network.bodies.carrier(&network.particles, i);
    network.particles.masses()[carrier.map_or(i, |(center, _)| center)]
}
