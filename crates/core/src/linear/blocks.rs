//! A Cholesky factorisation A = L D LT by 3 x 3 blocks, one for each particle and each coupling,
//! for chains, trees and all patterns that a factor hardly fills. The particle with the fewest
//! neighbours is eliminated first (minimum degree; George, Liu, *Computer Solution of Large Sparse
//! Positive Definite Systems*, 1981). Pinned particles keep rows of the identity.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

use super::tangent::Tangent;

/// Largest number of products of blocks in a factorisation for each coupling: a factor that takes
/// more is better computed in dense panels.
const MOST_PRODUCTS: usize = 8;

/// Matrix of nine numbers, row by row.
type Block = [f64; 9];

/// The factor of a matrix whose pattern was analysed, with scratch.
pub(crate) struct BlockCholesky {
    /// Block of each coupling.
    places: Vec<u32>,
    /// Particles in the order of their elimination.
    order: Vec<u32>,
    /// First block of each eliminated particle; its blocks end where those of the next begin.
    starts: Vec<u32>,
    /// Particle that a block couples to the eliminated one, and that is eliminated later.
    rows: Vec<u32>,
    /// Block that each pair of different blocks of an eliminated particle changes.
    targets: Vec<u32>,
    /// Blocks of L below the diagonal, times D until their particle is eliminated.
    blocks: Vec<Block>,
    /// Blocks of D for each particle, and their inverses once it is eliminated.
    diagonal: Vec<Block>,
    /// Unknowns of each particle.
    unknowns: Vec<[f64; 3]>,
    /// Products of blocks in a factorisation.
    pub products: f64,
    /// Blocks below the diagonal of the factor.
    pub size: f64,
}

impl BlockCholesky {
    /// The pattern of a tangent; `None` if the factor would be much larger than the matrix.
    pub fn new(tangent: &Tangent) -> Option<Self> {
        let n = tangent.particles();
        let pairs: Vec<_> = tangent.pairs().collect();
        let mut neighbours = vec![BTreeSet::new(); n];
        for &(i, j) in &pairs {
            neighbours[i as usize].insert(j);
            neighbours[j as usize].insert(i);
        }
        let degree = |i: u32, neighbours: &[BTreeSet<u32>]| neighbours[i as usize].len();
        let mut queue: BinaryHeap<_> = (0..n as u32)
            .map(|i| Reverse((degree(i, &neighbours), i)))
            .collect();
        let (mut order, mut starts, mut rows) = (vec![], vec![0], vec![]);
        let mut rank = vec![usize::MAX; n];
        let mut products = 0;
        while let Some(Reverse((was, i))) = queue.pop() {
            if rank[i as usize] != usize::MAX || was != degree(i, &neighbours) {
                continue;
            }
            rank[i as usize] = order.len();
            order.push(i);
            let later: Vec<u32> = std::mem::take(&mut neighbours[i as usize])
                .into_iter()
                .collect();
            products += later.len() * (later.len() + 3) / 2;
            if products > MOST_PRODUCTS * pairs.len().max(1) {
                return None;
            }
            for &j in &later {
                let of_j = &mut neighbours[j as usize];
                of_j.remove(&i);
                of_j.extend(later.iter().filter(|k| **k != j));
                queue.push(Reverse((degree(j, &neighbours), j)));
            }
            rows.extend(later);
            starts.push(rows.len() as u32);
        }
        // Later rows in the order of their elimination, so that of two the first is the column.
        for k in 0..n {
            rows[starts[k] as usize..starts[k + 1] as usize]
                .sort_unstable_by_key(|row| rank[*row as usize]);
        }
        let find = |i: u32, j: u32| {
            let (column, row) = if rank[i as usize] < rank[j as usize] {
                (i, j)
            } else {
                (j, i)
            };
            let k = rank[column as usize];
            let own = starts[k] as usize..starts[k + 1] as usize;
            let place = own.clone().find(|b| rows[*b] == row);
            place.unwrap_or(own.end) as u32
        };
        let places = pairs.iter().map(|(i, j)| find(*i, *j)).collect();
        let mut targets = vec![];
        for k in 0..n {
            let own = &rows[starts[k] as usize..starts[k + 1] as usize];
            for (first, i) in own.iter().enumerate() {
                targets.extend(own[first + 1..].iter().map(|j| find(*i, *j)));
            }
        }
        Some(Self {
            places,
            blocks: vec![[0.0; 9]; rows.len()],
            diagonal: vec![[0.0; 9]; n],
            unknowns: vec![[0.0; 3]; n],
            products: products as f64,
            size: rows.len() as f64,
            order,
            starts,
            rows,
            targets,
        })
    }

    /// Factorises A. Returns whether it is positive definite.
    pub fn factorise(&mut self, tangent: &Tangent) -> bool {
        self.fill(tangent);
        let mut targets = self.targets.iter();
        for (k, i) in self.order.iter().enumerate() {
            let Some(inverse) = inverse(&self.diagonal[*i as usize]) else {
                return false;
            };
            self.diagonal[*i as usize] = inverse;
            let own = self.starts[k] as usize..self.starts[k + 1] as usize;
            for first in own.clone() {
                let before = self.blocks[first];
                let factor = product(&before, &inverse);
                let row = self.rows[first] as usize;
                subtract_product(&mut self.diagonal[row], &factor, &before);
                for second in first + 1..own.end {
                    if let Some(target) = targets.next() {
                        let other = self.blocks[second];
                        subtract_product(&mut self.blocks[*target as usize], &other, &factor);
                    }
                }
                self.blocks[first] = factor;
            }
        }
        true
    }

    /// Solves A x = b with the factor.
    pub fn solve(&mut self, b: &[f64], x: &mut [f64]) {
        let n = self.unknowns.len();
        for (i, unknowns) in self.unknowns.iter_mut().enumerate() {
            *unknowns = [b[i], b[n + i], b[2 * n + i]];
        }
        for (k, i) in self.order.iter().enumerate() {
            let of_i = self.unknowns[*i as usize];
            for block in self.starts[k] as usize..self.starts[k + 1] as usize {
                let l = &self.blocks[block];
                let row = &mut self.unknowns[self.rows[block] as usize];
                for (axis, row) in row.iter_mut().enumerate() {
                    *row -= l[3 * axis] * of_i[0]
                        + l[3 * axis + 1] * of_i[1]
                        + l[3 * axis + 2] * of_i[2];
                }
            }
        }
        for (k, i) in self.order.iter().enumerate().rev() {
            let (d, r) = (&self.diagonal[*i as usize], self.unknowns[*i as usize]);
            let mut of_i: [f64; 3] = std::array::from_fn(|axis| {
                d[3 * axis] * r[0] + d[3 * axis + 1] * r[1] + d[3 * axis + 2] * r[2]
            });
            for block in self.starts[k] as usize..self.starts[k + 1] as usize {
                let (l, row) = (
                    &self.blocks[block],
                    self.unknowns[self.rows[block] as usize],
                );
                for (axis, of_i) in of_i.iter_mut().enumerate() {
                    *of_i -= l[axis] * row[0] + l[3 + axis] * row[1] + l[6 + axis] * row[2];
                }
            }
            self.unknowns[*i as usize] = of_i;
        }
        for (i, unknowns) in self.unknowns.iter().enumerate() {
            [x[i], x[n + i], x[2 * n + i]] = *unknowns;
        }
    }

    fn fill(&mut self, tangent: &Tangent) {
        for (block, m) in self.diagonal.iter_mut().zip(tangent.masses()) {
            let m = if *m == 0.0 { 1.0 } else { *m };
            *block = [m, 0.0, 0.0, 0.0, m, 0.0, 0.0, 0.0, m];
        }
        self.blocks.fill([0.0; 9]);
        let mut places = self.places.iter();
        tangent.blocks(|i, j, block| {
            let Some(place) = places.next() else { return };
            let turned = transposed(&block);
            let free = |k: usize| tangent.masses()[k] != 0.0;
            for end in [i, j] {
                if free(end) {
                    // The blocks of a particle have a symmetric sum.
                    let halves = block.iter().zip(turned);
                    for (sum, (a, b)) in self.diagonal[end].iter_mut().zip(halves) {
                        *sum += 0.5 * (a + b);
                    }
                }
            }
            if free(i) && free(j) {
                let in_row_of_i = self.rows[*place as usize] as usize == i;
                let block = if in_row_of_i { block } else { turned };
                for (sum, part) in self.blocks[*place as usize].iter_mut().zip(block) {
                    *sum -= part;
                }
            }
        });
    }
}

/// The inverse of a symmetric block, if that is positive definite.
fn inverse([xx, xy, xz, _, yy, yz, _, _, zz]: &Block) -> Option<Block> {
    let minor = xx * yy - xy * xy;
    let (a, b, c) = (yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy);
    let determinant = xx * a + xy * b + xz * c;
    if !(*xx > 0.0 && minor > 0.0 && determinant > 0.0) {
        return None;
    }
    let s = 1.0 / determinant;
    let (d, e, f) = (xx * zz - xz * xz, xy * xz - xx * yz, minor);
    Some([a, b, c, b, d, e, c, e, f].map(|cofactor| cofactor * s))
}

fn transposed(a: &Block) -> Block {
    std::array::from_fn(|k| a[k % 3 * 3 + k / 3])
}

/// a b
fn product(a: &Block, b: &Block) -> Block {
    std::array::from_fn(|k| {
        let (row, column) = (3 * (k / 3), k % 3);
        a[row] * b[column] + a[row + 1] * b[3 + column] + a[row + 2] * b[6 + column]
    })
}

/// c -= a bT
fn subtract_product(c: &mut Block, a: &Block, b: &Block) {
    for (k, c) in c.iter_mut().enumerate() {
        let (row, column) = (3 * (k / 3), 3 * (k % 3));
        *c -= a[row] * b[column] + a[row + 1] * b[column + 1] + a[row + 2] * b[column + 2];
    }
}
