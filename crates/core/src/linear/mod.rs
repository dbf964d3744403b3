//! Linear systems of implicit steps: conjugate gradients or a sparse factorisation, whichever costs
//! less.

mod conjugate_gradients;
mod sparse;
mod tangent;

use conjugate_gradients::ConjugateGradients;
use sparse::Cholesky;
pub(crate) use tangent::Tangent;

use crate::system::Linearized;
use crate::work::Work;

/// Price of an iteration of conjugate gradients, in evaluations of the system's forces. It and the
/// prices below were measured on cloth of 20 x 20 to 128 x 128 particles and on chains (see the
/// tests).
const ITERATION: f64 = 2.4;
/// Price of gathering the matrix, in evaluations of forces spring by spring.
const GATHERING: f64 = 4.0;
/// Price of a factorisation, in evaluations of forces spring by spring: the least, and that of its
/// operations over the number of couplings to the power 2/3.
const FACTORISATION: [f64; 2] = [45.0, 0.33];
/// Price of a solve with a factor, in evaluations of forces spring by spring: the least, and that
/// of its numbers over the number of couplings.
const SOLVE: [f64; 2] = [6.0, 0.2];
/// Iterations that conjugate gradients take, over sqrt(1 + a2 w2) ln(2/tolerance).
const SPREAD: f64 = 0.3;
/// Least operations of a factorisation for each coupling of particles in two dimensions, over the
/// root of their number: no need to analyse the pattern where that is too dear.
const PLANAR: f64 = 150.0;
/// Largest number of iterations.
const MOST: u64 = 10_000;

/// Solver of linear systems with the tangent of one system.
pub(crate) struct Solver {
    pub tangent: Tangent,
    /// Whether to factorise at any price: for tests.
    direct_always: Option<bool>,
    iterative: ConjugateGradients,
    /// The factorisation, once it is worth an analysis of the pattern; `None` also if it would be
    /// too large.
    direct: Option<Cholesky>,
    /// Whether the pattern was analysed.
    analysed: bool,
    /// Evaluations of the system's forces in the time of one spring by spring.
    speed: f64,
    scratch: Vec<f64>,
    /// Bound of a2 w2 for the matrix that was gathered last.
    stiffness: f64,
    /// Whether the matrix that was gathered last is factorised.
    factorised: bool,
}

impl Solver {
    /// A solver with room for the couplings of the system.
    pub fn new(system: &dyn Linearized) -> Self {
        let tangent = Tangent::new(system);
        let n = tangent.particles();
        let mut solver = Self {
            iterative: ConjugateGradients::new(n),
            direct: None,
            analysed: false,
            speed: system.speed(),
            scratch: vec![0.0; n],
            tangent,
            direct_always: None,
            stiffness: 0.0,
            factorised: false,
        };
        if solver.least_operations() == 0.0 {
            solver.analyse();
        }
        solver
    }

    /// Analyses the pattern for a factorisation.
    fn analyse(&mut self) {
        self.direct = Cholesky::new(&self.tangent);
        self.analysed = true;
    }

    /// Least number of operations of a factorisation for each coupling, as far as it is known
    /// beforehand.
    fn least_operations(&self) -> f64 {
        let particles = self.tangent.particles() as f64;
        if self.tangent.couplings() as f64 > 1.5 * particles {
            PLANAR * particles.sqrt()
        } else {
            0.0
        }
    }

    /// Gathers A = M + a (C + D) + a2 K at x.
    pub fn gather(&mut self, system: &dyn Linearized, x: &[f64], a: f64, clamped: bool) -> Work {
        self.tangent.gather(system, x, a, clamped);
        self.stiffness = self.tangent.stiffness(&mut self.scratch);
        self.factorised = false;
        if self.direct.as_ref().is_some_and(|d| !d.fits(&self.tangent)) {
            (self.direct, self.analysed) = (None, false);
        }
        Work {
            algebra: GATHERING * self.speed,
            ..Work::default()
        }
    }

    /// Bound of a2 w2 for the fastest motion: the stiffness of the step.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Solves A x = b to a relative residual. Returns the work and the residual; `None` if A is not
    /// positive definite.
    pub fn solve(
        &mut self,
        system: &dyn Linearized,
        b: &[f64],
        x: &mut [f64],
        tolerance: f64,
    ) -> (Work, Option<f64>) {
        let couplings = self.tangent.couplings().max(1) as f64;
        let iterations = SPREAD * (1.0 + self.stiffness).sqrt() * libm::log(2.0 / tolerance);
        let factoring =
            |operations: f64| FACTORISATION[0] + FACTORISATION[1] * libm::cbrt(operations).powi(2);
        let worth_analysing = self.factorised
            || factoring(self.least_operations()) * self.speed < ITERATION * iterations;
        if self.direct_always.unwrap_or(worth_analysing) && !self.analysed {
            self.analyse();
        }
        let direct_price = self.direct.as_ref().map_or(f64::INFINITY, |direct| {
            let solve = SOLVE[0] + SOLVE[1] * direct.size / couplings;
            if self.factorised {
                solve
            } else {
                factoring(direct.operations / couplings) + solve
            }
        });
        let goes_direct = self
            .direct_always
            .unwrap_or(worth_analysing && direct_price * self.speed < ITERATION * iterations);
        match &mut self.direct {
            Some(direct) if goes_direct => {
                let mut work = Work {
                    solves: 1,
                    algebra: direct_price * self.speed,
                    ..Work::default()
                };
                if !self.factorised {
                    work.factorizations = 1;
                    if !direct.factorise(&self.tangent) {
                        return (work, None);
                    }
                    self.factorised = true;
                }
                direct.solve(b, x);
                (work, Some(0.0))
            }
            _ => {
                let solution = self
                    .iterative
                    .solve(system, &self.tangent, b, x, tolerance, MOST);
                let work = Work {
                    solves: 1,
                    iterations: solution.iterations,
                    algebra: ITERATION * solution.iterations as f64,
                    residual: if solution.indefinite {
                        0.0
                    } else {
                        solution.residual
                    },
                    ..Work::default()
                };
                (work, (!solution.indefinite).then_some(solution.residual))
            }
        }
    }
}

#[cfg(test)]
mod tests;
