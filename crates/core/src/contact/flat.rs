//! Flat faces of rigid shapes: a face of several triangles repels particles and round bodies like
//! one.
//!
//! A vertex above a flat face is within reach of several of its triangles, but only the one below
//! it repels it: a triangle does not, if the vertex lies beyond an edge that it shares with a
//! triangle in the same plane. So the force does not depend on the triangulation, and is continuous
//! from one triangle to the next. The shared edge repels no edge of a round body, because the faces
//! on either side do.
//!
//! Corners and edges of cloth, boxes and meshes interact with all triangles: the surfaces below
//! support them at many points.

use nalgebra::Vector3;

use super::listing::Candidate;
use super::surface::Surface;
use crate::geometry::PairKind;

impl Surface {
    /// Returns whether a pair at these positions (m) does not repel, because a neighbouring
    /// triangle in the same plane does.
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
