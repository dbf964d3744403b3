//! The pull of a hand on a particle that constraints hold.

use super::parts::Network;
use crate::elements::Attraction;
use crate::path::Path;

/// Attracts a particle that constraints hold to a path, by a spring of a natural frequency (1/s). A
/// pin would violate the constraints.
pub(crate) fn attract(network: &mut Network, particle: usize, path: Path, frequency: f64) {
    let attraction = Attraction {
        particle,
        mass: mass_behind(network, particle),
        path,
        frequency,
    };
    network.elements.replace_all(Some(attraction));
}

/// Ends the attraction.
pub(crate) fn let_go(network: &mut Network) {
    network.elements.replace_all::<Attraction>(None);
}

/// Returns the mass (kg) that moves with particle i: its own, or that of the body that carries it.
pub(crate) fn mass_behind(network: &Network, i: usize) -> f64 {
    let carrier = network.bodies.carrier(&network.particles, i);
    network.particles.masses()[carrier.map_or(i, |(center, _)| center)]
}
