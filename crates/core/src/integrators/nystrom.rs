//! Runge-Kutta-Nyström pairs by their tables, for `x'' = a(t, x)` and, by a substitution, for `x''
//! = a(t, x) - 2 g x'`: `X_i = x0 + c_i h v0 + h^2 sum a_ij k_j`, `k_i = a(t + c_i h, X_i)`, `x1 =
//! x0 + h v0 + h^2 sum b_i k_i`, `v1 = v0 + h sum b'_i k_i` (Hairer, Norsett, Wanner, *Solving
//! Ordinary Differential Equations I*, 1993, II.14). They take fewer stages than a Runge-Kutta
//! method of the same order, but forces must not depend on the velocity.
//!
//! Viscous drag of coefficient c is the exception. With g = c / (2 m) and x = x0 + exp(-g s) w,
//! where s is the time since the step began, w'' = exp(g s) (a + g^2 (x - x0)) is free of w', and
//! w(0) = 0, w'(0) = v0. Each particle has its own g. The orders are those without drag.

use std::ops::Range;

use super::embedded::{add_to_block, blocks};
use super::error_norm::ErrorNorm;
use super::integrator::{Integrator, check_dim};
use super::sweep::add_scaled;
use super::trial::{LastStep, Trial};
use crate::error::Error;
use crate::refusal::Refusal;
use crate::system::{Mechanics, ParticleSystem, place_pins};
use crate::work::Work;

/// Coefficients of a pair. Its stages are followed by the acceleration at the end of the step, the
/// first of the next step, which error estimate and polynomial may use as a stage.
#[derive(Debug)]
pub(super) struct NystromTableau {
    /// Time `c_i` and weights `a_ij` of each stage from the second on.
    pub stages: &'static [(f64, &'static [f64])],
    /// Weights of x1 and of v1.
    pub weights: [&'static [f64]; 2],
    /// Weights of the estimated errors of x1 and of v1.
    pub errors: [&'static [f64]; 2],
    /// Power of h to which the estimated local error is proportional.
    pub exponent: f64,
    /// Coefficients of each stage's weight in the polynomial for x, starting with the fraction of
    /// the step squared.
    pub dense: &'static [&'static [f64]],
}

/// Largest number of stages of a polynomial.
const MAX_STAGES: usize = 18;

/// A pair with its scratch: by itself a method of fixed steps, and an adaptive one in
/// [`Adaptive`](super::Adaptive).
pub(super) struct NystromPair {
    /// Full title of the method.
    method: &'static str,
    tableau: &'static NystromTableau,
    /// Position at which a stage is evaluated.
    x: Vec<f64>,
    /// Velocity with which a stage is evaluated: 0, except at pins.
    v: Vec<f64>,
    /// Estimated error of the state.
    error: Vec<f64>,
    /// The last step. Its last k is the acceleration at its end, and the one before it that
    /// acceleration as a stage.
    last: LastStep,
}

/// Returns the drag of a system whose other forces do not depend on the velocity; `None` for other
/// systems.
fn drag(system: &dyn ParticleSystem) -> Option<(&dyn Mechanics, SystemDrag<'_>)> {
    let mechanics = system.mechanics()?;
    let drag = SystemDrag {
        coefficient: mechanics.drag_coefficient(),
        inverse_masses: mechanics.inverse_masses(),
    };
    mechanics.is_positional().then_some((mechanics, drag))
}

/// Returns the error of a method if forces depend on the velocity.
fn refused(method: &'static str) -> Error {
    Error::Unsupported { method, why: Refusal::ReadsVelocity }
}

/// Viscous drag of a system.
#[derive(Clone, Copy)]
struct SystemDrag<'a> {
    /// Coefficient (kg/s).
    coefficient: f64,
    /// Inverse masses of the particles (1/kg).
    inverse_masses: &'a [f64],
}

impl SystemDrag<'_> {
    /// Visits runs of equal masses in a range of numbers of an n x 3 matrix, counted from its
    /// start, with g = c / (2 m) (1/s) of each; none without drag.
    fn runs(&self, numbers: Range<usize>, mut visit: impl FnMut(Range<usize>, f64)) {
        if self.coefficient == 0.0 {
            return;
        }
        let n = self.inverse_masses.len();
        let mut start = numbers.start;
        while start < numbers.end {
            let column = start % n;
            let rest = &self.inverse_masses[column..n.min(column + numbers.end - start)];
            for run in rest.chunk_by(|a, b| a == b) {
                let first = start - numbers.start;
                visit(first..first + run.len(), 0.5 * self.coefficient * run[0]);
                start += run.len();
            }
        }
    }
}

/// A system whose forces depend on velocities by drag only, and a step of it.
struct DraggedStep<'a> {
    mechanics: &'a dyn Mechanics,
    drag: SystemDrag<'a>,
    /// Time at the beginning (s).
    t: f64,
    /// Length (s).
    h: f64,
}

impl DraggedStep<'_> {
    /// Writes `h^2 sum weights k` to `x`, plus s v0; then multiplies by exp(-g s), by which w
    /// becomes x - x0, and adds x0. Without `y0`, leaves out v0 and x0.
    fn positions(
        &self,
        s: f64,
        weights: &[f64],
        y0: Option<&[f64]>,
        k: &[Vec<f64>],
        x: &mut [f64],
    ) {
        let (h, drag) = (self.h, self.drag);
        let start = y0.map(|y0| y0.split_at(x.len()));
        blocks(3, x, |first, x| {
            let numbers = first..first + x.len();
            x.fill(0.0);
            add_to_block(first, x, h * h, weights, k);
            if let Some((_, v0)) = start {
                add_scaled(x, s, &v0[numbers.clone()]);
            }
            drag.runs(numbers.clone(), |run, g| {
                let shrunk = libm::exp(-g * s);
                x[run].iter_mut().for_each(|x| *x *= shrunk);
            });
            if let Some((x0, _)) = start {
                add_scaled(x, 1.0, &x0[numbers]);
            }
        });
    }

    /// Writes the state at the time s (s) into the step from `y0` to `out`, by the weights of x and
    /// of v; without `y0`, the differences by other weights.
    fn state(
        &self,
        s: f64,
        weights: [&[f64]; 2],
        y0: Option<&[f64]>,
        k: &[Vec<f64>],
        out: &mut [f64],
    ) {
        let (x, v) = out.split_at_mut(out.len() / 2);
        self.positions(s, weights[0], y0, k, x);
        let (h, drag) = (self.h, self.drag);
        let start = y0.map(|y0| y0.split_at(x.len()));
        blocks(3, v, |first, v| {
            let numbers = first..first + v.len();
            v.fill(0.0);
            add_to_block(first, v, h, weights[1], k);
            if let Some((_, v0)) = start {
                add_scaled(v, 1.0, &v0[numbers.clone()]);
            }
            drag.runs(numbers, |run, g| {
                let shrunk = libm::exp(-g * s);
                for i in run {
                    let from = start.map_or(0.0, |(x0, _)| x0[first + i]);
                    v[i] = shrunk * v[i] - g * (x[first + i] - from);
                }
            });
        });
        if start.is_some() {
            place_pins(self.mechanics, self.t + s, x, v);
        }
    }

    /// Converts accelerations `k` at the positions x, at the time s (s) into the step, to w''.
    fn substitute(&self, s: f64, x: &[f64], x0: &[f64], k: &mut [f64]) {
        let drag = self.drag;
        if drag.coefficient == 0.0 {
            return;
        }
        blocks(3, k, |first, k| {
            drag.runs(first..first + k.len(), |run, g| {
                let grown = libm::exp(g * s);
                for i in run {
                    k[i] = grown * (k[i] + g * g * (x[first + i] - x0[first + i]));
                }
            });
        });
    }
}

impl NystromPair {
    pub fn new(method: &'static str, tableau: &'static NystromTableau, dim: usize) -> Self {
        let mut last = LastStep::new(dim, tableau.stages.len() + 3);
        for k in &mut last.k {
            k.truncate(dim / 2);
        }
        Self {
            method,
            tableau,
            x: vec![0.0; dim / 2],
            v: vec![0.0; dim / 2],
            error: vec![0.0; dim],
            last,
        }
    }

    /// Creates the step of h (s) from t (s) with this system, if the system allows it.
    fn of(system: &dyn ParticleSystem, t: f64, h: f64) -> Option<DraggedStep<'_>> {
        let (mechanics, drag) = drag(system)?;
        Some(DraggedStep { mechanics, drag, t, h })
    }

    /// Evaluates the stages of a step after [`begin`](Trial::begin) or
    /// [`start_from_end`](Trial::start_from_end), and computes its end. Returns the cost.
    fn stages(&mut self, step: &DraggedStep) -> Work {
        let tableau = self.tableau;
        let LastStep { h, y0, y1, k, .. } = &mut self.last;
        *h = step.h;
        for (i, (c, a)) in tableau.stages.iter().enumerate() {
            let s = c * step.h;
            step.positions(s, a, Some(y0), k, &mut self.x);
            self.v.fill(0.0);
            place_pins(step.mechanics, step.t + s, &mut self.x, &mut self.v);
            step.mechanics.accelerations(step.t + s, &self.x, &self.v, &mut k[i + 1]);
            step.substitute(s, &self.x, y0, &mut k[i + 1]);
        }
        step.state(step.h, tableau.weights, Some(y0), k, y1);
        Work::of(tableau.stages.len() as u64)
    }

    /// Evaluates the acceleration at the end of the step. Returns the cost.
    fn finish(&mut self, step: &DraggedStep) -> Work {
        let LastStep { y0, y1, k, .. } = &mut self.last;
        let x1 = &y1[..self.x.len()];
        let [.., as_stage, end] = &mut k[..] else {
            return Work::default();
        };
        self.v.fill(0.0);
        step.mechanics.accelerations(step.t + step.h, x1, &self.v, end);
        as_stage.copy_from_slice(end);
        step.substitute(step.h, x1, y0, as_stage);
        Work::of(1)
    }
}

impl Trial for NystromPair {
    fn check(&self, system: &dyn ParticleSystem) -> Result<(), Error> {
        match drag(system) {
            Some(_) => Ok(()),
            None => Err(refused(self.method)),
        }
    }

    fn dim(&self) -> usize {
        self.last.y0.len()
    }

    fn exponent(&self) -> f64 {
        self.tableau.exponent
    }

    fn begin(&mut self, system: &dyn ParticleSystem, t: f64, y: &[f64]) -> Work {
        let Some(step) = Self::of(system, t, 0.0) else {
            return Work::default();
        };
        self.last.y0.copy_from_slice(y);
        self.v.fill(0.0);
        let x0 = &y[..self.x.len()];
        step.mechanics.accelerations(t, x0, &self.v, &mut self.last.k[0]);
        Work::of(1)
    }

    fn start_from_end(&mut self) {
        let end = self.last.k.len() - 1;
        self.last.k.swap(0, end);
        std::mem::swap(&mut self.last.y0, &mut self.last.y1);
    }

    fn derivative(&self, system: &dyn ParticleSystem, out: &mut [f64]) {
        let (dx, dv) = out.split_at_mut(self.x.len());
        dx.copy_from_slice(&self.last.y0[self.x.len()..]);
        dv.copy_from_slice(&self.last.k[0]);
        if let Some(step) = Self::of(system, 0.0, 0.0) {
            step.drag.runs(0..dx.len(), |run, g| {
                add_scaled(&mut dv[run.clone()], -2.0 * g, &dx[run]);
            });
        }
    }

    fn attempt(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        norm: &ErrorNorm,
    ) -> (Work, f64) {
        let Some(step) = Self::of(system, t, h) else {
            return (Work::default(), f64::NAN);
        };
        let mut work = self.stages(&step);
        let reads_end = self.tableau.errors[1].len() > self.tableau.stages.len() + 1;
        if reads_end {
            work += self.finish(&step);
        }
        let LastStep { y0, y1, k, .. } = &self.last;
        step.state(h, self.tableau.errors, None, k, &mut self.error);
        let error = norm.of(y0, y1, &self.error);
        if !reads_end && error <= 1.0 {
            work += self.finish(&step);
        }
        (work, error)
    }

    fn end(&self) -> &[f64] {
        &self.last.y1
    }

    fn interpolate(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        theta: f64,
        out: &mut [f64],
    ) -> Work {
        let Some(step) = Self::of(system, t, self.last.h) else {
            return Work::default();
        };
        let (mut of_x, mut of_v) = ([0.0; MAX_STAGES], [0.0; MAX_STAGES]);
        let stages = of_x.iter_mut().zip(&mut of_v).zip(self.tableau.dense);
        for ((of_x, of_v), coefficients) in stages {
            // Horner's scheme for the sum of r theta^m from m = 2 on, and for its derivative.
            let mut degree = coefficients.len() as f64 + 1.0;
            for r in coefficients.iter().rev() {
                *of_x = *of_x * theta + r;
                *of_v = *of_v * theta + degree * r;
                degree -= 1.0;
            }
            *of_x *= theta * theta;
            *of_v *= theta;
        }
        let LastStep { h, y0, k, .. } = &self.last;
        step.state(theta * h, [&of_x, &of_v], Some(y0), k, out);
        Work::default()
    }

    fn last(&self) -> LastStep {
        self.last.clone()
    }

    fn resume(&mut self, step: &LastStep) -> Result<(), Error> {
        self.last.resume(step)
    }
}

impl Integrator for NystromPair {
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        check_dim(self.dim(), y)?;
        let step = Self::of(system, t, h).ok_or(refused(self.method))?;
        let mut work = self.begin(system, t, y);
        work += self.stages(&step);
        y.copy_from_slice(&self.last.y1);
        Ok(work)
    }
}
