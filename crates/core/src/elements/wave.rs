//! Plane waves: gusts of wind are sums of them.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::fused::mul_add;

/// Plane wave of a wind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Wave {
    /// Amplitude (N, or m/s).
    #[serde(with = "crate::serial")]
    pub amplitude: Vector3<f64>,
    /// Wave number (rad/m).
    #[serde(with = "crate::serial")]
    pub number: Vector3<f64>,
    /// Angular frequency (rad/s).
    pub rate: f64,
    /// Phase (rad).
    pub phase: f64,
}

impl Wave {
    /// Returns the argument (rad) of its sine at a time (s) and a place (m).
    #[inline(always)]
    pub fn argument(&self, t: f64, [x, y, z]: [f64; 3]) -> f64 {
        let q = self.number;
        let begun = mul_add(-self.rate, t, self.phase);
        mul_add(q.x, x, mul_add(q.y, y, mul_add(q.z, z, begun)))
    }
}
