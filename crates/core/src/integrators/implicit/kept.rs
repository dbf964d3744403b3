//! Simplified Newton's method: the tangent is formed at one state and kept, over iterations and
//! steps, as long as the iterations converge with it; a Jacobian is kept over steps of other
//! lengths, too (Hairer, Wanner, *Solving Ordinary Differential Equations II*, 1996, IV.8).
//! Iterations end when, by their rate of convergence, the remaining error is a small part of the
//! allowed error of a step.

use super::super::error_norm::ErrorNorm;
use super::super::sweep::add_scaled;
use super::jacobian::Jacobian;
use super::mechanical::Mechanical;
use super::newton::Newton;
use super::stage::StageSolver;
use crate::system::{Linearized, Mechanics, ParticleSystem};
use crate::work::Work;

/// Part of the allowed error that may remain in the equations.
const ERROR_SHARE: f64 = 0.1;
/// Largest number of iterations with one tangent.
const MAX_ITERATIONS: i32 = 4;
/// Relative residual of an iterative linear solve: less than the error that an iteration of
/// Newton's method leaves.
const FORCING: f64 = 0.02;
/// Kept tangent: where it was formed, and how fast the iterations converge with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct KeptTangent {
    /// Time at which it was formed (s).
    pub t: f64,
    /// Factor a of the equations y = base + a f(t, y) (s); 0 before one is formed.
    pub a: f64,
    /// The factor for which it was formed: a Jacobian serves others too.
    pub formed: f64,
    /// Whether compressed springs are clamped in it.
    pub clamped: bool,
    /// Ratio of consecutive changes in the iteration.
    pub rate: f64,
}

impl KeptTangent {
    /// No tangent.
    pub const NONE: Self = Self { t: 0.0, a: 0.0, formed: 0.0, clamped: false, rate: 1.0 };
}

/// Reason why a solve with the kept tangent failed.
enum SolveFailure {
    /// The tangent is not positive definite.
    Indefinite,
    /// The iterations do not converge.
    Diverges,
}

/// Solver of implicit stages that keeps its tangent.
pub(super) struct KeptSolver {
    stage: StageSolver,
    pub tangent: KeptTangent,
    /// State at which the tangent was formed.
    pub at: Vec<f64>,
    /// Change of the state by an iteration.
    change: Vec<f64>,
}

impl KeptSolver {
    pub fn new(system: &dyn ParticleSystem) -> Self {
        Self {
            stage: StageSolver::new(system),
            tangent: KeptTangent::NONE,
            at: vec![0.0; system.dim()],
            change: vec![0.0; system.dim()],
        }
    }

    /// Returns the Jacobian of f, if the stages are solved by it.
    pub fn jacobian(&self) -> Option<&Jacobian> {
        match &self.stage {
            StageSolver::Mechanical(_) => None,
            StageSolver::Dense(stage) => Some(&stage.jacobian),
        }
    }

    /// Returns the same, to be formed elsewhere.
    pub fn jacobian_mut(&mut self) -> Option<&mut Jacobian> {
        match &mut self.stage {
            StageSolver::Mechanical(_) => None,
            StageSolver::Dense(stage) => Some(&mut stage.jacobian),
        }
    }

    /// Restores the pattern of the Jacobian. Returns false if it is of another system.
    pub fn set_pattern(&mut self, pattern: &[usize]) -> bool {
        match &mut self.stage {
            StageSolver::Mechanical(_) => pattern.is_empty(),
            StageSolver::Dense(stage) => stage.jacobian.set_pattern(pattern),
        }
    }

    /// Forgets the tangent, because the system may have changed.
    pub fn forget(&mut self, system: &dyn ParticleSystem) {
        self.tangent = KeptTangent::NONE;
        match (&mut self.stage, linearized(system)) {
            (StageSolver::Mechanical(stage), Some(linearized)) => stage.solver.renew(linearized),
            (StageSolver::Dense(stage), _) => stage.jacobian.forget(),
            (StageSolver::Mechanical(_), None) => (),
        }
    }

    /// Solves y = base + a f(t, y), starting from the state `predicted`, with the kept tangent or a
    /// new one. Returns the cost, and whether that succeeded.
    pub fn solve(
        &mut self,
        system: &dyn ParticleSystem,
        (t, a): (f64, f64),
        [base, predicted]: [&[f64]; 2],
        y: &mut [f64],
        norm: &ErrorNorm,
    ) -> (Work, bool) {
        let mut work = Work::default();
        let mut fresh = self.tangent.a.to_bits() != a.to_bits();
        if let StageSolver::Dense(stage) = &mut self.stage
            && fresh
            && self.tangent.a != 0.0
        {
            let (cost, of_use) = stage.factorise(a);
            work += cost;
            (self.tangent.a, self.tangent.rate) = (a, 1.0);
            fresh = !of_use;
        }
        let mut clamped = false;
        loop {
            y.copy_from_slice(predicted);
            system.hold(t, y);
            let mut solved = Ok(());
            if fresh {
                self.at.copy_from_slice(y);
                self.tangent = KeptTangent { t, a, formed: a, clamped, rate: 1.0 };
                let (cost, of_use) = self.form(system);
                work += cost;
                if !of_use {
                    solved = Err(SolveFailure::Indefinite);
                }
            }
            if solved.is_ok() {
                let (cost, converged) = self.converge(system, (t, a), base, y, norm);
                work += cost;
                solved = converged;
            }
            match solved {
                Ok(()) => {
                    self.project(system, y);
                    return (work, true);
                }
                Err(SolveFailure::Indefinite) if !self.tangent.clamped => clamped = true,
                Err(SolveFailure::Diverges) if !fresh => (),
                Err(_) => {
                    self.tangent = KeptTangent::NONE;
                    return (work, false);
                }
            }
            fresh = true;
        }
    }

    /// Moves a state to where all constraints are met and stay so.
    pub fn project(&self, system: &dyn ParticleSystem, y: &mut [f64]) {
        self.stage.project(system, y);
    }

    /// Forms the tangent where it was formed before. Returns the cost, and whether it is positive
    /// definite.
    pub fn form(&mut self, system: &dyn ParticleSystem) -> (Work, bool) {
        let KeptTangent { t, a, formed, clamped, .. } = self.tangent;
        match (&mut self.stage, linearized(system)) {
            (StageSolver::Mechanical(stage), Some(linearized)) => {
                let (x, v) = self.at.split_at(self.at.len() / 2);
                let mut work = stage.begin(linearized, (t, a), [x, v]);
                let (cost, of_use) = stage.assemble(linearized, (t, a), x, clamped);
                work += cost;
                if stage.joined.is_some() {
                    return (work, of_use);
                }
                let (cost, of_use) = stage.solver.prepare(linearized, FORCING);
                work += cost;
                (work, of_use)
            }
            (StageSolver::Dense(stage), _) => stage.keep(system, t, [formed, a], &self.at),
            (StageSolver::Mechanical(_), None) => (Work::default(), false),
        }
    }

    /// Iterates until the equations are solved. Returns the cost.
    fn converge(
        &mut self,
        system: &dyn ParticleSystem,
        (t, a): (f64, f64),
        base: &[f64],
        y: &mut [f64],
        norm: &ErrorNorm,
    ) -> (Work, Result<(), SolveFailure>) {
        let mut work = Work::default();
        let mut last: Option<f64> = None;
        if let StageSolver::Mechanical(stage) = &mut self.stage
            && let Some(joined) = &mut stage.joined
        {
            joined.restart();
        }
        let rate = &mut self.tangent.rate;
        for left in (0..MAX_ITERATIONS).rev() {
            let (cost, solved) = match (&mut self.stage, linearized(system)) {
                (StageSolver::Mechanical(stage), Some(linearized)) => {
                    stage.correct(linearized, (t, a), base, y, &mut self.change)
                }
                (StageSolver::Dense(stage), _) => {
                    let work = stage.correct(system, t, a, base, y);
                    self.change.copy_from_slice(stage.change());
                    (work, true)
                }
                (StageSolver::Mechanical(_), None) => (Work::default(), false),
            };
            work += cost;
            if !solved {
                return (work, Err(SolveFailure::Indefinite));
            }
            let size = norm.of(y, y, &self.change);
            if let Some(last) = last {
                let found = if last > 0.0 { size / last } else { 0.0 };
                // NaN counts as divergence.
                if !(found < 1.0 && size * found.powi(left) <= ERROR_SHARE * (1.0 - found)) {
                    break;
                }
                *rate = found.max(0.3 * *rate);
            }
            if size * (*rate / (1.0 - *rate)).min(1.0) <= ERROR_SHARE {
                return (work, Ok(()));
            }
            last = Some(size);
        }
        (work, Err(SolveFailure::Diverges))
    }
}

/// Returns the linearised view of a system with forces and masses, if it offers one.
fn linearized(system: &dyn ParticleSystem) -> Option<&dyn Linearized> {
    system.mechanics().and_then(Mechanics::linearized)
}

impl Mechanical {
    /// Makes one iteration: adds its change to y. Returns the cost, and whether the linear system
    /// was solved.
    fn correct(
        &mut self,
        mechanics: &dyn Linearized,
        (t, a): (f64, f64),
        base: &[f64],
        y: &mut [f64],
        change: &mut [f64],
    ) -> (Work, bool) {
        let (bx, bv) = base.split_at(base.len() / 2);
        let (x, v) = y.split_at(bx.len());
        let mut work = self.evaluate(mechanics, t, a, bx, [x, v], Newton::Full);
        self.reduce(mechanics, a, bv, v);
        let (dx, dv) = change.split_at_mut(bx.len());
        let (cost, solved) = self.solve_linear(mechanics, FORCING);
        dv.copy_from_slice(&self.dv);
        work += cost;
        for ((dx, gap), dv) in dx.iter_mut().zip(&self.gap).zip(dv) {
            *dx = gap + a * *dv;
        }
        add_scaled(y, 1.0, change);
        (work, solved.is_some())
    }
}
