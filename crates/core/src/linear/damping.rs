//! Linear systems of implicit damping, (M + a C) k = b, by conjugate gradients.
//!
//! They begin at the solution without damping, k = b / M, and are preconditioned by the masses.
//! Where damping acts along the lines between particles, C takes no part in translations and
//! rotations of the whole, and so neither do the residual and the iterates: momentum and angular
//! momentum are those of b to rounding, however few the iterations.

use super::conjugate_gradients::{ConjugateGradients, MAX_ITERATIONS};
use super::tangent::Tangent;
use crate::error::Error;
use crate::sums::dot;
use crate::system::Linearized;
use crate::work::Work;

/// Largest residual relative to b, where a step is longer than the time scale of the damping. For
/// shorter steps it falls as their third power, so that errors keep the method's order in the step.
const TOLERANCE: f64 = 1e-6;
/// Ratio of a step to the time scale of the damping below which the residual falls no more.
const MIN_RATIO: f64 = 0.01;

/// Solver of linear systems with the damping of one system.
pub(crate) struct DampingSolver {
    tangent: Tangent,
    iterative: ConjugateGradients,
    /// Residual of k = b / M, and the change of k that it takes.
    residual: Vec<f64>,
    change: Vec<f64>,
}

impl DampingSolver {
    /// Creates a solver with room for the couplings of the system.
    pub fn new(system: &dyn Linearized) -> Self {
        let tangent = Tangent::of_damping(system);
        let n = tangent.particles();
        Self {
            tangent,
            iterative: ConjugateGradients::new(n),
            residual: vec![0.0; 3 * n],
            change: vec![0.0; 3 * n],
        }
    }

    /// Assembles M + a C at time t (s) at x.
    pub fn assemble(&mut self, system: &dyn Linearized, (t, a): (f64, f64), x: &[f64]) -> Work {
        self.tangent.assemble(system, (t, a), x, true);
        Work { algebra: system.hints().assembly, ..Work::default() }
    }

    /// Solves (M + a C) k = b. Pinned particles are filtered out: b and k become 0 there.
    ///
    /// # Errors
    /// The iterations do not converge.
    pub fn solve(
        &mut self,
        system: &dyn Linearized,
        b: &mut [f64],
        k: &mut [f64],
    ) -> Result<Work, Error> {
        let Self { tangent, iterative, residual, change } = self;
        tangent.filter(b);
        let masses = tangent.masses();
        for (k, b) in k.chunks_exact_mut(masses.len()).zip(b.chunks_exact(masses.len())) {
            for ((k, b), m) in k.iter_mut().zip(b).zip(masses) {
                *k = if *m == 0.0 { 0.0 } else { b / m };
            }
        }
        tangent.product(system, k, residual);
        for (residual, b) in residual.iter_mut().zip(&*b) {
            *residual = b - *residual;
        }
        let ratio = (0.5 * tangent.stiffness()).clamp(MIN_RATIO, 1.0);
        let tolerance = TOLERANCE * ratio.powi(3) * (dot(b, b) / dot(residual, residual)).sqrt();
        let price = system.hints().iteration;
        let mut work = Work { solves: 1, algebra: price, ..Work::default() };
        if tolerance < 1.0 {
            let (matrix, ends) = ((&*tangent, None), (tolerance, MAX_ITERATIONS));
            let solution = iterative.solve(system, matrix, residual, change, ends);
            if solution.indefinite || solution.residual > tolerance {
                let residual = solution.residual;
                return Err(Error::NoConvergence { residual });
            }
            for (k, change) in k.iter_mut().zip(&*change) {
                *k += change;
            }
            work.iterations = solution.iterations;
            work.algebra += price * solution.iterations as f64;
        }
        Ok(work)
    }
}
