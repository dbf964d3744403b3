//! Pins of a run, which stand still or swing where a hand leaves them, and the particle in the
//! hand: pinned to a path, or attracted to it by a spring.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::columns::row;
use crate::network::{Network, attract, forget_released, mass_behind, release_of};
use crate::path::Path;
use crate::pin::Pin;
use crate::scene::{Scene, Swing};
use crate::system::ParticleSystem;

/// Distance of a pin from its path, over the radius of the scene, below which it is a rounding
/// error.
const ROUNDING: f64 = 1e-9;

/// Returns the path of a pin that is left at `position` (m) at time t (s): it stays there, or
/// swings from there.
pub(super) fn leave(position: Vector3<f64>, swing: Option<Swing>, phase: f64, t: f64) -> Path {
    match swing {
        None => Path::Still(position),
        Some(Swing { amplitude, rate }) => {
            let center = position - amplitude * libm::sin(rate * t + phase);
            Path::Sine { center, amplitude, rate, phase }
        }
    }
}

/// Returns the time (s) after t at which a scene lets go of particle i, if it does.
pub(super) fn own_release(scene: &Scene, i: usize, t: f64) -> Option<f64> {
    let until = release_of(scene.model.network()?, i);
    until.filter(|until| *until > t)
}

/// Adds a pin, and writes the velocity of its path at time t (s) to y.
pub(super) fn pin(network: &mut Network, y: &mut [f64], pin: Pin, t: f64) {
    let (n, i, velocity) = (network.particles(), pin.particle, pin.at(t).velocity);
    let pinned = match pin.until {
        None => network.pin(i, pin.path),
        Some(_) => network.pin_all(vec![pin]),
    };
    if pinned.is_ok() {
        for axis in 0..3 {
            y[(3 + axis) * n + i] = velocity[axis];
        }
    }
}

/// Leaves all pins except one where they are at time t (s), and writes their positions to y. Liquid
/// that flows in goes on doing so.
pub(super) fn leave_all_but(
    held: Option<usize>,
    network: &mut Network,
    y: &mut [f64],
    (swing, phase): (Option<Swing>, f64),
    t: f64,
) {
    let fluid = network.fluid();
    let is_of_fluid = |i: usize| fluid.is_some_and(|fluid| fluid.members().contains(i));
    let flows = |(i, path): &(usize, Path)| matches!(path, Path::Line { .. }) && is_of_fluid(*i);
    let flowing: Vec<usize> = network.pins().filter(flows).map(|(i, _)| i).collect();
    network.lead_pins(|i, path| {
        if Some(i) == held || flowing.binary_search(&i).is_ok() {
            path
        } else {
            leave(path.at(t).position, swing, phase, t)
        }
    });
    network.hold(t, y);
}

/// Frees all pinned particles except one, for good.
pub(super) fn unpin_all_but(held: Option<usize>, network: &mut Network) {
    forget_released(network);
    let pins: Vec<_> = network.pins().map(|(i, _)| i).collect();
    // The last ones first, so that few of the list are moved up by each removal.
    for i in pins.into_iter().rev().filter(|i| Some(*i) != held) {
        network.unpin(i);
    }
}

/// Lists the pinned particles that are not on their paths in y at time t (s), in a scene of that
/// radius (m).
pub(super) fn strayed(network: &Network, y: &[f64], t: f64, radius: f64) -> Vec<usize> {
    let (n, far) = (network.particles(), ROUNDING * radius);
    let pins = network.pins();
    pins.filter(|(i, path)| (path.at(t).position - row(y, n, *i)).norm() > far)
        .map(|(i, _)| i)
        .collect()
}

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
