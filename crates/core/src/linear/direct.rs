//! The factorisation of a matrix by whichever of two kinds serves its pattern, with its price.

use super::blocks::BlockCholesky;
use super::sparse::Cholesky;
use super::tangent::Tangent;

/// Price of a factorisation by blocks, in evaluations of forces spring by spring: that of its
/// products of blocks over the number of couplings. Measured on chains, see the tests.
const BLOCK_PRODUCT: f64 = 6.5;
/// Price of a solve by blocks, in evaluations of forces spring by spring: that of the factor's
/// blocks over the number of couplings.
const BLOCK_SOLVE: f64 = 4.2;
/// Number of couplings in the time that an evaluation takes beside its couplings: in relation to
/// it, the algebra of a few couplings costs less than that of many.
const OVERHEAD: f64 = 10.0;
/// Price of a sparse factorisation, in evaluations of forces spring by spring: the least, and that
/// of its operations over the number of couplings to the power 2/3.
const SPARSE_FACTORISATION: [f64; 2] = [45.0, 0.33];
/// Price of a solve with a sparse factor, in evaluations of forces spring by spring: the least, and
/// that of its numbers over the number of couplings.
const SPARSE_SOLVE: [f64; 2] = [6.0, 0.2];

/// Price of a sparse factorisation of so many operations for each coupling, in evaluations of
/// forces spring by spring.
pub(super) fn sparse_factorisation(operations: f64) -> f64 {
    SPARSE_FACTORISATION[0] + SPARSE_FACTORISATION[1] * libm::cbrt(operations).powi(2)
}

/// Factorisation of a matrix whose pattern was analysed.
pub(super) struct Direct {
    factor: Factor,
    pattern: u64,
    /// Price of a factorisation, in evaluations of forces spring by spring.
    pub factorisation: f64,
    /// Price of a solve with the factor, in evaluations of forces spring by spring.
    pub solution: f64,
}

enum Factor {
    /// Factor of a chain, a tree, or of another pattern that it hardly fills.
    Blocks(Box<BlockCholesky>),
    /// Factor of any other pattern.
    Sparse(Box<Cholesky>),
}

impl Direct {
    /// The pattern of a tangent; `None` if the factor takes more memory than there is.
    pub fn new(tangent: &Tangent) -> Option<Self> {
        let couplings = tangent.couplings().max(1) as f64;
        let pattern = tangent.pattern();
        if let Some(blocks) = BlockCholesky::new(tangent) {
            return Some(Self {
                factorisation: BLOCK_PRODUCT * blocks.products / (couplings + OVERHEAD),
                solution: BLOCK_SOLVE * blocks.size / (couplings + OVERHEAD),
                pattern,
                factor: Factor::Blocks(Box::new(blocks)),
            });
        }
        let sparse = Cholesky::new(tangent)?;
        Some(Self {
            factorisation: sparse_factorisation(sparse.operations / couplings),
            solution: SPARSE_SOLVE[0] + SPARSE_SOLVE[1] * sparse.size / couplings,
            pattern,
            factor: Factor::Sparse(Box::new(sparse)),
        })
    }

    /// Whether the matrix is factorised by blocks.
    #[cfg(test)]
    pub fn is_by_blocks(&self) -> bool {
        matches!(self.factor, Factor::Blocks(_))
    }

    /// Whether the couplings are still those of the pattern.
    pub fn fits(&self, tangent: &Tangent) -> bool {
        self.pattern == tangent.pattern()
    }

    /// Factorises A. Returns whether it is positive definite.
    pub fn factorise(&mut self, tangent: &Tangent) -> bool {
        match &mut self.factor {
            Factor::Blocks(blocks) => blocks.factorise(tangent),
            Factor::Sparse(sparse) => sparse.factorise(tangent),
        }
    }

    /// Solves A x = b with the factor.
    pub fn solve(&mut self, b: &[f64], x: &mut [f64]) {
        match &mut self.factor {
            Factor::Blocks(blocks) => blocks.solve(b, x),
            Factor::Sparse(sparse) => sparse.solve(b, x),
        }
    }
}
