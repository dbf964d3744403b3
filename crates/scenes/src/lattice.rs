//! A box of particles: structural springs along its axes, shear across its faces and its cells, bend to the next but one.

use a3_core::{Spring, SpringKind, SpringLaw};

/// nx x ny x nz particles; x is counted fastest, then y, then z.
#[derive(Clone, Copy)]
pub(super) struct Lattice(pub [usize; 3]);

/// What springs are for, and how many particles on they go. The first coordinate that is not zero is positive.
const WAYS: [(SpringKind, [isize; 3]); 16] = [
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

impl Lattice {
    /// Number of particles, if it is one.
    pub fn particles(self) -> Option<usize> {
        let [nx, ny, nz] = self.0;
        nx.checked_mul(ny)?.checked_mul(nz)
    }

    pub fn index_of(self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.0[1] + j) * self.0[0] + i
    }

    /// Every place, in the order of its numbers.
    pub fn places(self) -> impl Iterator<Item = [usize; 3]> {
        let [nx, ny, nz] = self.0;
        (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
    }

    /// The springs between cells of that size (m). `law` makes one of what it is for and its length (m).
    pub fn springs(
        self,
        spacing: [f64; 3],
        law: impl Fn(SpringKind, f64) -> SpringLaw,
    ) -> impl Iterator<Item = Spring> {
        let laws = WAYS.map(|(kind, way)| {
            let squares = (0..3).map(|axis| (way[axis] as f64 * spacing[axis]).powi(2));
            law(kind, squares.sum::<f64>().sqrt())
        });
        self.places().flat_map(move |here| {
            WAYS.into_iter()
                .zip(laws)
                .filter_map(move |((kind, way), law)| {
                    let mut there = here;
                    for axis in 0..3 {
                        there[axis] = here[axis]
                            .checked_add_signed(way[axis])
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

    /// The triangles of its six faces, wound against the clock as seen from outside.
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
