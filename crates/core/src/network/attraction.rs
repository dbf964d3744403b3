//! The hand that attracts a particle which constraints hold.

use super::parts::Network;
use crate::elements::{Attraction, Element};
use crate::path::Path;

/// Attracts a particle that constraints hold to a path, by a spring of that natural frequency
/// (1/s): a pin would tear the constraints.
pub(crate) fn attract(network: &mut Network, particle: usize, path: Path, frequency: f64) {
    let_go(network);
    let attraction = Attraction {
        particle,
        mass: mass_behind(network, particle),
        path,
        frequency,
    };
    network.elements.insert(attraction.into());
}

/// Ends the attraction.
pub(crate) fn let_go(network: &mut Network) {
    let is = |element: &Element| matches!(element, Element::Attraction(_));
    network.elements.replace(is, None);
}

/// Mass (kg) that moves with particle i: its own, or that of the body that carries it.
pub(crate) fn mass_behind(network: &Network, i: usize) -> f64 {
    let carrier = network.bodies.carrier(&network.particles, i);
    network.particles.masses()[carrier.map_or(i, |(center, _)| center)]
}
