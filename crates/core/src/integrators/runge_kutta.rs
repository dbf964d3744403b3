//! Explicit Runge-Kutta methods in which each stage depends only on the one before it: k1 = f(t,
//! y), k2 = f(t + c2 h, y + c2 h k1), k3 = f(t + c3 h, y + c3 h k2), ..., y1 = y + h (b1 k1 + b2 k2
//! + ...).

use pulp::{Simd, WithSimd};

use super::integrator::{Integrator, check_dim};
use super::sweep::Sweeper;
use crate::error::Error;
use crate::fused::mul_adds;
use crate::rows::{Next, Stage, Terms};
use crate::system::{ParticleSystem, rows_of};
use crate::vectors::Arch;
use crate::work::Work;

/// Coefficients (c, b) of each stage.
pub(super) type Table = &'static [(f64, f64)];

pub(super) const EULER: Table = &[(0.0, 1.0)];
pub(super) const HEUN: Table = &[(0.0, 0.5), (1.0, 0.5)];
pub(super) const MIDPOINT: Table = &[(0.0, 0.0), (0.5, 1.0)];
pub(super) const RK4: Table = &[
    (0.0, 1.0 / 6.0),
    (0.5, 1.0 / 3.0),
    (0.5, 1.0 / 3.0),
    (1.0, 1.0 / 6.0),
];

/// Lists the stages of a step from t to t + h (s).
pub(super) fn stages(table: Table, terms: Terms, t: f64, h: f64) -> impl Iterator<Item = Stage> {
    table.iter().enumerate().map(move |(i, (c, b))| Stage {
        terms,
        t: t + c * h,
        until: table.get(i + 1).map_or(t + h, |(c, _)| t + c * h),
        first: i == 0,
        b: h * b,
        next: table
            .get(i + 1)
            .map_or(Next::Sum, |(c, _)| Next::FromY(h * c)),
        drift: 0.0,
    })
}

/// Method given by a table, with its scratch.
pub(super) struct RungeKutta {
    table: Table,
    dim: usize,
    /// Scratch for systems of rows; `None` for others.
    sweeper: Option<Sweeper>,
    stages: Vec<Stage>,
    /// Scratch for other systems: the y of the current stage, the sum y + b1 h k1 + b2 h k2 + ...,
    /// and the last k.
    stage: Vec<f64>,
    sum: Vec<f64>,
    k: Vec<f64>,
}

impl RungeKutta {
    pub fn new(table: Table, system: &dyn ParticleSystem) -> Self {
        Self::with(table, system.dim(), Sweeper::new(system, table.len()))
    }

    pub(super) fn with(table: Table, dim: usize, sweeper: Option<Sweeper>) -> Self {
        let length = if sweeper.is_some() { 0 } else { dim };
        Self {
            table,
            dim,
            sweeper,
            stages: Vec::with_capacity(table.len()),
            stage: vec![0.0; length],
            sum: vec![0.0; length],
            k: vec![0.0; length],
        }
    }
}

impl Integrator for RungeKutta {
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        check_dim(self.dim, y)?;
        self.stages.clear();
        self.stages.extend(stages(self.table, Terms::Motion, t, h));
        match (&mut self.sweeper, rows_of(system)) {
            (Some(sweeper), Some(system)) if sweeper.fits(system, self.stages.len()) => {
                sweeper.step(system, None, &self.stages, y);
            }
            _ => {
                // An integrator made for rows has no scratch for whole arrays yet.
                for scratch in [&mut self.stage, &mut self.sum, &mut self.k] {
                    scratch.resize(self.dim, 0.0);
                }
                self.stage.copy_from_slice(y);
                for stage in &self.stages {
                    system.eval_f(stage.t, &self.stage, &mut self.k);
                    Arch::new().dispatch(Combine {
                        stage,
                        y,
                        sum: &mut self.sum,
                        next: &mut self.stage,
                        k: &self.k,
                    });
                }
                y.copy_from_slice(&self.stage);
            }
        }
        Ok(Work::of(self.table.len() as u64))
    }
}

/// Step from one stage to the next on whole arrays: adds the stage's k to the sum and computes the
/// next stage or the new state. For [`Next::Ahead`], `next` is the sum, and y the distance by which
/// the next stage will be ahead of it.
pub(super) struct Combine<'a> {
    pub stage: &'a Stage,
    pub y: &'a mut [f64],
    pub sum: &'a mut [f64],
    pub next: &'a mut [f64],
    pub k: &'a [f64],
}

impl WithSimd for Combine<'_> {
    type Output = ();

    #[expect(
        clippy::inline_always,
        reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found"
    )]
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (y, y_rest) = S::as_mut_simd_f64s(self.y);
        let (sum, sum_rest) = S::as_mut_simd_f64s(self.sum);
        let (next, next_rest) = S::as_mut_simd_f64s(self.next);
        let (k, k_rest) = S::as_simd_f64s(self.k);
        combine(simd, self.stage, [y, sum, next], k);
        let rest = [y_rest, sum_rest, next_rest];
        combine(pulp::Scalar::new(), self.stage, rest, k_rest);
    }
}

#[expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found"
)]
#[inline(always)]
fn combine<S: Simd>(simd: S, stage: &Stage, [y, sum, next]: [&mut [S::f64s]; 3], k: &[S::f64s]) {
    let b = simd.splat_f64s(stage.b);
    for (((y, k), sum), next) in y.iter_mut().zip(k).zip(sum).zip(next) {
        let before = if stage.first { *next } else { *sum };
        let after = mul_adds(simd, b, *k, before);
        *next = match stage.next {
            Next::Sum => after,
            Next::FromY(c) => {
                *sum = after;
                mul_adds(simd, simd.splat_f64s(c), *k, *y)
            }
            Next::Ahead { keep, add } => {
                let more = simd.mul_f64s(simd.splat_f64s(add), *k);
                *y = if stage.first {
                    more
                } else {
                    mul_adds(simd, simd.splat_f64s(keep), *y, more)
                };
                after
            }
        };
    }
}
