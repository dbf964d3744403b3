//! A sparse Cholesky factorisation (faer) whose order and pattern are found once. Pinned particles
//! keep rows of the identity, so that pinning one changes no pattern.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side, Spec};

use super::tangent::Tangent;

/// The matrix in columns, unknowns by particle, its factor, and scratch.
pub(crate) struct Cholesky {
    /// Place of the block of each coupling: the particle whose columns it is in, and its place
    /// among their blocks.
    places: Vec<(u32, u32)>,
    column_starts: Vec<u32>,
    rows: Vec<u32>,
    values: Vec<f64>,
    symbolic: SymbolicCholesky<u32>,
    factor: Vec<f64>,
    memory: MemBuffer,
    rhs: Vec<f64>,
    /// Operations of a factorisation.
    pub operations: f64,
    /// Numbers in the factor.
    pub size: f64,
}

impl Cholesky {
    /// The pattern of a tangent; `None` if the factor takes more memory than there is.
    pub fn new(tangent: &Tangent) -> Option<Self> {
        let n = tangent.particles();
        let pairs: Vec<_> = tangent.pairs().collect();
        // The higher neighbours of each particle.
        let mut neighbours: Vec<Vec<u32>> = vec![vec![]; n];
        for &(i, j) in &pairs {
            neighbours[i.min(j) as usize].push(i.max(j));
        }
        for list in &mut neighbours {
            list.sort_unstable();
            list.dedup();
        }
        let (mut column_starts, mut rows) = (vec![0], vec![]);
        for (i, list) in neighbours.iter().enumerate() {
            for b in 0..3 {
                rows.extend((b..3).map(|r| 3 * i as u32 + r));
                rows.extend(list.iter().flat_map(|j| (0..3).map(move |r| 3 * j + r)));
                column_starts.push(rows.len() as u32);
            }
        }
        let places = pairs
            .iter()
            .map(|(i, j)| {
                let (low, high) = (i.min(j), i.max(j));
                let list = &neighbours[*low as usize];
                (*low, list.partition_point(|k| k < high) as u32)
            })
            .collect();
        let pattern =
            SymbolicSparseColMatRef::new_checked(3 * n, 3 * n, &column_starts, None, &rows);
        let symbolic = factorize_symbolic_cholesky(
            pattern,
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams::default(),
        )
        .ok()?;
        let room = symbolic
            .factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let memory = MemBuffer::try_new(room).ok()?;
        let (operations, size) = cost(&symbolic);
        Some(Self {
            factor: vec![0.0; symbolic.len_val()],
            values: vec![0.0; rows.len()],
            rhs: vec![0.0; 3 * n],
            places,
            column_starts,
            rows,
            symbolic,
            memory,
            operations,
            size,
        })
    }

    /// Factorises A. Returns whether it is positive definite.
    pub fn factorise(&mut self, tangent: &Tangent) -> bool {
        self.fill(tangent);
        let n = self.rhs.len();
        let pattern =
            SymbolicSparseColMatRef::new_checked(n, n, &self.column_starts, None, &self.rows);
        self.symbolic
            .factorize_numeric_llt(
                &mut self.factor,
                SparseColMatRef::new(pattern, &self.values),
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut self.memory),
                Spec::default(),
            )
            .is_ok()
    }

    /// Solves A x = b with the factor.
    pub fn solve(&mut self, b: &[f64], x: &mut [f64]) {
        let n = b.len() / 3;
        for (k, value) in self.rhs.iter_mut().enumerate() {
            *value = b[k % 3 * n + k / 3];
        }
        let dim = self.rhs.len();
        faer::sparse::linalg::cholesky::LltRef::new(&self.symbolic, &self.factor)
            .solve_in_place_with_conj(
                Conj::No,
                MatMut::from_column_major_slice_mut(&mut self.rhs, dim, 1),
                Par::Seq,
                MemStack::new(&mut self.memory),
            );
        for (k, value) in self.rhs.iter().enumerate() {
            x[k % 3 * n + k / 3] = *value;
        }
    }

    fn fill(&mut self, tangent: &Tangent) {
        self.values.fill(0.0);
        let start =
            |particle: usize, column: usize| self.column_starts[3 * particle + column] as usize;
        for i in 0..tangent.particles() {
            let m = if tangent.masses()[i] == 0.0 {
                1.0
            } else {
                tangent.masses()[i]
            };
            for b in 0..3 {
                self.values[start(i, b)] = m;
            }
        }
        let values = &mut self.values;
        let mut places = self.places.iter();
        tangent.blocks(|i, j, block| {
            let Some((low, place)) = places.next() else {
                return;
            };
            let at = |row: usize, column: usize| block[3 * row + column];
            let free = |k: usize| tangent.masses()[k] != 0.0;
            for end in [i, j] {
                if free(end) {
                    // The blocks of a particle have a symmetric sum.
                    for b in 0..3 {
                        for (value, r) in values[start(end, b)..].iter_mut().zip(b..3) {
                            *value += 0.5 * (at(b, r) + at(r, b));
                        }
                    }
                }
            }
            if free(i) && free(j) {
                for b in 0..3 {
                    let first = start(*low as usize, b) + (3 - b) + 3 * *place as usize;
                    for r in 0..3 {
                        values[first + r] -= if *low as usize == i {
                            at(b, r)
                        } else {
                            at(r, b)
                        };
                    }
                }
            }
        });
    }
}

/// Operations of a factorisation, and numbers in the factor.
fn cost(symbolic: &SymbolicCholesky<u32>) -> (f64, f64) {
    let square = |length: f64| length * length;
    let operations = match symbolic.raw() {
        SymbolicCholeskyRaw::Simplicial(factor) => factor
            .col_ptr()
            .windows(2)
            .map(|ends| square(f64::from(ends[1] - ends[0])))
            .sum(),
        SymbolicCholeskyRaw::Supernodal(factor) => (0..factor.n_supernodes())
            .map(|s| {
                let width = factor.supernode_end()[s] - factor.supernode_begin()[s];
                let below = factor.col_ptr_for_row_idx()[s + 1] - factor.col_ptr_for_row_idx()[s];
                (0..width)
                    .map(|k| square(f64::from(below + width - k)))
                    .sum::<f64>()
            })
            .sum(),
    };
    (operations, symbolic.len_val() as f64)
}
