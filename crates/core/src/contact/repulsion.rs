//! Repulsion of two primitives that are nearer than their thickness d, by a potential U of their
//! gap g. With the share s = (d - g) / d, the force is
//!
//! ```text
//! F = -U'(g) = k d s3,  from g = 0 on with the slope that it has there,
//! ```
//!
//! times 1 - r / sqrt(1 + r2) for damping, where r is the rate g' of the gap times the damping
//! coefficient: a smooth factor between 0 and 2. With a coefficient e of restitution, the factor is
//!
//! ```text
//! 1 - q g' / sqrt(g'2 + w2 / 100),    with q = (1 - e2) / (1 + e2) and w2 = 2 U / m,
//! ```
//!
//! 1 + q for an approach and 1 - q for a separation, whose ratio is e2: a particle that enters with
//! the speed u leaves with e u, however deep it gets, even if an impact with restitution e turns it
//! back. A particle that the force cannot stop does not feel it, in either direction. F, F' and F''
//! are zero where the force begins, so that methods of order four keep their order. Rigid pairs
//! without restitution that are much too fast for the force hardly feel it: two hard sides have had
//! their [impact](super::strike) where the force begins.
//!
//! Closest points of parallel edges jump. Therefore the potential of two edges is multiplied by a
//! function of their angle that is 1 except near parallel edges, and 0 for parallel ones (Li et
//! al., *Incremental Potential Contact*, 2020, 5.4). Contact between parallel edges is also contact
//! between vertices and triangles.

use nalgebra::Vector3;

use super::skin::{Law, Skin, TURNING_LOSS};
use crate::geometry::{PairKind, closest, weighted};

/// Squared sine of the angle from which on two edges, four thicknesses long, repel each other
/// fully.
const FULL_CROSSING: f64 = 0.05;

/// Speed of a pair of a rigid and a soft side without restitution, over the speed that the
/// repulsion stops, at which the repulsion is halved: much faster pairs are left to impulses, which
/// are exact. Dull pairs have had their impact before they feel it.
const HALF_SPEED_RATIO: f64 = 8.0;

/// Step of the difference quotient of a force, as a share of the thickness.
const DIFFERENCE_STEP: f64 = 1e-5;

/// Pair with the positions and velocities of its points.
#[derive(Clone, Copy)]
pub(super) struct Pair {
    pub kind: PairKind,
    pub law: Law,
    /// Positions (m).
    pub x: [Vector3<f64>; 4],
    /// Velocities (m/s).
    pub v: [Vector3<f64>; 4],
}

/// State of a pair within its thickness.
struct TouchState {
    weights: [f64; 4],
    /// Unit vector from the second primitive to the first.
    normal: Vector3<f64>,
    /// Penetration, as a share s of the thickness.
    share: f64,
}

/// Stiffness of a pair, to first order, along the normal.
#[expect(clippy::struct_field_names, reason = "the field's terms")]
pub(crate) struct Stiffness {
    pub weights: [f64; 4],
    pub normal: Vector3<f64>,
    /// dF/dg (N/m), without the sign.
    pub stiffness: f64,
    /// dF/dg' (N s/m), without the sign.
    pub damping: f64,
}

impl Pair {
    fn within(&self) -> Option<TouchState> {
        let thickness = self.law.skin.thickness;
        let closest = closest(self.kind, &self.x);
        let (distance, normal) = closest.apart(self.kind)?;
        let share = (thickness - (distance - self.law.radius)) / thickness;
        (share > 0.0).then_some(TouchState { weights: closest.weights, normal, share })
    }

    /// Returns the force F (N) and its derivative -dF/dg (N/m) at a penetration, as a share of the
    /// thickness.
    fn law_at(&self, share: f64) -> (f64, f64) {
        let (k, d) = (self.law.skin.stiffness, self.law.skin.thickness);
        if share < 1.0 {
            (k * d * share * share * share, 3.0 * k * share * share)
        } else {
            (k * d * (3.0 * share - 2.0), 3.0 * k)
        }
    }

    /// Returns the potential U (J) at a penetration, as a share of the thickness.
    fn potential(&self, share: f64) -> f64 {
        let (k, d) = (self.law.skin.stiffness, self.law.skin.thickness);
        let past = share - 1.0;
        k * d * d * if past < 0.0 { 0.25 * share.powi(4) } else { 0.25 + past + 1.5 * past * past }
    }

    /// Returns the damping factor of the force at a penetration and a rate of the gap (m/s), and
    /// the derivative of the factor with respect to the rate.
    fn damping(&self, share: f64, rate: f64) -> (f64, f64) {
        let (Skin { damping: c, .. }, r) = (self.law.skin, self.law.skin.damping * rate);
        let (lost, size) = self.loss(share);
        let root = (size + r * r).sqrt();
        let (factor, slope) = (1.0 - lost * r / root, -lost * c * size / (root * root * root));
        let (felt, fades) = self.felt(rate);
        (factor * felt, slope * felt + factor * fades)
    }

    /// Returns the share of the force that a rigid or elastic pair feels at a rate of the gap
    /// (m/s), and its derivative with respect to the rate.
    fn felt(&self, rate: f64) -> (f64, f64) {
        let Law { skin, stopped, .. } = self.law;
        if stopped.is_infinite() {
            return (1.0, 0.0);
        }
        if skin.restitution == 0.0 {
            let half = stopped * if self.law.is_dull { 1.0 } else { HALF_SPEED_RATIO };
            let speed = rate / half;
            let squared = speed * speed;
            let felt = 1.0 / (1.0 + squared * squared);
            return (felt, -4.0 * squared * speed * felt * felt / half);
        }
        let fastest = if rate < 0.0 { stopped } else { skin.restitution * stopped };
        let ratio = rate / fastest;
        let left = 1.0 - ratio.powi(4);
        if left <= 0.0 {
            return (0.0, 0.0);
        }
        let fades = -12.0 * left * left * ratio.powi(3) / fastest;
        (left * left * left, fades)
    }

    /// Returns the largest share q of the force by which damping changes it, and the squared range
    /// of rates over which it changes, relative to that of the damping coefficient.
    fn loss(&self, share: f64) -> (f64, f64) {
        let Skin { restitution, stiffness, thickness, .. } = self.law.skin;
        if restitution == 0.0 {
            return (1.0, 1.0);
        }
        let squared = ((restitution * restitution - TURNING_LOSS) / (1.0 - TURNING_LOSS)).max(0.0);
        let size = 4.0 * self.potential(share) / (stiffness * thickness * thickness);
        ((1.0 - squared) / (1.0 + squared), size)
    }

    /// Returns the factor of the potential of two edges, and its derivatives with respect to their
    /// vectors.
    fn crossing(&self) -> (f64, [Vector3<f64>; 2]) {
        let [a, b] = [self.x[1] - self.x[0], self.x[3] - self.x[2]];
        if self.kind != PairKind::EdgeEdge || a == Vector3::zeros() || b == Vector3::zeros() {
            return (1.0, [Vector3::zeros(); 2]);
        }
        let full = FULL_CROSSING * (4.0 * self.law.skin.thickness).powi(4);
        let (aa, bb, ab) = (a.norm_squared(), b.norm_squared(), a.dot(&b));
        let q = (aa * bb - ab * ab) / full;
        if q >= 1.0 {
            return (1.0, [Vector3::zeros(); 2]);
        }
        // The factor is 1 - (1 - q)3, whose first two derivatives are zero where it is 1.
        let left = 1.0 - q;
        let slope = 6.0 * left * left / full;
        let along = [a * bb - b * ab, b * aa - a * ab];
        (1.0 - left * left * left, along.map(|d| d * slope))
    }

    /// Returns the forces on the four points (N), if there are any.
    pub fn forces(&self) -> Option<[Vector3<f64>; 4]> {
        let TouchState { weights, normal, share } = self.within()?;
        let (factor, along) = self.crossing();
        let (force, _) = self.law_at(share);
        let (damping, _) = self.damping(share, normal.dot(&weighted(&weights, &self.v)));
        let mut forces = weights.map(|w| normal * (w * force * factor * damping));
        if factor < 1.0 {
            let potential = self.potential(share);
            for (k, along) in [0, 2].into_iter().zip(along) {
                forces[k] += along * potential;
                forces[k + 1] -= along * potential;
            }
        }
        Some(forces)
    }

    /// Returns the magnitude of the force between the primitives (N), if there is any, with the
    /// weights of their closest points and the normal from the second to the first.
    pub fn force(&self) -> Option<(f64, [f64; 4], Vector3<f64>)> {
        let TouchState { weights, normal, share } = self.within()?;
        let (damping, _) = self.damping(share, normal.dot(&weighted(&weights, &self.v)));
        let force = self.law_at(share).0 * damping * self.crossing().0;
        Some((force, weights, normal))
    }

    /// Returns the change of the forces (N) if the points move by dx (m) and their velocities
    /// change by dv (m/s), by a difference quotient; `None` if there is none.
    pub fn differential(
        &self,
        dx: &[Vector3<f64>; 4],
        dv: &[Vector3<f64>; 4],
    ) -> Option<[Vector3<f64>; 4]> {
        let most = |d: &[Vector3<f64>; 4]| d.iter().map(Vector3::norm).fold(0.0, f64::max);
        let skin = self.law.skin;
        let size = (most(dx) / skin.thickness).max(most(dv) * skin.damping);
        if size == 0.0 {
            return None;
        }
        let step = DIFFERENCE_STEP / size;
        let at = |step: f64| {
            let moved = |a: &[Vector3<f64>; 4], d: &[Vector3<f64>; 4]| {
                std::array::from_fn(|k| a[k] + d[k] * step)
            };
            let pair = Self { x: moved(&self.x, dx), v: moved(&self.v, dv), ..*self };
            pair.forces()
        };
        let (after, before) = (at(step), at(-step));
        if after.is_none() && before.is_none() {
            return None;
        }
        let [after, before] = [after, before].map(Option::unwrap_or_default);
        Some(std::array::from_fn(|k| (after[k] - before[k]) / (2.0 * step)))
    }

    /// Returns the share of the thickness that the gap lacks: above 0 within the thickness, 1 where
    /// the gap is 0.
    pub fn share(&self) -> f64 {
        self.within().map_or(0.0, |within| within.share)
    }

    /// Returns the energy of repulsion (J).
    pub fn energy(&self) -> f64 {
        self.within().map_or(0.0, |within| {
            let potential = self.potential(within.share) * self.crossing().0;
            let rate = within.normal.dot(&weighted(&within.weights, &self.v));
            potential * self.felt(rate).0
        })
    }

    /// Returns the stiffness and damping, if there are any: the part of the differential that is
    /// positive semi-definite.
    pub fn stiffness(&self) -> Option<Stiffness> {
        let TouchState { weights, normal, share } = self.within()?;
        let factor = self.crossing().0;
        let (force, slope) = self.law_at(share);
        let (damping, rate) = self.damping(share, normal.dot(&weighted(&weights, &self.v)));
        Some(Stiffness {
            weights,
            normal,
            stiffness: slope * damping * factor,
            damping: -force * rate * factor,
        })
    }
}
