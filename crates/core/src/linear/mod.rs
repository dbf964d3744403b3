//! Linear systems of implicit steps: conjugate gradients or a sparse factorisation, whichever costs less.

mod conjugate_gradients;
mod sparse;
mod tangent;

use conjugate_gradients::ConjugateGradients;
use sparse::Cholesky;
pub(crate) use tangent::Tangent;

use crate::integrators::Work;
use crate::system::Mechanics;

/// Prices measured on cloth of 20 x 20 to 128 x 128 and on chains (see the tests): of an iteration, in evaluations of the
/// system's forces; ...
const ITERATION: f64 = 2.4;
/// ... in evaluations of forces that are found spring by spring, of gathering the matrix, ...
const GATHERING: f64 = 4.0;
/// ... of a factorisation: the least, and that of its operations over the number of couplings to the power 2/3; ...
const FACTORISATION: [f64; 2] = [45.0, 0.33];
/// ... and of a solve with its factor: the least, and that of its numbers over the number of couplings.
const SOLVE: [f64; 2] = [6.0, 0.2];
/// Conjugate gradients take about this times sqrt(1 + a2 w2) ln(2/tolerance) iterations.
const SPREAD: f64 = 0.3;
/// A factorisation of what is knit in two dimensions takes at least so many operations for each coupling, times the root
/// of the number of particles: no need to look closer where that is too dear.
const KNIT: f64 = 150.0;
/// Beyond this many iterations something else is wrong.
const MOST: u64 = 10_000;

/// Solves with the tangent of one system.
pub(crate) struct Solver {
    pub tangent: Tangent,
    /// Whether to factorise, whatever it costs: for tests.
    direct_always: Option<bool>,
    iterative: ConjugateGradients,
    /// Made when it is first worth a look; `None` also if it would be too large.
    direct: Option<Cholesky>,
    looked: bool,
    /// Evaluations of these forces for one that is found spring by spring.
    speed: f64,
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
        let mut solver = Self {
            iterative: ConjugateGradients::new(n),
            direct: None,
            looked: false,
            speed: mechanics.speed(),
            scratch: vec![0.0; n],
            tangent,
            direct_always: None,
            stiffness: 0.0,
            factorised: false,
        };
        if solver.least_operations() == 0.0 {
            solver.look();
        }
        solver
    }

    /// Analyses the pattern for a factorisation.
    fn look(&mut self) {
        self.direct = Cholesky::new(&self.tangent);
        self.looked = true;
    }

    /// Of a factorisation, for each coupling, as far as one can tell beforehand.
    fn least_operations(&self) -> f64 {
        let particles = self.tangent.particles() as f64;
        if self.tangent.couplings().len() as f64 > 1.5 * particles {
            KNIT * particles.sqrt()
        } else {
            0.0
        }
    }

    /// Gathers A = M + a (C + D) + a2 K at x.
    pub fn gather(&mut self, mechanics: &dyn Mechanics, x: &[f64], a: f64, clamped: bool) -> Work {
        self.tangent.gather(mechanics, x, a, clamped);
        self.stiffness = self.tangent.stiffness(&mut self.scratch);
        self.factorised = false;
        if self.direct.as_ref().is_some_and(|d| !d.fits(&self.tangent)) {
            (self.direct, self.looked) = (None, false);
        }
        Work {
            algebra: GATHERING * self.speed,
            ..Work::default()
        }
    }

    /// A bound of a2 w2 for the fastest motion: how stiff the step is.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Solves A x = b to a relative residual. `None` if A is not positive definite.
    pub fn solve(
        &mut self,
        mechanics: &dyn Mechanics,
        b: &[f64],
        x: &mut [f64],
        tolerance: f64,
    ) -> (Work, Option<f64>) {
        let couplings = self.tangent.couplings().len().max(1) as f64;
        let iterations = SPREAD * (1.0 + self.stiffness).sqrt() * libm::log(2.0 / tolerance);
        let factoring =
            |operations: f64| FACTORISATION[0] + FACTORISATION[1] * libm::cbrt(operations).powi(2);
        let worth_a_look = self.factorised
            || factoring(self.least_operations()) * self.speed < ITERATION * iterations;
        if self.direct_always.unwrap_or(worth_a_look) && !self.looked {
            self.look();
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
            .unwrap_or(worth_a_look && direct_price * self.speed < ITERATION * iterations);
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
                let solution =
                    self.iterative
                        .solve(mechanics, &self.tangent, b, x, tolerance, MOST);
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
