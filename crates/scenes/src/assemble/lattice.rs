//! Lattice of a box. That of a jelly has structural springs along the axes, shear springs across
//! faces and cells, and bend springs to the next particle but one; that of a solid has six
//! tetrahedra a cell.

use a3_core::{Spring, SpringKind, SpringLaw};

use super::pins::side;
use crate::description::Spot;
use crate::fault::Fault;

/// Lattice of nx x ny x nz particles, in which x is counted fastest, then y, then z.
#[derive(Clone, Copy)]
pub(super) struct Lattice(pub [usize; 3]);

/// Kinds of springs, and the offset from one end to the other in particles.
const OFFSETS: [(SpringKind, [isize; 3]); 16] = [
    (SpringKind::Structural, [1, 0, 0]),
    (SpringKind::Structural, [0, 1, 0]),
    (SpringKind::Structural, [0, 0, 1]),
    (SpringKind::Shear, [1, 1, 0]),
    (SpringKind::Shear, [1, -1, 0]),
    (SpringKind::Shear, [1, 0, 1]),
    (SpringKind::Shear, [1, 0, -1]),
    (SpringKind::Shear, [0, 1, 1]),
    (SpringKind::Shear, [0, 1, -1]),
    (SpringKind::Shear, [1, 1, 1]),
    (SpringKind::Shear, [1, 1, -1]),
    (SpringKind::Shear, [1, -1, 1]),
    (SpringKind::Shear, [1, -1, -1]),
    (SpringKind::Bend, [2, 0, 0]),
    (SpringKind::Bend, [0, 2, 0]),
    (SpringKind::Bend, [0, 0, 2]),
];

/// Kuhn's tetrahedra of a cell: the order of the axes along which each goes from one corner to the
/// opposite one. Neighbouring cells agree on the diagonals of their faces.
const KUHN_PATHS: [[usize; 3]; 6] = [
    [0, 1, 2],
    [1, 2, 0],
    [2, 0, 1],
    [0, 2, 1],
    [2, 1, 0],
    [1, 0, 2],
];

impl Lattice {
    /// Counts the particles of a body of this name, which needs two along each edge as in the
    /// example.
    pub fn particles(self, body: &str, example: [usize; 3]) -> Result<usize, Fault> {
        let [nx, ny, nz] = self.0;
        let particles = nx.checked_mul(ny).and_then(|layer| layer.checked_mul(nz));
        let particles = particles.filter(|_| self.0.iter().all(|n| *n >= 2));
        particles.ok_or_else(|| {
            let why = format!(
                "a {body} has at least 2 particles along each edge, such as {example:?}, not {:?}",
                self.0
            );
            Fault::new("grid", why)
        })
    }

    /// Returns the number of the particle at a lattice point.
    pub fn index_of(self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.0[1] + j) * self.0[0] + i
    }

    /// Lists the lattice points [i, j, k] of all particles, in the order of their numbers.
    pub fn cells(self) -> impl Iterator<Item = [usize; 3]> {
        let [nx, ny, nz] = self.0;
        (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
    }

    /// Lists the particles of a face, if the spot is one.
    pub fn face(self, spot: Spot) -> Option<Vec<usize>> {
        let (axis, far) = side(spot)?;
        let at = if far { self.0[axis] - 1 } else { 0 };
        let there = self.cells().filter(|cell| cell[axis] == at);
        Some(there.map(|cell| self.index_of(cell)).collect())
    }

    /// Lists the tetrahedra, six in each cell, with positive volumes.
    pub fn tetrahedra(self) -> impl Iterator<Item = [u32; 4]> {
        let cells = self.cells();
        let whole = cells.filter(move |cell| (0..3).all(|axis| cell[axis] + 1 < self.0[axis]));
        whole.flat_map(move |cell| {
            KUHN_PATHS.into_iter().enumerate().map(move |(k, axes)| {
                let mut at = cell;
                let mut corners = [self.index_of(cell) as u32; 4];
                for (corner, axis) in corners[1..].iter_mut().zip(axes) {
                    at[axis] += 1;
                    *corner = self.index_of(at) as u32;
                }
                // The last three paths have the opposite orientation.
                if k >= 3 {
                    corners.swap(1, 2);
                }
                corners
            })
        })
    }

    /// Lists the springs of a lattice with this spacing (m). `law` gives the law of a spring by its
    /// kind and length (m).
    pub fn springs(
        self,
        spacing: [f64; 3],
        law: impl Fn(SpringKind, f64) -> SpringLaw,
    ) -> impl Iterator<Item = Spring> {
        let laws = OFFSETS.map(|(kind, offset)| {
            let squares = (0..3).map(|axis| (offset[axis] as f64 * spacing[axis]).powi(2));
            law(kind, squares.sum::<f64>().sqrt())
        });
        self.cells().flat_map(move |here| {
            OFFSETS
                .into_iter()
                .zip(laws)
                .filter_map(move |((kind, offset), law)| {
                    let mut there = here;
                    for axis in 0..3 {
                        there[axis] = here[axis]
                            .checked_add_signed(offset[axis])
                            .filter(|k| *k < self.0[axis])?;
                    }
                    Some(Spring {
                        kind,
                        i: self.index_of(here),
                        j: self.index_of(there),
                        law,
                    })
                })
        })
    }

    /// Lists the triangles of the six faces, counterclockwise as seen from outside.
    pub fn triangles(self) -> Vec<[u32; 3]> {
        let mut triangles = vec![];
        for axis in 0..3 {
            // (u, v, axis) are right-handed: the far face turns from u to v.
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            for far in [false, true] {
                for a in 0..self.0[u] - 1 {
                    for b in 0..self.0[v] - 1 {
                        let corner = |da: usize, db: usize| {
                            let mut at = [0; 3];
                            (at[u], at[v]) = (a + da, b + db);
                            at[axis] = if far { self.0[axis] - 1 } else { 0 };
                            self.index_of(at) as u32
                        };
                        let [p, q, r, s] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                        let halves = if far {
                            [[p, q, r], [p, r, s]]
                        } else {
                            [[p, r, q], [p, s, r]]
                        };
                        triangles.extend(halves);
                    }
                }
            }
        }
        triangles
    }
}
