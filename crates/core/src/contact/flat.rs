//! Flat faces of rigid shapes: a face that consists of several triangles repels particles and round
//! bodies as one.
//!
//! A vertex above a flat face is within reach of all its triangles that are near, but only that
//! under it repels it: none from which it lies beyond an edge to a triangle in the same plane. So
//! the force does not depend on the triangles, and is continuous where one follows another. The
//! edge between them repels no edge of a round body, as the face on either side does that.
//!
//! Corners and edges of cloth, boxes and meshes meet all triangles: what is under these surfaces
//! holds them at many points.

use nalgebra::Vector3;

use super::listing::Candidate;
use super::surface::Surface;
use crate::geometry::PairKind;

impl Surface {
    /// Whether a pair with these positions (m) does not repel, because a triangle in the same plane
    /// as one of its own does.
    pub(super) fn is_beside(&self, candidate: &Candidate, x: &[Vector3<f64>; 4]) -> bool {
        let [i, a, b, c] = candidate.points;
        match candidate.kind {
            PairKind::VertexTriangle => {
                let beyond = |[p, q, r]: [usize; 3]| {
                    let along = x[q] - x[p];
                    let normal = along.cross(&(x[r] - x[p]));
                    along.cross(&(x[0] - x[p])).dot(&normal) < 0.0
                };
                self.is_single(i)
                    && [
                        ([a, b], [1, 2, 3]),
                        ([b, c], [2, 3, 1]),
                        ([c, a], [3, 1, 2]),
                    ]
                    .into_iter()
                    .any(|(edge, corners)| self.is_flat(edge) && beyond(corners))
            }
            PairKind::EdgeEdge => {
                self.is_flat([i, a]) && self.is_single(b)
                    || self.is_flat([b, c]) && self.is_single(i)
            }
            PairKind::VertexFloor => false,
        }
    }
}
