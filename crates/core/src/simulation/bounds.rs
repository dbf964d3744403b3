//! Bounds of a scene, and whether a state is within them.

use std::ops::Range;

use nalgebra::Vector3;

use crate::error::{Cause, Unmet};
use crate::network::contradiction;
use crate::rigid::{Body, ROTATION};
use crate::scene::Model;

/// Distance from the scene's middle, in its radii, beyond which a particle that has gained energy
/// ends the run.
const MAX_DISTANCE: f64 = 100.0;

/// Largest distance of particles from the middle, in radii, in a state that a run goes back to
/// after a blow-up: it still shows the whole scene.
const MAX_GOOD_DISTANCE: f64 = 3.0;

/// Number of particles that are checked together, without a branch.
const BLOCK_LENGTH: usize = 64;

/// Bounds of a scene as it begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub middle: Vector3<f64>,
    /// Distance of the farthest particle from the middle (m).
    pub radius: f64,
}

impl Bounds {
    /// Whether all particles of y are close enough to the middle for a state to go back to after a
    /// blow-up.
    pub fn hold_closely(&self, model: &Model, y: &[f64]) -> bool {
        self.beyond(MAX_GOOD_DISTANCE, model, y).is_none()
    }

    /// The cause of a blow-up, if a particle of y is too far away or not finite.
    pub fn violation(&self, model: &Model, y: &[f64]) -> Option<Cause> {
        self.beyond(MAX_DISTANCE, model, y)
    }

    /// A constraint that contradicts others or pins, if there is one, in the state y at time
    /// t (s).
    pub fn contradiction(&self, model: &Model, y: &[f64], t: f64) -> Option<Unmet> {
        let network = model.network()?;
        contradiction(network, t, network.halves(y).0, self.radius)
    }

    /// The first particle that is farther than this many radii from the middle, or not finite, if
    /// there is one.
    fn beyond(&self, radii: f64, model: &Model, y: &[f64]) -> Option<Cause> {
        let n = model.particles();
        let (x, v) = y.split_at(3 * n);
        let c = self.middle;
        let limit = (radii * self.radius).powi(2);
        let squared = |i: usize| {
            (x[i] - c.x).powi(2) + (x[n + i] - c.y).powi(2) + (x[2 * n + i] - c.z).powi(2)
        };
        // In blocks without a branch inside. The comparison is written so that NaN fails it too.
        let near = |block: Range<usize>| block.fold(true, |near, i| near & (squared(i) <= limit));
        let mut blocks = (0..n).step_by(BLOCK_LENGTH);
        if !blocks.all(|start| near(start..n.min(start + BLOCK_LENGTH))) {
            let particle = (0..n).find(|&i| !near(i..i + 1))?;
            let distance = squared(particle).sqrt();
            return Some(if distance.is_finite() {
                Cause::Away { particle, distance }
            } else {
                Cause::NotFinite { particle }
            });
        }
        let finite = |block: &[f64]| block.iter().fold(true, |finite, v| finite & v.is_finite());
        if v.chunks(BLOCK_LENGTH).all(finite) {
            return None;
        }
        v.iter()
            .position(|v| !v.is_finite())
            .map(|k| Cause::NotFinite {
                particle: particle_of(model, 3 * n + k),
            })
    }
}

/// Particle to which number k of a state belongs: for the rotation of a rigid body, its centre.
fn particle_of(model: &Model, k: usize) -> usize {
    let n = model.particles();
    let body = k.checked_sub(6 * n).map(|k| k / ROTATION);
    let network = model.network();
    let body = body.and_then(|body| network?.bodies().get(body));
    body.map_or(k % n, Body::center)
}
