//! A step in one sweep over a system's rows: each stage follows the one before it, a few rows
//! behind, so that their data are still in the cache. Patches of rows are swept one by one. On
//! several threads, each sweeps over a band of rows, and over the adjacent rows that it depends on.
//!
//! Explicit Runge-Kutta methods in which each stage depends only on the one before it: k1 = f(t,
//! y), k2 = f(t + c2 h, y + c2 h k1), k3 = f(t + c3 h, y + c3 h k2), ..., y1 = y + h (b1 k1 + b2 k2
//! + ...).

use std::array;
use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::integrator::{Integrator, check_dim};
use crate::error::Error;
use crate::fused::mul_adds;
use crate::rows::{Next, Patch, REACH, Registers, Rows, Stage, SweepScratch, Terms, Window};
use crate::system::{ParticleSystem, rows_of};
use crate::threads::{Columns, split_off, threads};
use crate::vectors::Arch;
use crate::work::Work;

/// Number of particles that a stage processes at a time.
const BLOCK: usize = 256;

/// Number of particles below which the data of up to three stages stay in the cache anyway
/// (docs/performance.md).
const MIN_PARTICLES: usize = 4096;
/// Number of columns above which the rows kept by a sweep take more memory than the whole state.
const MAX_COLUMNS: usize = 4096;

/// Scratch for steps of a system of rows.
pub(super) struct Sweeper {
    /// Patches in the order of their numbers.
    patches: Vec<Patch>,
    stages: usize,
    /// Bands in the order of their particles.
    bands: Vec<Band>,
}

impl Sweeper {
    /// Creates a sweeper for a system of rows, if it is faster than whole arrays.
    pub fn new(system: &dyn ParticleSystem, stages: usize) -> Option<Self> {
        let rows = rows_of(system)?;
        let patches: Vec<_> = (0..rows.patches()).map(|k| rows.patch(k)).collect();
        let particles = patches.iter().map(Patch::particles).sum();
        let widest = patches.iter().map(|patch| patch.cols).max()?;
        let pays = (stages > 3 || particles >= MIN_PARTICLES) && widest <= MAX_COLUMNS;
        let share = |patch: &Patch| (threads(particles) * patch.particles()).div_ceil(particles);
        pays.then(|| Self::with_bands(rows, stages, share))
    }

    /// Creates a sweeper with a number of bands for each patch.
    pub fn with_bands(system: &dyn Rows, stages: usize, bands: impl Fn(&Patch) -> usize) -> Self {
        let patches: Vec<_> = (0..system.patches()).map(|k| system.patch(k)).collect();
        let mut all = vec![];
        for (number, patch) in patches.iter().enumerate() {
            let bands = bands(patch).clamp(1, patch.rows);
            all.extend((0..bands).map(|k| {
                let rows = k * patch.rows / bands..(k + 1) * patch.rows / bands;
                Band::new(system, (number, *patch), rows, stages)
            }));
        }
        all.sort_by_key(Band::first);
        Self { patches, stages, bands: all }
    }

    /// Returns whether the sweeper is for this system and number of stages.
    pub fn fits(&self, system: &dyn Rows, stages: usize) -> bool {
        let patches = (0..system.patches()).map(|k| system.patch(k));
        self.stages == stages && patches.eq(self.patches.iter().copied())
    }

    /// Advances y through the stages, after a drift if the step begins with one.
    pub fn step(&mut self, system: &dyn Rows, lead: Option<Lead>, stages: &[Stage], y: &mut [f64]) {
        for band in &mut self.bands {
            band.copy_neighbours(y);
        }
        let mut columns = y.chunks_exact_mut(y.len() / 6);
        let columns = array::from_fn(|_| columns.next().unwrap_or_default());
        let job = Job { system, lead, stages };
        fork(&mut self.bands, &job, columns);
    }
}

/// The drift at the beginning of a step: its terms, its time and its length (s).
type Lead = (Terms, (f64, f64));

struct Job<'a> {
    system: &'a dyn Rows,
    lead: Option<Lead>,
    stages: &'a [Stage],
}

fn fork(bands: &mut [Band], job: &Job, mut y: Columns<6>) {
    if let [band] = bands {
        band.step(job, y);
        return;
    }
    let (above, below) = bands.split_at_mut(bands.len() / 2);
    let firsts = split_off(&mut y, below[0].first() - above[0].first());
    rayon::join(|| fork(above, job, firsts), || fork(below, job, y));
}

/// Some rows of a patch, with everything that a thread needs to step them.
struct Band {
    /// Number of the patch.
    number: usize,
    patch: Patch,
    rows: Range<usize>,
    /// All rows that it depends on; `above` and `below` are copies of y in those of other bands.
    seen: Range<usize>,
    above: Window,
    below: Window,
    /// Number of rows that a stage processes at a time.
    block: usize,
    registers: Registers,
    scratch: SweepScratch,
}

impl Band {
    fn new(
        system: &dyn Rows,
        (number, patch): (usize, Patch),
        rows: Range<usize>,
        stages: usize,
    ) -> Self {
        let cols = patch.cols;
        let more = REACH * stages;
        let seen = rows.start.saturating_sub(more)..patch.rows.min(rows.end + more);
        let block = (BLOCK / cols).max(1);
        let window = |depth: usize| Window::new(depth.max(1), 6, cols);
        Self {
            number,
            patch,
            above: window(rows.start - seen.start),
            below: window(seen.end - rows.end),
            rows,
            seen,
            block,
            registers: Registers::new(block + more, cols),
            scratch: SweepScratch::new(system, stages, cols),
        }
    }

    /// Returns the number of the band's first particle.
    fn first(&self) -> usize {
        self.patch.row(self.rows.start).start
    }

    /// Copies the rows of other bands that it depends on, before these change them.
    fn copy_neighbours(&mut self, y: &[f64]) {
        let (n, patch) = (y.len() / 6, self.patch);
        let copy = |rows: Range<usize>, to: &mut Window| {
            for row in rows {
                for c in 0..6 {
                    let from = &y[c * n..(c + 1) * n][patch.row(row)];
                    to.column_mut(row, c).copy_from_slice(from);
                }
            }
        };
        copy(self.seen.start..self.rows.start, &mut self.above);
        copy(self.rows.end..self.seen.end, &mut self.below);
    }

    /// Advances its rows of y through the stages.
    fn step(&mut self, job: &Job, mut y: Columns<6>) {
        let Job { system, lead, stages } = job;
        system.begin(self.number, &mut self.scratch);
        let (mut loaded, mut front) = (self.seen.start, self.seen.start);
        loop {
            front += self.block;
            while loaded < (front + REACH).min(self.seen.end) {
                self.load(loaded, &y);
                if let Some((terms, times)) = *lead {
                    system.drift(self.number, terms, times, loaded, &mut self.registers);
                }
                if stages[0].next.is_from_y() {
                    self.registers.begin(loaded);
                }
                loaded += 1;
            }
            for (number, stage) in stages.iter().enumerate() {
                // At either end a few rows less than in the stage before, unless the system ends
                // there.
                let more = REACH * (stages.len() - 1 - number);
                let first = self.rows.start.saturating_sub(more + REACH);
                let end = (self.rows.end + more).min(self.seen.end);
                let from = (front - self.block).saturating_sub(REACH * number).max(first);
                let to = front.saturating_sub(REACH * number).min(end);
                if from < to {
                    system.advance(
                        self.number,
                        number,
                        stage,
                        from..to,
                        &mut self.registers,
                        &mut self.scratch,
                    );
                    if number + 1 == stages.len() {
                        self.store(from.max(self.rows.start)..to, &mut y);
                        if to == end {
                            return;
                        }
                    } else if stage.next.is_ahead() {
                        (from..to).for_each(|row| self.registers.look_ahead(row));
                    } else if stage.next == Next::Sum && stages[number + 1].next.is_from_y() {
                        (from..to).for_each(|row| self.registers.begin(row));
                    }
                }
            }
        }
    }

    /// Loads a row.
    fn load(&mut self, row: usize, y: &Columns<6>) {
        let cols = self.patch.cols;
        for (c, y) in y.iter().enumerate() {
            let from = if row < self.rows.start {
                self.above.column(row, c)
            } else if row < self.rows.end {
                &y[(row - self.rows.start) * cols..][..cols]
            } else {
                self.below.column(row, c)
            };
            self.registers.stage.load(row, c, from);
        }
    }

    /// Stores rows that are done.
    fn store(&self, rows: Range<usize>, y: &mut Columns<6>) {
        for row in rows {
            let cols = self.patch.cols;
            let at = (row - self.rows.start) * cols;
            for (c, y) in y.iter_mut().enumerate() {
                y[at..at + cols].copy_from_slice(self.registers.stage.column(row, c));
            }
        }
    }
}

/// Coefficients (c, b) of each stage.
pub(super) type Table = &'static [(f64, f64)];

pub(super) const EULER: Table = &[(0.0, 1.0)];
pub(super) const HEUN: Table = &[(0.0, 0.5), (1.0, 0.5)];
pub(super) const MIDPOINT: Table = &[(0.0, 0.0), (0.5, 1.0)];
pub(super) const RK4: Table =
    &[(0.0, 1.0 / 6.0), (0.5, 1.0 / 3.0), (0.5, 1.0 / 3.0), (1.0, 1.0 / 6.0)];

/// Lists the stages of a step from t to t + h (s).
pub(super) fn stages(table: Table, terms: Terms, t: f64, h: f64) -> impl Iterator<Item = Stage> {
    table.iter().enumerate().map(move |(i, (c, b))| Stage {
        terms,
        t: t + c * h,
        until: table.get(i + 1).map_or(t + h, |(c, _)| t + c * h),
        first: i == 0,
        b: h * b,
        next: table.get(i + 1).map_or(Next::Sum, |(c, _)| Next::FromY(h * c)),
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

/// Computes y += h k.
pub(crate) fn add_scaled(y: &mut [f64], h: f64, k: &[f64]) {
    for (y, k) in y.iter_mut().zip(k) {
        *y += h * k;
    }
}

/// Computes out = y + h k.
pub(super) fn scaled_sum(out: &mut [f64], y: &[f64], h: f64, k: &[f64]) {
    for ((out, y), k) in out.iter_mut().zip(y).zip(k) {
        *out = y + h * k;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrators::splitting::Plan;
    use crate::integrators::sweep::{EULER, RK4, RungeKutta, Table};
    use crate::integrators::{Integrator, kicks};
    use crate::testing::cloth;
    use crate::{Grid, Scene};

    enum Kind {
        Table(Table),
        Plan(&'static Plan),
    }

    /// Returns the state after some steps, in a number of bands, or with whole arrays.
    fn after(scene: &Scene, method: &Kind, bands: Option<usize>) -> Vec<f64> {
        let system = scene.model.system();
        let sweeper = |stages| {
            bands.map(|bands| Sweeper::with_bands(rows_of(system).unwrap(), stages, |_| bands))
        };
        let mut method: Box<dyn Integrator> = match method {
            Kind::Table(table) => {
                Box::new(RungeKutta::with(table, system.dim(), sweeper(table.len())))
            }
            Kind::Plan(plan) => plan.with(system, sweeper(plan.stages_of_sweep(system))),
        };
        let mut y = scene.state.clone();
        for k in 0..5 {
            method.step(system, 1e-3 * f64::from(k), 1e-3, &mut y).unwrap();
        }
        assert!(y.iter().all(|y| y.is_finite()) && y != scene.state);
        y
    }

    #[test]
    #[cfg_attr(miri, ignore = "takes hours there")]
    fn sweeps_in_any_bands_give_the_bits_of_whole_arrays() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        for (rows, cols) in [(2, 2), (3, 7), (20, 20), (9, 300), (70, 5)] {
            for damping_time in [0.0, 5e-4] {
                let scene = cloth(Grid::new(rows, cols).unwrap(), damping_time);
                for (k, method) in [
                    Kind::Table(EULER),
                    Kind::Table(RK4),
                    Kind::Plan(&kicks::SYMPLECTIC_EULER_PLAN),
                    Kind::Plan(&kicks::VERLET_PLAN),
                    Kind::Plan(&kicks::PEFRL_PLAN),
                ]
                .iter()
                .enumerate()
                {
                    let expected = after(&scene, method, None);
                    for bands in [1, 2, 3, 4, 8] {
                        let found = pool.install(|| after(&scene, method, Some(bands)));
                        assert!(
                            found == expected,
                            "{rows}x{cols}, damped {damping_time} s, {k}, {bands} bands"
                        );
                    }
                }
            }
        }
    }

    /// A state that blew up has no effect on the next one: scratch beside the rows is zero again.
    #[test]
    fn a_step_is_a_function_of_its_arguments() {
        let grid = Grid::new(11, 13).unwrap();
        let scene = cloth(grid, 5e-4);
        let system = scene.model.system();
        let sweeper = || Some(Sweeper::with_bands(rows_of(system).unwrap(), RK4.len(), |_| 2));
        let step = |method: &mut RungeKutta, mut y: Vec<f64>| {
            method.step(system, 0.0, 1e-3, &mut y).unwrap();
            y
        };
        let mut used = RungeKutta::with(RK4, system.dim(), sweeper());
        let lost = step(&mut used, vec![f64::NAN; system.dim()]);
        assert!(lost.iter().any(|y| y.is_nan()));
        let mut fresh = RungeKutta::with(RK4, system.dim(), sweeper());
        let expected = step(&mut fresh, scene.state.clone());
        assert!(step(&mut used, scene.state.clone()) == expected);
    }
}
