//! Linear systems of implicit steps: conjugate gradients, with multigrid or without, or a
//! factorisation, whichever costs least.

mod conjugate_gradients;
mod damping;
mod multigrid;
mod saddle;
mod tangent;

use conjugate_gradients::{ConjugateGradients, MAX_ITERATIONS};
pub(crate) use damping::DampingSolver;
use multigrid::Multigrid;
use saddle::Direct;
pub(crate) use saddle::Saddle;
pub(crate) use tangent::Tangent;

use crate::products::ITERATION;
use crate::system::Linearized;
use crate::work::Work;

/// Number of iterations of conjugate gradients, over sqrt(1 + a2 w2) ln(2/tolerance). This and the
/// prices below were measured on cloth of 20 x 20 to 128 x 128 particles and on chains (see the
/// tests).
const SPREAD: f64 = 0.3;
/// Prices of an iteration with multigrid and of the preparation of a matrix for it, in evaluations
/// of the system's forces.
const MULTIGRID: [f64; 2] = [5.0, 10.0];
/// Number of iterations with multigrid, over (1 + a2 w2)^(1/4) ln(2/tolerance).
const MULTIGRID_SPREAD: f64 = 0.45;
/// Least number of products of blocks in a factorisation for each coupling of particles in two
/// dimensions, over the root of the number of particles. If even that is too expensive, the pattern
/// is not analysed.
const PLANAR: f64 = 3.0;
/// Solver of linear systems with the tangent of one system.
pub(crate) struct Solver {
    pub tangent: Tangent,
    /// Forces or forbids a factorisation; `None` chooses by cost.
    direct_always: Option<bool>,
    /// Forces or forbids multigrid; `None` chooses by cost.
    multigrid_always: Option<bool>,
    iterative: ConjugateGradients,
    /// Factorisation, once the pattern is analysed; `None` if it would be too large.
    direct: Option<Direct>,
    /// Whether the pattern was analysed.
    analysed: bool,
    /// Coarser levels, once the pattern is analysed for them.
    multigrid: Option<Multigrid>,
    /// Time of an evaluation of the forces spring by spring, over that of the system's own.
    speed: f64,
    /// Bound of a2 w2 for the matrix that was assembled last.
    stiffness: f64,
    /// Whether the matrix that was assembled last is factorised.
    factorised: bool,
}

impl Solver {
    /// Creates a solver with room for the couplings of the system.
    pub fn new(system: &dyn Linearized) -> Self {
        let tangent = Tangent::new(system);
        let n = tangent.particles();
        let mut solver = Self {
            iterative: ConjugateGradients::new(n),
            direct: None,
            analysed: false,
            multigrid: None,
            speed: system.hints().speed,
            tangent,
            direct_always: None,
            multigrid_always: None,
            stiffness: 0.0,
            factorised: false,
        };
        if !system.hints().pattern_is_fixed() {
            (solver.direct_always, solver.multigrid_always) = (Some(false), Some(false));
        } else if solver.least_products() == 0.0 {
            solver.analyse(system);
        }
        solver
    }

    /// Analyses the pattern for a factorisation.
    fn analyse(&mut self, system: &dyn Linearized) {
        self.tangent.list(system);
        self.direct = Direct::new(&self.tangent);
        self.analysed = true;
    }

    /// Returns a lower bound on the number of products in a factorisation for each coupling, known
    /// without an analysis.
    fn least_products(&self) -> f64 {
        let particles = self.tangent.particles() as f64;
        if self.tangent.couplings() as f64 > 1.5 * particles {
            PLANAR * particles.sqrt()
        } else {
            0.0
        }
    }

    /// Updates the costs of the system's forces, after the system has changed.
    pub fn renew(&mut self, system: &dyn Linearized) {
        let hints = system.hints();
        self.speed = hints.speed;
        if !hints.pattern_is_fixed() {
            (self.direct_always, self.multigrid_always) = (Some(false), Some(false));
        }
    }

    /// Assembles A = M + a (C + D) + a2 K at time t (s) at x, for steps of length a (s).
    pub fn assemble(
        &mut self,
        system: &dyn Linearized,
        (t, a): (f64, f64),
        x: &[f64],
        clamped: bool,
    ) -> Work {
        self.tangent.assemble(system, (t, a), x, clamped);
        self.stiffness = self.tangent.stiffness();
        self.factorised = false;
        if self.direct.as_ref().is_some_and(|d| !d.fits(&self.tangent)) {
            (self.direct, self.analysed) = (None, false);
        }
        Work { algebra: system.hints().assembly, ..Work::default() }
    }

    /// Returns the stiffness of the step: an upper bound on a2 w2 for the fastest motion.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Returns the prices of a solve by conjugate gradients to a relative residual, without and
    /// with multigrid, in evaluations of the forces.
    fn prices(&self, tolerance: f64) -> [f64; 2] {
        let spread = (1.0 + self.stiffness).sqrt();
        let digits = libm::log(2.0 / tolerance);
        let [iteration, matrix] = MULTIGRID;
        let alone = ITERATION * SPREAD * spread * digits;
        let with = matrix + iteration * MULTIGRID_SPREAD * spread.sqrt() * digits;
        match self.multigrid_always {
            Some(true) => [f64::INFINITY, with],
            Some(false) => [alone, f64::INFINITY],
            None => [alone, with],
        }
    }

    /// Returns whether a solve to a relative residual is cheaper by a factorisation than by
    /// conjugate gradients. Analyses the pattern if it may be.
    fn goes_direct(&mut self, system: &dyn Linearized, tolerance: f64) -> bool {
        let [alone, with] = self.prices(tolerance);
        let iterative = alone.min(with);
        let least = saddle::price_of_products(self.least_products());
        let worth_analysing = self.factorised || least * self.speed < iterative;
        if self.direct_always.unwrap_or(worth_analysing) && !self.analysed {
            self.analyse(system);
        }
        let price = self.direct.as_ref().map_or(f64::INFINITY, |direct| {
            let factorisation = if self.factorised { 0.0 } else { direct.factorisation };
            factorisation + direct.solution
        });
        self.direct_always.unwrap_or(worth_analysing && price * self.speed < iterative)
    }

    /// Factorises A, or prepares it for multigrid, if that makes a solve to a relative residual
    /// cheaper. Returns the work, and whether A may be positive definite.
    pub fn prepare(&mut self, system: &dyn Linearized, tolerance: f64) -> (Work, bool) {
        let mut work = Work::default();
        if self.goes_direct(system, tolerance) {
            self.tangent.list(system);
            if self.direct.as_ref().is_some_and(|d| !d.fits(&self.tangent)) {
                self.analyse(system);
            }
            if let Some(direct) = &mut self.direct
                && !self.factorised
            {
                self.factorised = direct.factorise(&self.tangent);
                work.factorizations = 1;
                work.algebra = direct.factorisation * self.speed;
                return (work, self.factorised);
            }
        } else if self.goes_multigrid(tolerance) {
            self.tangent.list(system);
            let fits = self.multigrid.take().filter(|m| m.fits(&self.tangent));
            let used = fits.unwrap_or_else(|| Multigrid::new(&self.tangent));
            if self.multigrid.insert(used).prepare(&self.tangent) {
                work.algebra = MULTIGRID[1];
            }
        }
        (work, true)
    }

    fn goes_multigrid(&self, tolerance: f64) -> bool {
        let [alone, with] = self.prices(tolerance);
        with < alone
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
        let (mut work, may_be_definite) = self.prepare(system, tolerance);
        work.solves = 1;
        if !may_be_definite {
            return (work, None);
        }
        match &mut self.direct {
            Some(direct) if self.factorised => {
                work.algebra += direct.solution * self.speed;
                direct.solve(b, x);
                (work, Some(0.0))
            }
            _ => {
                let pays = self.goes_multigrid(tolerance);
                let mut solve = |multigrid: Option<&mut Multigrid>, price: f64| {
                    let (matrix, ends) = ((&self.tangent, multigrid), (tolerance, MAX_ITERATIONS));
                    let solution = self.iterative.solve(system, matrix, b, x, ends);
                    work.iterations += solution.iterations;
                    work.algebra += price * solution.iterations as f64;
                    solution
                };
                let with = self.multigrid.as_mut().filter(|_| pays);
                let with = with.map(|multigrid| solve(Some(multigrid), MULTIGRID[0]));
                // The preconditioner of multigrid need not be positive definite where the matrix
                // is.
                let solution = match with {
                    Some(solution) if !solution.indefinite => solution,
                    _ => solve(None, ITERATION),
                };
                if !solution.indefinite {
                    work.residual = solution.residual;
                }
                (work, (!solution.indefinite).then_some(solution.residual))
            }
        }
    }
}

#[cfg(test)]
mod tests;
