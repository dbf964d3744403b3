//! Single springs. Few are evaluated one by one, and many in vectors (see `packed`).
//!
//! The blocks of springs on the diagonal of an implicit step's matrix, by which conjugate gradients
//! are preconditioned. They are summed without a list of couplings. The springs of a chunk are
//! computed in SIMD vectors, whether their ends are consecutive particles or not.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::ops::Range;
use std::sync::OnceLock;

use pulp::{Simd, WithSimd};

use super::axial::{add_all, add_differential, coupling, energy};
use super::force::{At, Cost, Force, Matter, check_ends, ends};
use super::inverse_root::inverse_root;
use super::packed::{Packed, SPEED};
use crate::coupling::{Coupling, Diagonal, Matrix};
use crate::energy::Energy;
use crate::error::Error;
use crate::fused::{mul_adds, negate_mul_adds};
use crate::spring::{Spring, SpringLaw};
use crate::vectors::Arch;

/// Single springs, in any order.
#[derive(Debug, Default)]
pub struct Springs {
    all: Vec<Spring>,
    /// Packed copy of the springs, built on first use if there are many.
    packed: OnceLock<Option<Packed>>,
}

impl Springs {
    /// Creates springs in the order given.
    #[must_use]
    pub fn new(all: Vec<Spring>) -> Self {
        Self { all, packed: OnceLock::new() }
    }

    /// Returns all springs, in their order.
    #[must_use]
    pub fn all(&self) -> &[Spring] {
        &self.all
    }

    /// Adds a spring at the end.
    pub(crate) fn push(&mut self, spring: Spring) {
        self.change().push(spring);
    }

    /// Sorts the springs by their ends, so that neighbours in memory are used one after another.
    pub(crate) fn sort(&mut self) {
        self.change().sort_by_key(ends);
    }

    /// Returns the springs, to be changed, and drops their packed copy.
    fn change(&mut self) -> &mut Vec<Spring> {
        self.packed = OnceLock::new();
        &mut self.all
    }

    /// Returns the packed copy, if there are many springs.
    pub(crate) fn packed(&self) -> Option<&Packed> {
        self.packed.get_or_init(|| Packed::new(&self.all)).as_ref()
    }
}

impl Clone for Springs {
    fn clone(&self) -> Self {
        Self::new(self.all.clone())
    }
}

impl PartialEq for Springs {
    fn eq(&self, other: &Self) -> bool {
        self.all == other.all
    }
}

impl Force for Springs {
    fn name(&self) -> &'static str {
        "springs"
    }

    fn matter(&self) -> Option<Matter> {
        Some(Matter::Springs)
    }

    fn check(&self, particles: usize) -> Result<(), Error> {
        self.all.iter().try_for_each(|spring| check_ends([spring.i, spring.j], particles))
    }

    fn add_forces(&self, at: &At, f: &mut [f64]) {
        match self.packed() {
            Some(packed) => packed.add_forces(at, f),
            None => add_all(&self.all, at.x, at.v, f),
        }
    }

    fn add_differential(&self, at: &At, d: [&[f64]; 2], df: &mut [f64]) {
        if let Some(packed) = self.packed() {
            packed.add_differential(at, d, df);
            return;
        }
        for spring in &self.all {
            add_differential(spring, at, d, df);
        }
    }

    fn couplings(&self, _t: f64, x: &[f64], clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        for spring in &self.all {
            visit(coupling(spring, x, clamped));
        }
    }

    fn multiplies_together(&self) -> bool {
        self.packed().is_some()
    }

    fn add_diagonal(&self, matrix: &Matrix, diagonal: &mut Diagonal) -> usize {
        self.packed().map_or(0, |packed| {
            add_springs(&self.all, matrix, diagonal);
            packed.len()
        })
    }

    fn energy(&self, at: &At) -> Energy {
        energy(self.all.iter().copied(), at.x)
    }

    fn reads_velocity(&self) -> bool {
        self.all.iter().any(|spring| spring.law.damping > 0.0)
    }

    fn cost(&self) -> Cost {
        let springs = self.all.len() as f64;
        let speed = if self.packed().is_some() { SPEED } else { 1.0 };
        Cost { couplings: springs, price: springs / speed }
    }

    fn scale(&mut self, stiffness: f64, damping: f64) {
        for spring in self.change() {
            spring.law.scale(stiffness, damping);
        }
    }

    fn remove_springs(&mut self, torn: &[[usize; 2]]) {
        self.change().retain(|spring| torn.binary_search(&ends(spring)).is_err());
    }
}

/// Number of springs in a chunk, whose numbers fit into the first-level cache.
const CHUNK: usize = 64;

/// Adds the blocks of springs between consecutive particles, given in runs: the law of a run, the
/// first ends of its springs, and the offset of their second ends.
pub(super) fn add_runs(
    runs: impl Iterator<Item = (SpringLaw, Range<usize>, usize)>,
    matrix: &Matrix,
    diagonal: &mut Diagonal,
) {
    Arch::new().dispatch(OfRuns { runs, matrix, diagonal });
}

/// Adds the blocks of single springs.
pub(super) fn add_springs(springs: &[Spring], matrix: &Matrix, diagonal: &mut Diagonal) {
    Arch::new().dispatch(OfSprings { springs, matrix, diagonal });
}

struct OfRuns<'a, 'b, R> {
    runs: R,
    matrix: &'a Matrix<'a>,
    diagonal: &'a mut Diagonal<'b>,
}

impl<R: Iterator<Item = (SpringLaw, Range<usize>, usize)>> WithSimd for OfRuns<'_, '_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let n = self.matrix.x.len() / 3;
        let mut chunk = Chunk::new();
        for (law, begins, further) in self.runs {
            chunk.fill(&law, self.matrix);
            for begin in begins.clone().step_by(CHUNK) {
                let len = CHUNK.min(begins.end - begin);
                for (axis, apart) in chunk.apart.iter_mut().enumerate() {
                    let ends = [begin, begin + further].map(|i| axis * n + i);
                    let [a, b] = ends.map(|i| &self.matrix.x[i..i + len]);
                    let apart = &mut apart[..len];
                    for k in 0..len {
                        apart[k] = a[k] - b[k];
                    }
                }
                chunk.find(simd, len, self.matrix.clamped);
                for (column, part) in self.diagonal.columns.iter_mut().zip(&chunk.parts) {
                    let part = &part[..len];
                    for i in [begin, begin + further] {
                        let column = &mut column[i..i + len];
                        for k in 0..len {
                            column[k] += part[k];
                        }
                    }
                }
            }
        }
    }
}

struct OfSprings<'a, 'b> {
    springs: &'a [Spring],
    matrix: &'a Matrix<'a>,
    diagonal: &'a mut Diagonal<'b>,
}

impl WithSimd for OfSprings<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let n = self.matrix.x.len() / 3;
        let mut chunk = Chunk::new();
        for springs in self.springs.chunks(CHUNK) {
            for (k, Spring { i, j, law, .. }) in springs.iter().enumerate() {
                for (axis, apart) in chunk.apart.iter_mut().enumerate() {
                    apart[k] = self.matrix.x[axis * n + i] - self.matrix.x[axis * n + j];
                }
                for (number, of_law) in chunk.laws.iter_mut().zip(numbers(law, self.matrix)) {
                    number[k] = of_law;
                }
            }
            chunk.find(simd, springs.len(), self.matrix.clamped);
            for (column, part) in self.diagonal.columns.iter_mut().zip(&chunk.parts) {
                for (Spring { i, j, .. }, part) in springs.iter().zip(part) {
                    column[*i] += part;
                    column[*j] += part;
                }
            }
        }
    }
}

/// Returns k, k r and c of a law, times their factors in the matrix.
#[inline(always)]
fn numbers(law: &SpringLaw, matrix: &Matrix) -> [f64; 3] {
    let k = matrix.stiffness * law.stiffness;
    [k, k * law.rest_length, matrix.damping * law.damping]
}

/// Numbers of the springs of a chunk.
#[repr(C, align(64))]
struct Chunk {
    /// Vector from the second end of each spring to its first (m).
    apart: [[f64; CHUNK]; 3],
    laws: [[f64; CHUNK]; 3],
    /// Blocks of the springs, and the largest eigenvalues of the blocks.
    parts: [[f64; CHUNK]; 7],
}

impl Chunk {
    #[inline(always)]
    fn new() -> Self {
        Self { apart: [[0.0; CHUNK]; 3], laws: [[0.0; CHUNK]; 3], parts: [[0.0; CHUNK]; 7] }
    }

    /// Gives all springs one law.
    #[inline(always)]
    fn fill(&mut self, law: &SpringLaw, matrix: &Matrix) {
        for (number, of_law) in self.laws.iter_mut().zip(numbers(law, matrix)) {
            number.fill(of_law);
        }
    }

    /// Computes the blocks of the first `count` springs: q 1 + (k - q + c) d dT / L2, with q = k -
    /// k r / L.
    #[inline(always)]
    fn find<S: Simd>(&mut self, simd: S, len: usize, clamped: bool) {
        let [x, y, z] = self.apart.each_ref().map(|a| S::as_simd_f64s(a).0);
        let [k, k_r, c] = self.laws.each_ref().map(|a| S::as_simd_f64s(a).0);
        let parts = self.parts.each_mut().map(|a| S::as_mut_simd_f64s(a).0);
        let zero = simd.splat_f64s(0.0);
        for i in 0..len.div_ceil(S::F64_LANES) {
            let (x, y, z) = (x[i], y[i], z[i]);
            let square = mul_adds(simd, z, z, mul_adds(simd, y, y, simd.mul_f64s(x, x)));
            // A spring of length 0 has no direction.
            let has_length = simd.less_than_f64s(zero, square);
            let inverse = simd.select_f64s(has_length, inverse_root(simd, square), zero);
            let mut q = negate_mul_adds(simd, k_r[i], inverse, k[i]);
            if clamped {
                q = simd.max_f64s(q, zero);
            }
            let more = simd.add_f64s(simd.sub_f64s(k[i], q), c[i]);
            let along = simd.mul_f64s(simd.mul_f64s(more, inverse), inverse);
            let [of_x, of_y] = [simd.mul_f64s(along, x), simd.mul_f64s(along, y)];
            parts[0][i] = mul_adds(simd, of_x, x, q);
            parts[1][i] = mul_adds(simd, of_y, y, q);
            parts[2][i] = mul_adds(simd, simd.mul_f64s(along, z), z, q);
            parts[3][i] = simd.mul_f64s(of_x, y);
            parts[4][i] = simd.mul_f64s(of_x, z);
            parts[5][i] = simd.mul_f64s(of_y, z);
            parts[6][i] = simd.add_f64s(q, simd.max_f64s(more, zero));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Triangles;
    use crate::random::SplitMix;
    use crate::spring::{SpringKind, SpringLaw};

    #[test]
    fn what_is_packed_follows_every_change() {
        let mut random = SplitMix(3);
        let mut numbers =
            |count: usize| -> Vec<f64> { (0..count).map(|_| random.between(-1.0, 1.0)).collect() };
        let (x, v) = (numbers(150), numbers(150));
        let spring = |k: usize| Spring {
            i: k % 50,
            j: (k + 1 + k / 50) % 50,
            kind: SpringKind::Structural,
            law: SpringLaw::new(1.0 + k as f64, 0.5, 0.1).unwrap(),
        };
        let mut element = Springs::new((0..2000).map(spring).filter(|s| s.i != s.j).collect());
        let check = |element: &Springs| {
            assert!(element.packed().is_some());
            let at = At { t: 0.0, x: &x, v: &v, masses: &[], triangles: &Triangles::default() };
            let [mut found, mut expected] = [vec![0.0; 150], vec![0.0; 150]];
            element.add_forces(&at, &mut found);
            add_all(&element.all, &x, &v, &mut expected);
            let size = expected.iter().fold(0.0_f64, |most, f| most.max(f.abs()));
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-13 * size, "{found} {expected}");
            }
        };
        check(&element);
        element.scale(2.0, 3.0);
        check(&element);
        let torn = ends(&element.all()[3]);
        element.remove_springs(&[torn]);
        check(&element);
        element.push(spring(7));
        check(&element);
    }
}
