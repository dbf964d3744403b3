//! Radau IIA of order 5 (Hairer, Wanner, *Solving Ordinary Differential Equations II*, 1996, IV.8):
//! collocation at three nodes; the last node is the end of the step. Any step is stable, and stiff
//! motion is damped out. The error is estimated by a formula of order 3, whose difference is
//! filtered by (REAL / h M - J)^-1, so that stiff motion does not spoil it. Steps are predicted
//! from the last two errors (Gustafsson, *Control-theoretic techniques for stepsize selection in
//! implicit Runge-Kutta methods*, ACM Trans. Math. Softw. 20, 1994). States within a step are on
//! the polynomial of collocation, of degree 3. Stiff motion makes the ends of steps far more exact
//! than that polynomial, which is why its own error counts too.

use super::super::error_norm::{ErrorNorm, Tolerance};
use super::super::integrator::{Integrator, check_dim};
use super::super::method::{Create, Method, View};
use super::super::sweep::add_scaled;
use super::super::trial::{LastStep, Trial};
use super::collocation::{Collocation, MAX_ITERATIONS, NODES, ROOT6, STAGES};
use super::consistent::Consistent;
use crate::control::Control;
use crate::error::Error;
use crate::system::ParticleSystem;
use crate::work::Work;

pub(crate) const METHOD: Method = Method {
    name: "radau",
    letter: Some('w'),
    aliases: &["radau5", "radau-iia"],
    title: "Radau IIA of order 5, implicit, adaptive",
    order: 5,
    default_control: Control::Tolerance(1e-6),
    evaluations: 9,
    damped_evaluations: 9,
    view: View::Jacobian,
    create: Create::Adaptive(
        |system| Box::new(Radau::new(system)),
        |system| Box::new(Radau::new(system)),
    ),
};

/// Weights of the displacements in the estimate of the error, and of its formula in the polynomial
/// y0 + theta `q_1` + `theta^2 q_2` + `theta^3 q_3`, whose vectors are sums of displacements.
const ERROR_WEIGHTS: [f64; STAGES] =
    [(-13.0 - 7.0 * ROOT6) / 3.0, (-13.0 + 7.0 * ROOT6) / 3.0, -1.0 / 3.0];
const POLYNOMIAL: [[f64; STAGES]; STAGES] = [
    [(13.0 + 7.0 * ROOT6) / 3.0, (13.0 - 7.0 * ROOT6) / 3.0, 1.0 / 3.0],
    [(-23.0 - 22.0 * ROOT6) / 3.0, (-23.0 + 22.0 * ROOT6) / 3.0, -8.0 / 3.0],
    [10.0 / 3.0 + 5.0 * ROOT6, 10.0 / 3.0 - 5.0 * ROOT6, 10.0 / 3.0],
];

/// Largest product |x| |x - `c_1`| |x - `c_2`| |x - 1| of the distances of a place x in the step
/// from its beginning and its nodes, in steps.
const WITHIN: f64 = 0.019_6;

/// Safety factor of the next step, after a solution in no iteration.
const SAFETY: f64 = 0.9;
/// Least error from which the next step is predicted: below it, errors are chance (RADAU5).
const LEAST_ERROR: f64 = 1e-2;
/// Ratio of the next step to the last up to which the step, and with it the factors, stay.
const MIN_STEP_RATIO: f64 = 1.2;
/// Ratio of steps after equations that were not solved.
const RETREAT: f64 = 0.5;
/// Tolerance to which the equations of a fixed step are solved, by the share of it that may remain:
/// to 1e-12 of the state.
const FIXED: Tolerance = Tolerance { relative: 1e-8, absolute: 1e-8 };

/// Places of the vectors of a step: f at its beginning and at its end, the vectors of the
/// polynomial, and the state at which the Jacobian was formed.
const BEGIN: usize = 0;
const END: usize = 1;
const FIRST: usize = 2;
const FORMED: usize = FIRST + STAGES;

/// Memory of the control between steps.
#[derive(Clone, Copy, Default)]
struct Memory {
    /// Whether there is a Jacobian.
    has_jacobian: bool,
    /// Whether the next step needs a new one.
    renews: bool,
    /// Whether there is a last step, on whose polynomial the next one starts.
    has_past: bool,
    /// Error of the last step over the allowed one.
    error: f64,
}

/// The method with its scratch.
struct Radau {
    equations: Collocation,
    memory: Memory,
    /// Whether the Jacobian was formed at the beginning of this step.
    is_fresh: bool,
    /// Whether the Jacobian was restored from a checkpoint and has to be formed again.
    resumed: bool,
    /// Whether the last attempt of this step was rejected.
    rejected: bool,
    /// Ratio of the next step to the last.
    change: f64,
    /// Displacement at the end of the step, by the polynomial of the last one.
    foreseen: Vec<f64>,
    error: Vec<f64>,
    base: Vec<f64>,
    /// Product of the mass matrix with a displacement.
    moved: Vec<f64>,
    /// Beginning of a run with a mass matrix.
    consistent: Option<Consistent>,
    step: LastStep,
}

impl Radau {
    fn new(system: &dyn ParticleSystem) -> Self {
        let zeros = || vec![0.0; system.dim()];
        Self {
            equations: Collocation::new(system),
            memory: Memory::default(),
            is_fresh: false,
            resumed: false,
            rejected: false,
            change: 1.0,
            foreseen: zeros(),
            error: zeros(),
            base: zeros(),
            moved: zeros(),
            consistent: Consistent::of(system),
            step: LastStep::new(system.dim(), FORMED + 1),
        }
    }

    /// Forms the Jacobian at the beginning of the step.
    fn form(&mut self, system: &dyn ParticleSystem, t: f64, h: f64) -> Work {
        (self.memory.has_jacobian, self.memory.renews) = (true, false);
        self.is_fresh = true;
        self.equations.form(system, t, h, &self.step.y0)
    }

    /// Writes the displacements at the nodes of a step of h (s), by the polynomial of the last
    /// step.
    fn predict(&mut self, h: f64) {
        let ratio = h / self.step.h;
        for (stage, node) in self.equations.stages.iter_mut().zip(NODES) {
            stage.fill(0.0);
            if self.memory.has_past {
                let theta = 1.0 + node * ratio;
                let mut power = 1.0;
                for q in &self.step.k[FIRST..FORMED] {
                    power *= theta;
                    add_scaled(stage, power - 1.0, q);
                }
            }
        }
        self.foreseen.copy_from_slice(&self.equations.stages[STAGES - 1]);
    }

    /// Returns the error of states within the step over the allowed one. The error of a polynomial
    /// through four points of a smooth motion is as the product of the distances from them: it is
    /// known at the end of this step for the polynomial of the last one.
    fn error_within(&mut self, norm: &ErrorNorm) -> f64 {
        if !self.memory.has_past {
            return 0.0;
        }
        self.error.copy_from_slice(&self.foreseen);
        add_scaled(&mut self.error, -1.0, &self.equations.stages[STAGES - 1]);
        let ratio = norm.h / self.step.h;
        let distances = NODES.map(|node| 1.0 + ratio - node);
        let ahead = (1.0 + ratio) * distances.iter().product::<f64>();
        let share = WITHIN * ratio.powi(4) / ahead;
        share * norm.of(&self.step.y0, &self.step.y1, &self.error)
    }

    /// Solves the equations of a step with the kept Jacobian or a new one, and writes its end.
    /// Returns the cost, and whether that succeeded.
    fn solve(&mut self, t: f64, norm: &ErrorNorm, most: i32) -> (Work, bool) {
        let (system, h) = (norm.system, norm.h);
        let mut work = Work::default();
        if !self.memory.has_jacobian || self.memory.renews {
            work += self.form(system, t, h);
        }
        loop {
            self.predict(h);
            let (cost, mut solved) = self.equations.factorise(h);
            work += cost;
            if solved {
                let (cost, converged) = self.equations.solve((t, &self.step.y0), norm, most);
                work += cost;
                solved = converged;
            }
            if solved {
                let LastStep { y0, y1, .. } = &mut self.step;
                y1.copy_from_slice(y0);
                add_scaled(y1, 1.0, &self.equations.stages[STAGES - 1]);
                system.hold(t + h, y1);
                return (work, true);
            }
            if self.is_fresh {
                return (work, false);
            }
            work += self.form(system, t, h);
        }
    }

    /// Writes the error of the step, for f at its beginning or a better value. Returns the cost.
    fn estimate(&mut self, h: f64, f: &[f64]) -> Work {
        self.error.copy_from_slice(f);
        for (z, weight) in self.equations.stages.iter().zip(ERROR_WEIGHTS) {
            self.equations.jacobian.multiply_mass(z, &mut self.moved);
            add_scaled(&mut self.error, weight / h, &self.moved);
        }
        self.equations.filter(&mut self.error)
    }

    /// Returns the error of the step over the allowed one. If the first step, or one after a
    /// rejection, has too large an error, the stiff part of it is filtered once more.
    fn judge(&mut self, t: f64, norm: &ErrorNorm) -> (Work, f64) {
        let f = std::mem::take(&mut self.step.k[BEGIN]);
        let mut work = self.estimate(norm.h, &f);
        self.step.k[BEGIN] = f;
        let error = norm.of(&self.step.y0, &self.step.y1, &self.error);
        if error <= 1.0 || self.memory.has_past && !self.rejected {
            return (work, error);
        }
        self.base.copy_from_slice(&self.step.y0);
        add_scaled(&mut self.base, 1.0, &self.error);
        let mut f = std::mem::take(&mut self.step.k[END]);
        norm.system.eval_f(t, &self.base, &mut f);
        work += self.estimate(norm.h, &f);
        work += Work::of(1);
        self.step.k[END] = f;
        let error = norm.of(&self.step.y0, &self.step.y1, &self.error);
        (work, error)
    }

    /// Returns the ratio of steps at which the error would just be allowed, with a safety factor
    /// that is smaller after more iterations.
    fn ratio(&self, error: f64) -> f64 {
        let most = MAX_ITERATIONS[0];
        let iterations = self.equations.iterations;
        let safety = SAFETY * f64::from(2 * most + 1) / f64::from(2 * most + iterations);
        safety * libm::pow(error, -1.0 / self.exponent())
    }

    /// Keeps the polynomial of the step, and chooses the length of the next one.
    fn accept(&mut self, h: f64, error: f64) {
        let mut change = self.ratio(error);
        let error = error.max(LEAST_ERROR);
        if self.memory.has_past {
            let trend = h / self.step.h * libm::pow(self.memory.error / error, 0.25);
            change = change.min(self.ratio(error) * trend);
        }
        self.memory.error = error;
        self.memory.renews = self.equations.converges_slowly();
        let stays = !self.memory.renews && (1.0..MIN_STEP_RATIO).contains(&change);
        self.change = if stays { 1.0 } else { change };
        let LastStep { k, h: last, .. } = &mut self.step;
        for (q, weights) in k[FIRST..FORMED].iter_mut().zip(POLYNOMIAL) {
            q.fill(0.0);
            for (z, weight) in self.equations.stages.iter().zip(weights) {
                add_scaled(q, weight, z);
            }
        }
        *last = h;
        self.memory.has_past = true;
        (self.is_fresh, self.rejected) = (false, false);
    }
}

impl Trial for Radau {
    fn check(&self, _: &dyn ParticleSystem) -> Result<(), Error> {
        self.equations.jacobian.check()?;
        let consistent = self.consistent.as_ref();
        consistent.map_or(Ok(()), Consistent::check)
    }

    fn dim(&self) -> usize {
        self.step.y0.len()
    }

    fn exponent(&self) -> f64 {
        4.0
    }

    fn change(&self, error: f64) -> f64 {
        if error <= 1.0 {
            self.change
        } else if error.is_finite() {
            self.ratio(error)
        } else {
            RETREAT
        }
    }

    fn begin(&mut self, system: &dyn ParticleSystem, t: f64, y: &[f64]) -> Work {
        self.step.y0.copy_from_slice(y);
        self.memory = Memory::default();
        self.equations.jacobian.forget();
        (self.is_fresh, self.rejected, self.resumed) = (false, false, false);
        let (y0, jacobian) = (&mut self.step.y0, &mut self.equations.jacobian);
        let begin = |consistent: &mut Consistent| consistent.begin(system, jacobian, t, y0);
        let mut work = self.consistent.as_mut().map(begin).unwrap_or_default();
        system.eval_f(t, &self.step.y0, &mut self.step.k[BEGIN]);
        work += Work::of(1);
        work
    }

    fn start_from_end(&mut self) {
        self.step.k.swap(BEGIN, END);
        std::mem::swap(&mut self.step.y0, &mut self.step.y1);
    }

    fn derivative(&self, _: &dyn ParticleSystem, out: &mut [f64]) {
        let rates = self.consistent.as_ref().map(|consistent| &consistent.rates);
        out.copy_from_slice(rates.unwrap_or(&self.step.k[BEGIN]));
    }

    fn second_derivative(&self) -> Option<&[f64]> {
        let consistent = self.consistent.as_ref();
        consistent.map(|consistent| &*consistent.seconds)
    }

    fn attempt(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        norm: &ErrorNorm,
    ) -> (Work, f64) {
        if std::mem::take(&mut self.resumed) && self.memory.has_jacobian {
            self.equations.form_again(system);
        }
        if self.consistent.as_ref().is_some_and(Consistent::has_failed) {
            return (Work::default(), f64::INFINITY);
        }
        let (mut work, solved) = self.solve(t, norm, MAX_ITERATIONS[0]);
        let mut error = f64::INFINITY;
        if solved {
            let (cost, at_end) = self.judge(t, norm);
            work += cost;
            error = at_end.max(self.error_within(norm));
        }
        if error <= 1.0 {
            self.accept(h, error);
            let LastStep { y1, k, .. } = &mut self.step;
            system.eval_f(t + h, y1, &mut k[END]);
            work += Work::of(1);
        } else {
            self.rejected = true;
        }
        (work, error)
    }

    fn end(&self) -> &[f64] {
        &self.step.y1
    }

    fn interpolate(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        theta: f64,
        out: &mut [f64],
    ) -> Work {
        out.copy_from_slice(&self.step.y0);
        let mut power = 1.0;
        for q in &self.step.k[FIRST..FORMED] {
            power *= theta;
            add_scaled(out, power, q);
        }
        system.hold(t + theta * self.step.h, out);
        Work::default()
    }

    fn last(&self) -> LastStep {
        let Memory { has_jacobian, renews, has_past, error } = self.memory;
        let mut step = self.step.clone();
        step.k[FORMED].copy_from_slice(&self.equations.formed.1);
        step.counts = [has_jacobian, renews, has_past].map(usize::from).to_vec();
        step.counts.extend(self.equations.jacobian.pattern());
        let Collocation { formed, remaining, factored, .. } = &self.equations;
        step.numbers = vec![formed.0[0], formed.0[1], *remaining, error, *factored];
        step
    }

    fn resume(&mut self, step: &LastStep) -> Result<(), Error> {
        let (
            &[has_jacobian, renews, has_past, ref pattern @ ..],
            &[t, h, remaining, error, factored],
        ) = (&*step.counts, &*step.numbers)
        else {
            return Err(Error::Invalid("the last step is of another method".into()));
        };
        if !self.equations.jacobian.set_pattern(pattern) {
            return Err(Error::Invalid("the last step is of another system".into()));
        }
        self.step.resume(step)?;
        let Collocation { formed, remaining: own, factored: step_of_factors, .. } =
            &mut self.equations;
        formed.0 = [t, h];
        formed.1.copy_from_slice(&step.k[FORMED]);
        (*own, *step_of_factors) = (remaining, factored);
        let [has_jacobian, renews, has_past] =
            [has_jacobian, renews, has_past].map(|flag| flag != 0);
        self.memory = Memory { has_jacobian, renews, has_past, error };
        (self.is_fresh, self.rejected, self.resumed) = (false, false, true);
        Ok(())
    }
}

impl Integrator for Radau {
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        check_dim(self.dim(), y)?;
        self.begin(system, t, y);
        self.check(system)?;
        let norm = ErrorNorm { system, tolerance: FIXED, sizes: &[], h };
        let (work, solved) = self.solve(t, &norm, MAX_ITERATIONS[1]);
        if !solved {
            self.equations.jacobian.check()?;
            return Err(Error::NoConvergence { residual: self.equations.rate() });
        }
        y.copy_from_slice(&self.step.y1);
        Ok(work)
    }
}
