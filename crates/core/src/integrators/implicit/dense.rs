//! Implicit stages of a system without masses, or of rigid bodies, by Newton's method with
//! the Jacobian J of f.

use super::jacobian::Jacobian;
use super::lu::Lu;
use super::newton::{Changes, MAX_ITERATIONS, Newton};
use crate::error::Error;
use crate::integrators::integrator::check_dim;
use crate::integrators::sweep::{add_scaled, scaled_sum};
use crate::refusal::Refusal;
use crate::system::{ParticleSystem, rigid_of};
use crate::work::Work;

/// Solver of the implicit stages of such a system, with its scratch. Particles on rigid bodies
/// stay as they are.
pub(crate) struct Dense {
    pub(super) jacobian: Jacobian,
    /// Factors of M - a J.
    factors: Lu<f64>,
    /// Change of the unknowns, and of the whole state.
    solution: Vec<f64>,
    change: Vec<f64>,
    f: Vec<f64>,
    /// State at the beginning of a step.
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
        let mut renews = true;
        for _ in 0..MAX_ITERATIONS {
            let kept = !renews && changes.shrink_fast() != Some(false);
            if !kept {
                let (formed, of_use) = self.keep(system, t, [a, a], y);
                work += formed;
                if !of_use {
                    break;
                }
            }
            work += self.correct(system, t, a, base, y);
            let change = self.jacobian.norm(&self.change);
            // A larger change by an old Jacobian may lead to another solution.
            renews = kept && changes.are_below(change);
            if renews {
                add_scaled(y, -1.0, &self.change);
                continue;
            }
            // Where bodies are does not matter.
            let size = match rigid_of(system) {
                Some(_) => (self.solution.len() as f64).sqrt(),
                None => self.jacobian.norm(y),
            };
            changes.add(change, size, 0.0);
            if newton == Newton::Once || changes.are_over(1e-9) {
                return Ok(work);
            }
            if !changes.are_finite() || changes.lead_away() {
                break;
            }
        }
        self.spent += work;
        self.jacobian.check()?;
        Err(changes.failure())
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
        let (unknowns, change) = (&self.jacobian.unknowns, &mut self.solution);
        system.eval_f(t, y, &mut self.f);
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
        add_scaled(y, 1.0, &self.change);
        let algebra = self.jacobian.algebra(self.factors.cost_of_solution());
        Work {
            evaluations: 1,
            solves: 1,
            ..algebra
        }
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
        let work = Work {
            factorizations: 1,
            ..self.jacobian.algebra(self.factors.cost())
        };
        (work, of_use)
    }
}
