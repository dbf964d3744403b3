//! Particle in the hand: pinned to a path, or attracted to it by a spring.

use serde::{Deserialize, Serialize};

use super::pins::pin;
use crate::network::{Network, attract, mass_behind};
use crate::path::Path;
use crate::pin::Pin;

/// Time in which a pulled particle reaches its target (s).
pub(super) const PULL_TIME: f64 = 1.0 / 30.0;

/// Natural frequency of the spring that attracts a particle, over that of the particle on its own
/// springs: with the inertia of the hand, enough to pull a cloth along, and too little to change
/// the largest stable step.
const PULL_FREQUENCY_SHARE: f64 = 0.1;

/// Inertia that the hand adds to a particle that nothing else holds, in masses of the particle: it
/// makes the spring of the hand stiff at a low frequency. On a soft spring, the particle would give
/// way to every swing of the cloth, and the hand, which moves on by the distance from the target,
/// would drive that swing with its delay.
const HAND_INERTIA: f64 = 60.0;

/// A particle in the hand.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Grabbed {
    /// Number of the particle.
    pub particle: usize,
    /// Whether the particle was pinned before, and is again when the hand lets go.
    pub was_pinned: bool,
    /// Path of the hand.
    pub path: Path,
}

impl Grabbed {
    /// Returns whether a spring attracts the particle. A pin would tear constraints on the
    /// particle, would not stop where surfaces in contact leave it no room, and cannot move one
    /// point of a rigid body alone.
    pub(super) fn is_attracted(&self, network: &Network) -> bool {
        let touches = network.contact_layer().is_some();
        touches
            || network.is_carried(self.particle)
            || !self.was_pinned && network.is_held(self.particle)
    }

    /// Attracts the particle to the path, if it is not pinned to it.
    pub(super) fn attract(&self, network: &mut Network) {
        if self.is_attracted(network) {
            let own = network.springs_of(self.particle);
            let stiffness: f64 = own.map(|s| s.law.stiffness).sum();
            let own = (stiffness / mass_behind(network, self.particle)).sqrt();
            let free = !network.is_held(self.particle) && !network.is_carried(self.particle);
            let least = 1.0 / PULL_TIME;
            let strength = if free {
                (least.max(PULL_FREQUENCY_SHARE * own), HAND_INERTIA)
            } else {
                (least, 0.0)
            };
            attract(network, self.particle, self.path, strength);
        }
    }

    /// Moves the particle, whose velocity is in y, along the path from time t (s) on.
    pub(super) fn lead(&self, network: &mut Network, y: &mut [f64], t: f64) {
        if self.is_attracted(network) {
            network.unpin(self.particle);
            self.attract(network);
        } else {
            pin(network, y, Pin::new(self.particle, self.path), t);
        }
    }
}
