//! Free rotation: that of a body without torque, by rotations about its principal axes.
//!
//! The energy of the rotation is the sum of three parts, one for each principal axis. The motion by
//! one part alone is a rotation about that axis at a constant rate, which is computed exactly.
//! Rotations by half a step about the first two axes, by a whole step about the third, and again by
//! half steps in reverse order are symplectic and reversible, conserve the angular momentum
//! exactly, and are of order 2 (Dullweber, Leimkuhler, `McLachlan`, *Symplectic splitting methods
//! for rigid body molecular dynamics*, 1997). Nine of these compositions with the shares [`SHARES`]
//! are of order 6. A body with equal moments rotates about one axis, exactly.

use nalgebra::{Quaternion, Vector3};

use super::body::Body;
use super::rotation::{Rotation, turn};

/// Shares of a step in a symmetric composition of order 6 (Kahan, Li, *Composition constants for
/// raising the orders of unconventional schemes for ordinary differential equations*, 1997): the
/// first five of nine.
const SHARES: [f64; 5] = [
    0.392_161_444_007_314_1,
    0.332_599_136_789_359_4,
    -0.706_246_172_557_639_4,
    0.082_213_596_293_550_8,
    0.798_543_990_934_829_9,
];

impl Body {
    /// Rotates freely for h (s), while the angular momentum decays at a rate (1/s).
    pub(crate) fn fly(&self, rotation: &mut Rotation, decay: f64, h: f64) {
        // The rate of rotation is proportional to the decaying momentum, as if time slowed down.
        let (left, span) = if decay > 0.0 {
            (libm::exp(-decay * h), -libm::expm1(-decay * h) / decay)
        } else {
            (1.0, h)
        };
        if rotation.momentum != Vector3::zeros() {
            let i = &self.inertia();
            if i.x == i.y && i.y == i.z {
                rotation.q = turn(rotation.momentum * (span / i.x)) * rotation.q;
            } else {
                for share in SHARES.iter().chain(SHARES[..4].iter().rev()) {
                    self.turns(rotation, share * span);
                }
            }
        }
        rotation.momentum *= left;
    }

    /// Turns a body by h (s): five rotations about its axes, which together are of order 2.
    fn turns(&self, rotation: &mut Rotation, h: f64) {
        for (axis, share) in [(0, 0.5), (1, 0.5), (2, 1.0), (1, 0.5), (0, 0.5)] {
            let own = rotation.matrix().tr_mul(&rotation.momentum);
            let mut about = Vector3::zeros();
            about[axis] = share * h * own[axis] / self.inertia()[axis];
            let by: Quaternion<f64> = turn(about);
            rotation.q *= by;
        }
    }
}
