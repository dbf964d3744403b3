//! An edge that crosses a triangle.

use nalgebra::Vector3;

use super::points::Push;
use super::skeleton::Skeleton;
use crate::contact::exact::Crossing;

/// Largest displacement of a round, as a share of the length of the edge or of the size of the
/// triangle; of fine surfaces as of coarse ones of the same size.
const REACH: f64 = 0.25;
/// Least displacement of a passage, as a share of the largest.
const LEAST: f64 = 0.5;

/// An edge that crosses a triangle.
pub(super) struct Hit {
    /// Numbers of the edge and of the triangle.
    pub edge: usize,
    pub triangle: usize,
    ends: [u32; 2],
    corners: [u32; 3],
    /// Place along the edge, from 0 to 1.
    pub share: f64,
    /// Weights of the corners at that place, which sum to 1.
    weights: [f64; 3],
    /// Normal of the triangle.
    pub normal: Vector3<f64>,
    /// Heights of the ends of the edge above the triangle (m).
    pub heights: [f64; 2],
    /// Largest displacement of a round (m).
    pub most: f64,
}

impl Hit {
    pub fn new(skeleton: &Skeleton, crossing: Crossing, at: &[Vector3<f64>]) -> Self {
        let Crossing { edge, triangle } = crossing;
        let (ends, corners) = (skeleton.edges[edge], skeleton.triangles[triangle]);
        let [p, q] = ends.map(|i| at[i as usize]);
        let [a, b, c] = corners.map(|i| at[i as usize]);
        let doubled = (b - a).cross(&(c - a));
        // Degenerate triangles have no normal, and do not move.
        let area = doubled.norm().max(f64::MIN_POSITIVE);
        let normal = doubled / area;
        let heights = [p, q].map(|end| (end - a).dot(&normal));
        let across = heights[0] - heights[1];
        let share = if across == 0.0 {
            0.5
        } else {
            (heights[0] / across).clamp(0.0, 1.0)
        };
        let place = p + (q - p) * share;
        let part = |u: Vector3<f64>, v: Vector3<f64>| {
            ((u - place).cross(&(v - place)).dot(&normal) / area).clamp(0.0, 1.0)
        };
        let parts = [part(b, c), part(c, a), part(a, b)];
        let sum: f64 = parts.iter().sum();
        Self {
            edge,
            triangle,
            ends,
            corners,
            share,
            weights: if sum > 0.0 {
                parts.map(|part| part / sum)
            } else {
                [1.0 / 3.0; 3]
            },
            normal,
            heights,
            most: REACH
                * skeleton.fineness([ends[0], corners[0]])
                * (q - p).norm().min(area.sqrt()),
        }
    }

    /// Returns the displacement (m) of the edge relative to the triangle that brings an end of the
    /// edge to the side of the other.
    pub fn passage(&self, end: usize) -> Vector3<f64> {
        let [own, other] = [self.heights[end], self.heights[1 - end]];
        let height = if own == 0.0 { -other } else { own };
        let by = height.abs().clamp(LEAST * self.most, self.most);
        self.normal * -by.copysign(height)
    }

    /// Returns the end of the edge on the upper side of the triangle.
    pub fn upper_end(&self) -> usize {
        usize::from(self.heights[1] > self.heights[0])
    }

    /// Returns the push that moves the edge relative to the triangle.
    pub fn push(&self, by: Vector3<f64>) -> Push {
        let ([p, q], [a, b, c]) = (self.ends, self.corners);
        let [u, v, w] = self.weights;
        Push {
            points: [p, q, a, b, c],
            shares: [1.0 - self.share, self.share, -u, -v, -w],
            by,
        }
    }
}
