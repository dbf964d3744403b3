//! Particle in the hand: led as a pin, or attracted by a spring.

use serde::{Deserialize, Serialize};

use super::pins::pin;
use crate::network::{Network, attract, mass_behind};
use crate::path::Path;

/// Time in which a pulled particle gets to where it is pulled (s).
pub(super) const PULL_TIME: f64 = 1.0 / 30.0;

/// Natural frequency of the spring that attracts a particle over that of the particle on its own
/// springs: it pulls a cloth along, and hardly shortens the largest stable step.
const PULL_STIFFNESS: f64 = 0.3;

/// A particle in the hand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Grabbed {
    /// Number of the particle.
    pub particle: usize,
    /// Whether the particle was pinned before, and is again when the hand lets go.
    pub was_pinned: bool,
    /// Path along which the hand leads it.
    pub path: Path,
}

impl Grabbed {
    /// Whether a spring attracts the particle: a pin would tear constraints that hold it too, and
    /// would not stop where surfaces that touch leave it no room; and a point of a rigid body
    /// cannot be led by itself.
    pub(super) fn is_attracted(&self, network: &Network) -> bool {
        let touches = network.contact_layer().is_some();
        touches
            || network.is_carried(self.particle)
            || !self.was_pinned && network.is_held(self.particle)
    }

    /// Attracts the particle to its path, if it is not led as a pin.
    pub(super) fn attract(&self, network: &mut Network) {
        if self.is_attracted(network) {
            let own = network.springs_of(self.particle);
            let stiffness: f64 = own.map(|s| s.law.stiffness).sum();
            let own = (stiffness / mass_behind(network, self.particle)).sqrt();
            let free = !network.is_held(self.particle);
            let least = 1.0 / PULL_TIME;
            let frequency = if free {
                least.max(PULL_STIFFNESS * own)
            } else {
                least
            };
            attract(network, self.particle, self.path, frequency);
        }
    }

    /// Leads the particle, whose velocity is in y, along its path from time t (s) on.
    pub(super) fn lead(&self, network: &mut Network, y: &mut [f64], t: f64) {
        if self.is_attracted(network) {
            network.unpin(self.particle);
            self.attract(network);
        } else {
            pin(network, y, (self.particle, self.path), t);
        }
    }
}
