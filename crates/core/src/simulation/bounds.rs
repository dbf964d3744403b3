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
    /// Returns whether all particles of y are close enough to the middle for a state to go back to
    /// after a blow-up.
    pub fn hold_closely(&self, model: &Model, y: &[f64]) -> bool {
        self.beyond(MAX_GOOD_DISTANCE, model, y).is_none()
    }

    /// Returns the cause of a blow-up, if a particle of y is too far away or not finite.
    pub fn violation(&self, model: &Model, y: &[f64]) -> Option<Cause> {
        self.beyond(MAX_DISTANCE, model, y)
    }

    /// Returns a constraint that contradicts others or pins, if there is one, in the state y at
    /// time t (s).
    pub fn contradiction(&self, model: &Model, y: &[f64], t: f64) -> Option<Unmet> {
        let network = model.network()?;
        contradiction(network, t, y, self.radius)
    }

    /// Finds the first particle that is farther than this many radii from the middle, or the first
    /// number that is not finite, if there is one. Numbers of a first-order system may grow far.
    fn beyond(&self, radii: f64, model: &Model, y: &[f64]) -> Option<Cause> {
        let n = match model {
            Model::FirstOrder(_) => 0,
            Model::Points(_) | Model::Network(_) => model.particles(),
        };
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
        let first = v.iter().position(|v| !v.is_finite());
        first.map(|k| not_finite(model, 3 * n + k))
    }
}

/// Returns the cause of a blow-up where number k of a state is not finite. It names the particle
/// that the number belongs to, which is the centre for the rotation of a rigid body.
pub(super) fn not_finite(model: &Model, k: usize) -> Cause {
    let n = model.particles();
    if n == 0 {
        return Cause::NumberNotFinite { index: k };
    }
    let body = k.checked_sub(6 * n).map(|k| k / ROTATION);
    let network = model.network();
    let body = body.and_then(|body| network?.bodies().get(body));
    Cause::NotFinite {
        particle: body.map_or(k % n, Body::center),
    }
}
