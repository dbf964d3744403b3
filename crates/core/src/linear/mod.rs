//! Linear systems of implicit steps: conjugate gradients or a sparse factorisation, whichever costs less.

mod conjugate_gradients;
mod sparse;
mod tangent;

use conjugate_gradients::ConjugateGradients;
use sparse::Cholesky;
pub(crate) use tangent::Tangent;

use crate::integrators::Work;
use crate::system::Mechanics;

/// Prices in evaluations of the forces, measured on cloth of 20 x 20 to 128 x 128 and on chains (see the tests): of an
/// iteration, ...
const ITERATION: f64 = 2.2;
/// ... of gathering the matrix, ...
const GATHERING: f64 = 5.0;
/// ... of a factorisation, times its operations over the number of couplings to the power 2/3, ...
const FACTORISATION: f64 = 0.48;
/// ... and of a number of the factor in a solve, over the number of couplings.
const ENTRY: f64 = 0.2;
/// Conjugate gradients take about this times sqrt(1 + a2 w2) ln(2/tolerance) iterations.
const SPREAD: f64 = 0.3;
/// Beyond this many iterations something else is wrong.
const MOST: u64 = 10_000;

/// Solves with the tangent of one system.
pub(crate) struct Solver {
    pub tangent: Tangent,
    /// Whether to factorise, whatever it costs: for tests.
    direct_always: Option<bool>,
    iterative: ConjugateGradients,
    direct: Option<Cholesky>,
    scratch: Vec<f64>,
    /// Of what was gathered last: a bound of a2 w2.
    stiffness: f64,
    /// Whether its factor is at hand.
    factorised: bool,
}

impl Solver {
    pub fn new(mechanics: &dyn Mechanics) -> Self {
        let tangent = Tangent::new(mechanics);
        let n = tangent.particles();
        Self {
            iterative: ConjugateGradients::new(n),
            direct: Cholesky::new(&tangent),
            scratch: vec![0.0; n],
            tangent,
            direct_always: None,
            stiffness: 0.0,
            factorised: false,
        }
    }

    /// Gathers A = M + a (C + D) + a2 K at x.
    pub fn gather(&mut self, mechanics: &dyn Mechanics, x: &[f64], a: f64, clamped: bool) -> Work {
        self.tangent.gather(mechanics, x, a, clamped);
        self.stiffness = self.tangent.stiffness(&mut self.scratch);
        self.factorised = false;
        if self.direct.as_ref().is_some_and(|d| !d.fits(&self.tangent)) {
            self.direct = Cholesky::new(&self.tangent);
        }
        Work {
            algebra: GATHERING,
            ..Work::default()
        }
    }

    /// A bound of a2 w2 for the fastest motion: how stiff the step is.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Solves A x = b to a relative residual. `None` if A is not positive definite.
    pub fn solve(&mut self, b: &[f64], x: &mut [f64], tolerance: f64) -> (Work, Option<f64>) {
        let couplings = self.tangent.couplings().len().max(1) as f64;
        let iterations = SPREAD * (1.0 + self.stiffness).sqrt() * libm::log(2.0 / tolerance);
        let prices = self.direct.as_ref().map(|direct| {
            let factor = FACTORISATION * libm::cbrt(direct.operations / couplings).powi(2);
            let solve = ENTRY * direct.size / couplings;
            (if self.factorised { 0.0 } else { factor }, solve)
        });
        let direct_price = prices.map_or(f64::INFINITY, |(factor, solve)| factor + solve);
        let goes_direct = self
            .direct_always
            .unwrap_or(direct_price < ITERATION * iterations);
        match &mut self.direct {
            Some(direct) if goes_direct => {
                let mut work = Work {
                    solves: 1,
                    algebra: direct_price,
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
                let solution = self.iterative.solve(&self.tangent, b, x, tolerance, MOST);
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
