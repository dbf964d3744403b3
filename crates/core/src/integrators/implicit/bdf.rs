//! The numerical differentiation formulas of orders 1 to 5, by backward differences `D_j` of the
//! states at the ends of equal steps (Shampine, Reichelt, *The MATLAB ODE suite*, SIAM J. Sci.
//! Comput. 18, 1997; Hairer, Wanner, *Solving Ordinary Differential Equations II*, 1996, V.1). At
//! the end y1 of a step of order k, `M (sum(D_j / j, j = 1..k) - kappa_k g_k D_(k+1)) = h f(t + h,
//! y1)` with the mass matrix M, which is mostly 1, and `g_k = 1 + 1/2 + ... + 1/k`. When h changes,
//! the polynomial through the states is evaluated at new times. Stiff motion is damped out. A
//! single step of a given length, which has no history, is one of TR-BDF2.
//!
//! The numerical differentiation formulas: their coefficients, errors, and stable regions.

use nalgebra::Complex;

use super::super::error_norm::ErrorNorm;
use super::super::method::{Create, Method, View};
use super::super::sweep::{add_scaled, scaled_sum};
use super::super::trial::{LastStep, Trial};
use super::consistent::Consistent;
use super::jacobian::Jacobian;
use super::kept::{KeptSolver, KeptTangent};
use super::newton::MAX_ORDER;
use super::{newton, tr_bdf2};
use crate::control::Control;
use crate::error::Error;
use crate::system::ParticleSystem;
use crate::work::Work;

pub(crate) const METHOD: Method = Method {
    name: "bdf",
    letter: Some('o'),
    aliases: &["ndf", "ode15s"],
    title: "BDF of orders 1 to 5, implicit, adaptive",
    order: tr_bdf2::METHOD.order,
    default_control: Control::Tolerance(1e-3),
    evaluations: 3,
    damped_evaluations: 3,
    view: View::Tangent,
    create: Create::Adaptive(tr_bdf2::integrator, |system| Box::new(Bdf::new(system))),
};

/// Number of backward differences: two beyond the highest order, for the errors of the next.
const DIFFERENCES: usize = MAX_ORDER + 2;
/// Safety factor of the next step, over the one that would just meet the tolerance.
const SAFETY: f64 = 0.8;
/// Least ratio of steps for which the differences are recomputed.
const MIN_STEP_RATIO: f64 = 1.2;

/// Time over which the change of the derivative is measured, as a share of the last step.
const MOMENT_SHARE: f64 = 1e-3;

/// Orders of the method and number of equal steps.
#[derive(Clone, Copy)]
struct Orders {
    /// Order of the last step.
    last: usize,
    /// Order of the next step.
    next: usize,
    /// Number of steps of this length and order.
    equal: usize,
}

/// The method with its scratch.
struct Bdf {
    solver: KeptSolver,
    /// Whether the tangent was restored from a checkpoint and has to be formed again.
    resumed: bool,
    orders: Orders,
    /// Whether no step has been taken since the beginning.
    first: bool,
    /// Whether D is a parabola that has not been checked yet.
    is_parabola: bool,
    /// Ratio of the next step to the last.
    change: f64,
    /// Beginning of a run with a mass matrix.
    consistent: Option<Consistent>,
    predicted: Vec<f64>,
    base: Vec<f64>,
    /// Error of a step.
    sum: Vec<f64>,
    /// The last step. Its vectors are `D_1`, `D_2`, ..., and in a checkpoint the state at which the
    /// tangent was formed; its length is the time between the states of D.
    step: LastStep,
}

impl Bdf {
    fn new(system: &dyn ParticleSystem) -> Self {
        let dim = system.dim();
        let zeros = || vec![0.0; dim];
        Self {
            solver: KeptSolver::new(system),
            resumed: false,
            orders: Orders { last: 1, next: 1, equal: 0 },
            first: true,
            is_parabola: false,
            change: 1.0,
            consistent: Consistent::of(system),
            predicted: zeros(),
            base: zeros(),
            sum: zeros(),
            step: LastStep::new(dim, DIFFERENCES + 1),
        }
    }

    /// Makes D the differences of states h (s) apart, on the same polynomial.
    fn rescale(&mut self, h: f64) {
        newton::rescale(&mut self.step.k[..self.orders.next], h / self.step.h);
        self.step.h = h;
        self.orders.equal = 0;
    }

    /// Writes the predicted state, and the base of the equations y1 = base + a f(t, y1).
    fn predict(&mut self) {
        let order = self.orders.next;
        let divisor = (1.0 - KAPPA[order]) * harmonic(order);
        self.predicted.copy_from_slice(&self.step.y0);
        self.base.copy_from_slice(&self.step.y0);
        for (j, d) in self.step.k[..order].iter().enumerate() {
            add_scaled(&mut self.predicted, 1.0, d);
            add_scaled(&mut self.base, 1.0 - harmonic(j + 1) / divisor, d);
        }
    }

    /// Returns the ratio of steps at which the error of an order would just be allowed.
    fn ratio(error: f64, order: usize) -> f64 {
        libm::pow(error.max(1e-12), -1.0 / (order + 1) as f64)
    }

    /// Returns the norm of the error, without that at pins, whose positions are known.
    fn norm_of_error(&mut self, system: &dyn ParticleSystem, norm: &ErrorNorm) -> f64 {
        if let Some(mechanics) = system.mechanics() {
            let inverse_masses = mechanics.inverse_masses();
            for error in self.sum.chunks_exact_mut(inverse_masses.len()) {
                for (error, w) in error.iter_mut().zip(inverse_masses) {
                    if *w == 0.0 {
                        *error = 0.0;
                    }
                }
            }
        }
        norm.of(&self.step.y0, &self.step.y1, &self.sum)
    }

    /// Returns to order 1 if the parabola that replaces previous steps has more curvature than
    /// slope: then stiff motion, which the step damps out, has bent it.
    fn judge_parabola(&mut self, norm: &ErrorNorm) {
        let [first, second, ..] = &mut self.step.k[..] else {
            return;
        };
        let y0 = &self.step.y0;
        let half = &mut self.sum;
        half.iter_mut().zip(&*second).for_each(|(half, d)| *half = 0.5 * d);
        scaled_sum(&mut self.predicted, half, 1.0, first);
        if norm.of(y0, y0, half) > norm.of(y0, y0, &self.predicted) {
            first.copy_from_slice(&self.predicted);
            (self.orders.last, self.orders.next) = (1, 1);
        }
    }

    /// Returns the norm of the error of an order, from the next higher difference.
    fn error_of(&mut self, order: usize, system: &dyn ParticleSystem, norm: &ErrorNorm) -> f64 {
        let factor = error_factor(order);
        for (sum, d) in self.sum.iter_mut().zip(&self.step.k[order]) {
            *sum = factor * d;
        }
        self.norm_of_error(system, norm)
    }

    /// Makes D the differences at the end of the step, and chooses the order and length of the next
    /// step.
    fn accept(&mut self, error: f64, system: &dyn ParticleSystem, norm: &ErrorNorm) {
        let order = self.orders.next;
        let LastStep { y1, k, .. } = &mut self.step;
        for (i, (y1, predicted)) in y1.iter().zip(&self.predicted).enumerate() {
            let d = y1 - predicted;
            k[order + 1][i] = d - k[order][i];
            k[order][i] = d;
            for j in (0..order).rev() {
                k[j][i] += k[j + 1][i];
            }
        }
        self.orders.last = order;
        self.orders.equal += 1;
        self.change = 1.0;
        let mut best = (Self::ratio(error, order), order);
        // The length of a first step is a guess, and if contact changes the end of each step, all
        // steps are first ones: the next one may be longer at once.
        let first = std::mem::take(&mut self.first);
        let settled = self.orders.equal > order;
        if !first && !settled {
            return;
        }
        if order > 1 && settled {
            let lower = (Self::ratio(self.error_of(order - 1, system, norm), order - 1), order - 1);
            if lower.0 > best.0 {
                best = lower;
            }
        }
        if order < MAX_ORDER && settled {
            let higher =
                (Self::ratio(self.error_of(order + 1, system, norm), order + 1), order + 1);
            if higher.0 > best.0 {
                best = higher;
            }
        }
        let change = SAFETY * best.0;
        if best.1 != order {
            self.orders.equal = 0;
        }
        self.orders.next = best.1;
        if !(1.0..MIN_STEP_RATIO).contains(&change) {
            self.change = change;
        }
    }
}

impl Trial for Bdf {
    fn check(&self, _: &dyn ParticleSystem) -> Result<(), Error> {
        self.solver.jacobian().map_or(Ok(()), Jacobian::check)?;
        let consistent = self.consistent.as_ref();
        consistent.map_or(Ok(()), Consistent::check)
    }

    fn dim(&self) -> usize {
        self.step.y0.len()
    }

    fn exponent(&self) -> f64 {
        (self.orders.next + 1) as f64
    }

    fn change(&self, error: f64) -> f64 {
        if error <= 1.0 {
            self.change
        } else if error.is_finite() {
            SAFETY * Self::ratio(error, self.orders.next)
        } else {
            0.5
        }
    }

    fn begin(&mut self, system: &dyn ParticleSystem, t: f64, y: &[f64]) -> Work {
        // A pin that a hand has just set in motion jumps to the velocity of its path, and what is
        // off its constraints returns to them: no step is so short that it would not.
        self.step.y0.copy_from_slice(y);
        system.hold(t, &mut self.step.y0);
        self.solver.project(system, &mut self.step.y0);
        self.solver.forget(system);
        let mut work = Work::of(1);
        match (&mut self.consistent, self.solver.jacobian_mut()) {
            (Some(consistent), Some(jacobian)) => {
                work = consistent.begin(system, jacobian, t, &mut self.step.y0);
                self.step.k[0].copy_from_slice(&consistent.rates);
            }
            _ => system.eval_f(t, &self.step.y0, &mut self.step.k[0]),
        }
        // The first difference is f times the time between the states.
        self.step.h = 1.0;
        self.first = true;
        self.is_parabola = false;
        self.orders = Orders { last: 1, next: 1, equal: 0 };
        work
    }

    /// Begins with order 2: if contact changes the end of each step, there are no previous steps,
    /// and a parabola from the derivatives of y replaces them.
    fn begin_again(&mut self, system: &dyn ParticleSystem, t: f64, y: &[f64]) -> Work {
        let moment = MOMENT_SHARE * self.step.h;
        let mut work = self.begin(system, t, y);
        if self.consistent.is_some() {
            return work;
        }
        let LastStep { y0, k, .. } = &mut self.step;
        let [first, second, ..] = &mut k[..] else {
            return work;
        };
        scaled_sum(&mut self.predicted, y0, moment, first);
        system.eval_f(t + moment, &self.predicted, second);
        for (first, second) in first.iter_mut().zip(second) {
            *second = (*second - *first) / moment;
            *first -= 0.5 * *second;
        }
        (self.orders.last, self.orders.next) = (2, 2);
        self.is_parabola = true;
        work += Work::of(1);
        work
    }

    fn start_from_end(&mut self) {
        self.step.y0.copy_from_slice(&self.step.y1);
    }

    fn derivative(&self, _: &dyn ParticleSystem, out: &mut [f64]) {
        out.fill(0.0);
        for (j, d) in self.step.k[..self.orders.last].iter().enumerate() {
            add_scaled(out, 1.0 / ((j + 1) as f64 * self.step.h), d);
        }
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
        if self.consistent.as_ref().is_some_and(Consistent::has_failed) {
            return (Work::default(), f64::INFINITY);
        }
        if h.to_bits() != self.step.h.to_bits() {
            self.rescale(h);
        }
        if std::mem::take(&mut self.is_parabola) {
            self.judge_parabola(norm);
        }
        self.predict();
        let order = self.orders.next;
        let a = h / ((1.0 - KAPPA[order]) * harmonic(order));
        if std::mem::take(&mut self.resumed) && self.solver.tangent.a != 0.0 {
            // This tangent was formed, and counted as work, before the checkpoint.
            let (_, of_use) = self.solver.form(system);
            if !of_use {
                self.solver.tangent = KeptTangent::NONE;
            }
        }
        let equations = [&*self.base, &*self.predicted];
        let y1 = &mut self.step.y1;
        let (work, solved) = self.solver.solve(system, (t + h, a), equations, y1, norm);
        if !solved {
            return (work, f64::INFINITY);
        }
        let factor = error_factor(order);
        for ((sum, y1), predicted) in self.sum.iter_mut().zip(&self.step.y1).zip(&self.predicted) {
            *sum = factor * (y1 - predicted);
        }
        let error = self.norm_of_error(system, norm);
        if error <= 1.0 {
            self.accept(error, system, norm);
        }
        (work, error)
    }

    fn end(&self) -> &[f64] {
        &self.step.y1
    }

    fn interpolate(
        &mut self,
        system: &dyn ParticleSystem,
        _t: f64,
        theta: f64,
        out: &mut [f64],
    ) -> Work {
        out.copy_from_slice(&self.step.y1);
        let mut factor = 1.0;
        for (j, d) in self.step.k[..self.orders.last].iter().enumerate() {
            factor *= (theta - 1.0 + j as f64) / (j + 1) as f64;
            add_scaled(out, factor, d);
        }
        self.solver.project(system, out);
        Work::default()
    }

    fn last(&self) -> LastStep {
        let Orders { last, next, equal } = self.orders;
        let KeptTangent { t, a, formed, clamped, rate } = self.solver.tangent;
        let mut step = self.step.clone();
        step.k[DIFFERENCES].copy_from_slice(&self.solver.at);
        step.counts = vec![last, next, equal, usize::from(clamped)];
        let pattern = self.solver.jacobian().map(Jacobian::pattern);
        step.counts.extend(pattern.unwrap_or_default());
        step.numbers = vec![t, a, formed, rate];
        step
    }

    fn resume(&mut self, step: &LastStep) -> Result<(), Error> {
        let (&[last, next, equal, clamped, ref pattern @ ..], &[t, a, formed, rate]) =
            (&*step.counts, &*step.numbers)
        else {
            return Err(Error::Invalid("the last step is of another method".into()));
        };
        if [last, next].iter().any(|order| !(1..=MAX_ORDER).contains(order)) {
            return Err(Error::Invalid(format!("there is no BDF of order {next}")));
        }
        if !self.solver.set_pattern(pattern) {
            return Err(Error::Invalid("the last step is of another system".into()));
        }
        self.step.resume(step)?;
        self.first = false;
        self.orders = Orders { last, next, equal };
        self.solver.at.copy_from_slice(&step.k[DIFFERENCES]);
        self.solver.tangent = KeptTangent { t, a, formed, clamped: clamped != 0, rate };
        self.resumed = true;
        Ok(())
    }
}

/// Largest number of iterations for roots, and change at which they end.
const MAX_ITERATIONS: usize = 100;
const ROOT_TOLERANCE: f64 = 1e-13;

/// Coefficient kappa of each order: it reduces the error, at about the same stability.
const KAPPA: [f64; MAX_ORDER + 1] = [0.0, -0.185, -1.0 / 9.0, -0.0823, -0.0415, 0.0];

/// Returns the sum g of the reciprocals of the numbers up to an order.
fn harmonic(order: usize) -> f64 {
    (1..=order).map(|j| 1.0 / j as f64).sum()
}

/// Returns the factor of `D_(k+1)` in the error of a step of order k.
fn error_factor(order: usize) -> f64 {
    KAPPA[order] * harmonic(order) + 1.0 / (order + 1) as f64
}

/// Returns the growth per step of a solution of y' = l y with z = h l = re + i im, in equal steps
/// of the order with the largest growth.
///
/// A solution `y_n = r^n` has backward differences `w^j y_n` with w = 1 - 1/r, so w is a root of
/// `sum(w^j / j, j = 1..k) - kappa_k g_k w^(k+1) = z`.
#[must_use]
pub fn bdf_growth(re: f64, im: f64) -> f64 {
    let of_order = |order: usize| {
        let mut polynomial = vec![Complex::new(-re, -im)];
        polynomial.extend((1..=order).map(|j| Complex::from(1.0 / j as f64)));
        polynomial.push(Complex::from(-KAPPA[order] * harmonic(order)));
        let rates = roots(&polynomial).into_iter();
        rates.map(|w| 1.0 / (1.0 - w).norm()).fold(0.0, f64::max)
    };
    (1..=MAX_ORDER).map(of_order).fold(0.0, f64::max)
}

/// Finds the roots of a polynomial, given by its coefficients from the constant on: all of them at
/// the same time (Durand and Kerner).
fn roots(coefficients: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let zero = |c: &Complex<f64>| c.norm() > 0.0;
    let degree = coefficients.iter().rposition(zero).unwrap_or(0);
    let leading = coefficients[degree];
    let value = |x: Complex<f64>| {
        let terms = coefficients[..degree].iter().rev();
        terms.fold(Complex::from(1.0), |sum, c| sum * x + c / leading)
    };
    // Start values that are neither real nor roots of unity.
    let mut roots: Vec<_> = (0..degree).map(|k| Complex::new(0.4, 0.9).powu(k as u32)).collect();
    for _ in 0..MAX_ITERATIONS {
        let mut largest: f64 = 0.0;
        for k in 0..degree {
            let others = (0..degree).filter(|j| *j != k).map(|j| roots[k] - roots[j]);
            let change = value(roots[k]) / others.product::<Complex<f64>>();
            roots[k] -= change;
            largest = largest.max(change.norm());
        }
        if largest < ROOT_TOLERANCE {
            break;
        }
    }
    roots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_those_of_which_it_is_the_product() {
        let given =
            [(1.0, 2.0), (-3.0, 0.5), (0.25, 0.0), (0.0, -1.0)].map(|(a, b)| Complex::new(a, b));
        let mut product = vec![Complex::from(2.0)];
        for root in given {
            product.insert(0, Complex::from(0.0));
            for k in 0..product.len() - 1 {
                let next = product[k + 1];
                product[k] -= root * next;
            }
        }
        product.push(Complex::from(0.0));
        let found = roots(&product);
        assert_eq!(found.len(), given.len());
        for root in given {
            let nearest = found.iter().map(|other| (other - root).norm());
            assert!(nearest.fold(f64::INFINITY, f64::min) < 1e-10, "{root} {found:?}");
        }
    }

    /// Order 5 is stable within 51 degrees of the negative real axis (Shampine, Reichelt, table 2).
    #[test]
    fn what_decays_within_the_known_angle_is_stable() {
        let grows = |degrees: f64| {
            let turned = std::f64::consts::PI - degrees.to_radians();
            let growth = |k: i32| {
                let z = Complex::from_polar(f64::powi(1.2, k), turned);
                bdf_growth(z.re, z.im)
            };
            (-20..20).any(|k| growth(k) > 1.0 + 1e-9)
        };
        assert!(!grows(0.0) && !grows(51.0) && grows(53.0));
    }
}
