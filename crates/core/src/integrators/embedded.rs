//! Explicit Runge-Kutta pairs by their tables: `y1 = y + h sum b k` with `k_i = f(t + c_i h, y + h
//! sum a_ij k_j)`, an estimate of its error from other weights, and a polynomial through the step
//! (Hairer, Norsett, Wanner, *Solving Ordinary Differential Equations I*, 1993, II.4 to II.6).

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::error_norm::{Allowed, BLOCK, ErrorNorm, sum_of_squares};
use super::integrator::{Integrator, check_dim};
use super::trial::{LastStep, Trial};
use crate::error::Error;
use crate::sums::{OnBlock, add_up, dot};
use crate::system::ParticleSystem;
use crate::threads::{Columns, fork, threads};
use crate::vectors::Arch;
use crate::work::Work;

/// Coefficients of a pair. Its stages are followed by k = f(t + h, y1), the first stage of the next
/// step, and then by the stages that only the polynomial needs.
#[derive(Debug)]
pub(super) struct Tableau {
    /// Time `c_i` and weights `a_ij` of each stage from the second on.
    pub(super) stages: &'static [(f64, &'static [f64])],
    /// Weights of y1.
    pub(super) weights: &'static [f64],
    /// Weights of the error estimates: of one, or of the two of orders 5 and 3 that DOP853
    /// combines.
    pub(super) errors: &'static [&'static [f64]],
    /// Power of h to which the estimated local error is proportional.
    pub(super) exponent: f64,
    /// Times and weights of the polynomial's own stages.
    pub(super) extra: &'static [(f64, &'static [f64])],
    /// Weights of the polynomial's terms of degree 4 and more; the lower terms follow from both
    /// ends.
    pub(super) dense: &'static [&'static [f64]],
    /// Weights of the terms of degree 1, 2 and more of another polynomial, which takes the place of
    /// that one; none if there is no other.
    pub(super) powers: &'static [&'static [f64]],
}

/// Largest number of terms of a polynomial.
const MAX_TERMS: usize = 7;

/// A pair with its scratch: by itself a method of fixed steps, and an adaptive one in
/// [`Adaptive`](super::Adaptive).
pub(super) struct EmbeddedPair {
    tableau: &'static Tableau,
    /// State at which a stage is evaluated.
    stage: Vec<f64>,
    last: LastStep,
}

impl EmbeddedPair {
    pub fn new(tableau: &'static Tableau, dim: usize) -> Self {
        let stages = tableau.stages.len() + 2 + tableau.extra.len();
        Self { tableau, stage: vec![0.0; dim], last: LastStep::new(dim, stages) }
    }

    /// Evaluates the stages of a step of h (s) after [`begin`](Self::begin) or
    /// [`start_from_end`](Self::start_from_end). Returns their number.
    fn stages(&mut self, system: &dyn ParticleSystem, t: f64, h: f64) -> u64 {
        let tableau = self.tableau;
        self.last.h = h;
        self.last.dense = false;
        let LastStep { y0, k, .. } = &mut self.last;
        for (i, (c, a)) in tableau.stages.iter().enumerate() {
            combine(&mut self.stage, y0, h, a, k);
            system.eval_f(t + c * h, &self.stage, &mut k[i + 1]);
        }
        tableau.stages.len() as u64
    }

    /// Ends a step of h (s) at a state that was computed elsewhere.
    pub(super) fn end_at(&mut self, h: f64, y1: &[f64]) {
        self.last.h = h;
        self.last.dense = false;
        self.last.y1.copy_from_slice(y1);
    }

    /// Returns the state at the beginning of the step.
    pub(super) fn start(&self) -> &[f64] {
        &self.last.y0
    }

    /// Evaluates the derivative at the end of the step.
    pub(super) fn finish(&mut self, system: &dyn ParticleSystem, t: f64) -> Work {
        let last = self.tableau.stages.len() + 1;
        system.eval_f(t + self.last.h, &self.last.y1, &mut self.last.k[last]);
        Work::of(1)
    }
}

/// The end of a step.
struct EndTask<'a> {
    tableau: &'static Tableau,
    h: f64,
    y0: &'a [f64],
    k: &'a [Vec<f64>],
    /// Whether y1 still has to be computed.
    forms: bool,
    allowed: Option<&'a Allowed<'a>>,
}

/// Sums of squares: of y0, of y1 and of the estimated errors, over the allowed ones if there are
/// such.
impl OnBlock<1, 4> for EndTask<'_> {
    #[expect(
        clippy::inline_always,
        reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found"
    )]
    #[inline(always)]
    fn run(&self, numbers: Range<usize>, [y1]: Columns<1>) -> [f64; 4] {
        let Self { tableau, h, k, .. } = *self;
        let start = numbers.start;
        if self.forms {
            combine_block(start, y1, self.y0, h, tableau.weights, k);
        }
        let y0 = &self.y0[numbers.clone()];
        let mut errors = [0.0; 2];
        for (sum, weights) in errors.iter_mut().zip(tableau.errors) {
            let write = |error: &mut [f64]| add_to_block(start, error, h, weights, k);
            *sum = sum_of_squares(self.allowed, numbers.clone(), [y0, y1], write);
        }
        [dot(y0, y0), dot(y1, y1), errors[0], errors[1]]
    }
}

impl Trial for EmbeddedPair {
    fn dim(&self) -> usize {
        self.last.y0.len()
    }

    fn exponent(&self) -> f64 {
        self.tableau.exponent
    }

    fn begin(&mut self, system: &dyn ParticleSystem, t: f64, y: &[f64]) -> Work {
        self.last.y0.copy_from_slice(y);
        system.eval_f(t, y, &mut self.last.k[0]);
        Work::of(1)
    }

    fn start_from_end(&mut self) {
        let last = self.tableau.stages.len() + 1;
        self.last.k.swap(0, last);
        std::mem::swap(&mut self.last.y0, &mut self.last.y1);
    }

    fn derivative(&self, _system: &dyn ParticleSystem, out: &mut [f64]) {
        out.copy_from_slice(&self.last.k[0]);
    }

    fn attempt(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        norm: &ErrorNorm,
    ) -> (Work, f64) {
        let mut work = Work::of(self.stages(system, t, h));
        let tableau = self.tableau;
        let reads_end = tableau.errors[0].len() > tableau.stages.len() + 1;
        // Particles on rigid bodies are in no sum.
        let forms = reads_end || system.rigid().is_some();
        if forms {
            let LastStep { y0, y1, k, .. } = &mut self.last;
            combine(y1, y0, h, tableau.weights, k);
        }
        if reads_end {
            work += self.finish(system, t);
        }
        let LastStep { y0, y1, k, .. } = &mut self.last;
        let bands = threads(y0.len() / 6);
        let [error, other] = norm.of_sums(|numbers, allowed| {
            let end = EndTask { tableau, h, y0, k, forms: !forms, allowed };
            let y1 = &mut y1[numbers.clone()];
            add_up(bands, numbers, BLOCK, [y1], &end)
        });
        let error = match tableau.errors {
            [_, _] if error > 0.0 => error * error / (error * error + 0.01 * other * other).sqrt(),
            _ => error,
        };
        if !reads_end && error <= 1.0 {
            work += self.finish(system, t);
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
        let (h, tableau) = (self.last.h, self.tableau);
        let last = tableau.stages.len() + 1;
        let mut work = Work::default();
        if !self.last.dense {
            for (i, (c, a)) in tableau.extra.iter().enumerate() {
                combine(&mut self.stage, &self.last.y0, h, a, &self.last.k);
                system.eval_f(t + c * h, &self.stage, &mut self.last.k[last + 1 + i]);
            }
            self.last.dense = true;
            work = Work::of(tableau.extra.len() as u64);
        }
        if !tableau.powers.is_empty() {
            out.copy_from_slice(&self.last.y0);
            let mut factor = h;
            for weights in tableau.powers {
                factor *= theta;
                blocks(6, out, |start, out| {
                    add_to_block(start, out, factor, weights, &self.last.k);
                });
            }
            return work;
        }
        // y0 + theta (F0 + (1 - theta) (F1 + theta (F2 + (1 - theta) (F3 + ...)))): the factor of
        // each term.
        let mut factor = 1.0;
        let factors: [f64; MAX_TERMS] = std::array::from_fn(|i| {
            factor *= if i % 2 == 0 { theta } else { 1.0 - theta };
            factor
        });
        let [p, q, r, rest @ ..] = factors;
        // F0 = y1 - y0, F1 = h k0 - F0, F2 = 2 F0 - h (k0 + k1).
        let (of_f0, of_k0, of_k1) = (p - q + 2.0 * r, h * (q - r), -h * r);
        let LastStep { y0, y1, k, .. } = &self.last;
        blocks(6, out, |start, out| {
            let [y0, y1, k0, k1] = [y0, y1, &k[0], &k[last]].map(|a| &a[start..start + out.len()]);
            for ((((out, y0), y1), k0), k1) in out.iter_mut().zip(y0).zip(y1).zip(k0).zip(k1) {
                *out = y0 + of_f0 * (y1 - y0) + of_k0 * k0 + of_k1 * k1;
            }
            for (factor, weights) in rest.iter().zip(tableau.dense) {
                add_to_block(start, out, factor * h, weights, k);
            }
        });
        work
    }

    fn last(&self) -> LastStep {
        self.last.clone()
    }

    fn resume(&mut self, step: &LastStep) -> Result<(), Error> {
        self.last.resume(step)
    }
}

impl Integrator for EmbeddedPair {
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        check_dim(self.dim(), y)?;
        let mut work = self.begin(system, t, y);
        work += Work::of(self.stages(system, t, h));
        combine(y, &self.last.y0, h, self.tableau.weights, &self.last.k);
        Ok(work)
    }
}

/// Computes out = y + h sum weights k.
fn combine(out: &mut [f64], y: &[f64], h: f64, weights: &[f64], k: &[Vec<f64>]) {
    blocks(6, out, |start, out| {
        combine_block(start, out, y, h, weights, k);
    });
}

fn combine_block(
    start: usize,
    out: &mut [f64],
    y: &[f64],
    h: f64,
    weights: &[f64],
    k: &[Vec<f64>],
) {
    out.copy_from_slice(&y[start..start + out.len()]);
    add_to_block(start, out, h, weights, k);
}

/// Adds h sum weights k to a block of numbers, whose index of the first is `start`.
pub(super) fn add_to_block(start: usize, out: &mut [f64], h: f64, weights: &[f64], k: &[Vec<f64>]) {
    let block = start..start + out.len();
    let mut terms = weights
        .iter()
        .zip(k)
        .filter(|(weight, _)| **weight != 0.0)
        .map(|(weight, k)| (h * weight, &k[block.clone()]));
    while let Some(first) = terms.next() {
        let none = (0.0, first.1);
        let mut or_none = || terms.next().unwrap_or(none);
        let terms = [first, or_none(), or_none(), or_none()];
        Arch::new().dispatch(Add { out, terms });
    }
}

/// Sum of four terms, added to `out`.
struct Add<'a> {
    out: &'a mut [f64],
    terms: [(f64, &'a [f64]); 4],
}

impl WithSimd for Add<'_> {
    type Output = ();

    #[expect(
        clippy::inline_always,
        reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found"
    )]
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let [(a, p), (b, q), (c, r), (d, s)] = self.terms;
        for ((((out, p), q), r), s) in self.out.iter_mut().zip(p).zip(q).zip(r).zip(s) {
            *out += (a * p + b * q) + (c * r + d * s);
        }
    }
}

/// Runs `run` on blocks of numbers, each with its first index, on several threads if there are
/// many. Each particle has `each` numbers.
pub(super) fn blocks(each: usize, out: &mut [f64], run: impl Fn(usize, &mut [f64]) + Sync) {
    let bands = threads(out.len() / each);
    let rows = out.len().div_ceil(BLOCK);
    fork(bands, 0..rows, BLOCK, [out], &|rows, [out]| {
        for (block, out) in out.chunks_mut(BLOCK).enumerate() {
            run((rows.start + block) * BLOCK, out);
        }
    });
}
