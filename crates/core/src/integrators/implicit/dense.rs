//! Implicit stages of a system without masses, or of rigid bodies, by Newton's method with
//! the Jacobian J of f.

use super::jacobian::Jacobian;
use super::lu::Lu;
use super::newton::{Changes, NOISE, Newton, TOLERANCE};
use crate::error::Error;
use crate::integrators::integrator::check_dim;
use crate::integrators::sweep::{add_scaled, scaled_sum};
use crate::refusal::Refusal;
use crate::system::{ParticleSystem, rigid_of};
use crate::work::Work;

/// Largest number of times that a correction is halved.
const MAX_HALVINGS: usize = 8;

/// Solver of the implicit stages of such a system, with its scratch. Particles on rigid bodies
/// stay as they are.
pub(crate) struct Dense {
    pub(super) jacobian: Jacobian,
    /// Factors of M - a J.
    factors: Lu<f64>,
    /// Change of the unknowns, and of the whole state.
    solution: Vec<f64>,
    change: Vec<f64>,
    /// Last correction of the whole state.
    last: Vec<f64>,
    f: Vec<f64>,
    /// State at the beginning of a step, or after the first iteration.
    pub(super) begun: Vec<f64>,
    /// Work of the solutions that failed.
    pub(super) spent: Work,
}

impl Dense {
    pub fn new(system: &dyn ParticleSystem) -> Self {
        let jacobian = Jacobian::new(system);
        let order = jacobian.order();
        Self {
            jacobian,
            factors: Lu::new(order),
            solution: vec![0.0; order],
            change: vec![0.0; system.dim()],
            last: vec![0.0; system.dim()],
            f: vec![0.0; system.dim()],
            begun: vec![0.0; system.dim()],
            spent: Work::default(),
        }
    }

    /// Solves y = base + a f(t, y), starting from the guess y.
    pub(super) fn solve(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        a: f64,
        base: &[f64],
        y: &mut [f64],
        newton: Newton,
    ) -> Result<Work, Error> {
        check_dim(self.f.len(), y)?;
        if !self.jacobian.mass.is_empty() {
            return Err(Error::Unsupported {
                method: "a step of a given length",
                why: Refusal::HasMassMatrix,
            });
        }
        let mut work = Work::default();
        let mut changes = Changes::new(true);
        let mut is_begun = false;
        // Whether the state after the first iteration is kept.
        let mut is_kept = false;
        for _ in 0..newton.most() {
            system.eval_f(t, y, &mut self.f);
            work += Work::of(1);
            let mut fits = false;
            if is_begun {
                let (cost, change) = self.shorten(system, t, (a, base), y, &changes);
                work += cost;
                fits = changes.shrink_to(change) && changes.shrink_fast() != Some(false);
            }
            if !fits {
                let (formed, of_use) = self.keep(system, t, [a, a], y);
                work += formed;
                if !of_use {
                    break;
                }
                work += self.solve_linear(a, base, y);
            }
            is_begun = true;
            add_scaled(y, 1.0, &self.change);
            self.last.copy_from_slice(&self.change);
            let change = self.jacobian.norm(&self.change);
            // Where bodies are does not matter.
            let size = match rigid_of(system) {
                Some(_) => (self.solution.len() as f64).sqrt(),
                None => self.jacobian.norm(y),
            };
            changes.add(change, [size, TOLERANCE * size], 0.0);
            if changes.are_over(NOISE) {
                return Ok(work);
            }
            if newton == Newton::Once && !is_kept {
                self.begun.copy_from_slice(y);
                is_kept = true;
            }
            if !changes.are_finite() {
                break;
            }
        }
        if is_kept {
            y.copy_from_slice(&self.begun);
            return Ok(work);
        }
        self.spent += work;
        self.jacobian.check()?;
        Err(changes.failure())
    }

    /// Shortens the last correction of y, where f is known, while the next one by the same factors
    /// is larger: the iteration would lead away, perhaps to another solution (the natural
    /// monotonicity test: Deuflhard, *Newton methods for nonlinear problems*, 2004). Returns the
    /// cost, and the size of the next correction, which it does not make.
    fn shorten(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        (a, base): (f64, &[f64]),
        y: &mut [f64],
        changes: &Changes,
    ) -> (Work, f64) {
        let mut work = self.solve_linear(a, base, y);
        let mut next = self.jacobian.norm(&self.change);
        for _ in 0..MAX_HALVINGS {
            if !changes.overshoot(next) {
                break;
            }
            self.last.iter_mut().for_each(|last| *last *= 0.5);
            add_scaled(y, -1.0, &self.last);
            system.eval_f(t, y, &mut self.f);
            work += Work::of(1);
            work += self.solve_linear(a, base, y);
            next = self.jacobian.norm(&self.change);
        }
        (work, next)
    }

    /// Adds the solution of (M - a J) change = M (base - y) + a f(t, y) to y, by the factors.
    pub fn correct(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        a: f64,
        base: &[f64],
        y: &mut [f64],
    ) -> Work {
        system.eval_f(t, y, &mut self.f);
        let work = self.solve_linear(a, base, y);
        add_scaled(y, 1.0, &self.change);
        Work { evaluations: 1, ..work }
    }

    /// Solves (M - a J) change = M (base - y) + a f(t, y), where f is known, by the factors.
    fn solve_linear(&mut self, a: f64, base: &[f64], y: &[f64]) -> Work {
        let (unknowns, change) = (&self.jacobian.unknowns, &mut self.solution);
        if self.jacobian.mass.is_empty() {
            for (change, &i) in change.iter_mut().zip(unknowns) {
                *change = base[i] + a * self.f[i] - y[i];
            }
        } else {
            scaled_sum(&mut self.change, base, -1.0, y);
            self.jacobian.multiply_mass(&self.change, change);
            add_scaled(change, a, &self.f);
        }
        self.factors.solve(change);
        for (change, &i) in change.iter().zip(unknowns) {
            self.change[i] = *change;
        }
        let algebra = self.jacobian.algebra(self.factors.cost_of_solution());
        Work { solves: 1, ..algebra }
    }

    /// Returns the change of y by the last correction.
    pub fn change(&self) -> &[f64] {
        &self.change
    }

    /// Forms J at y, for steps of about `step` (s), and factorises M - a J. Returns the cost, and
    /// whether that succeeded.
    pub fn keep(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        [step, a]: [f64; 2],
        y: &[f64],
    ) -> (Work, bool) {
        let mut work = self.jacobian.form(system, t, step, y);
        let (cost, of_use) = self.factorise(a);
        work += cost;
        (work, of_use)
    }

    /// Factorises M - a J. Returns the cost, and whether that succeeded.
    pub fn factorise(&mut self, a: f64) -> (Work, bool) {
        let of_use = self.jacobian.factorise(&mut self.factors, 1.0, a);
        let work = Work { factorizations: 1, ..self.jacobian.algebra(self.factors.cost()) };
        (work, of_use)
    }
}
