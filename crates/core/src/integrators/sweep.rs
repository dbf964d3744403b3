//! A step in one sweep over a system's rows: each stage follows the one before it, a few rows behind, so that what passes
//! between them is still in the cache. On several threads, each sweeps over a band of rows, and over those beside it
//! that its own depend on.

use std::array;
use std::ops::Range;

use crate::rows::{Part, REACH, Registers, Rows, Stage, Sweep, Window};
use crate::system::ParticleSystem;
use crate::threads::{Columns, split_off, threads};

/// Particles that a stage goes through at a time.
const BLOCK: usize = 256;

/// With fewer particles, what passes between one or two stages stays in the cache by itself (docs/performance.md).
const MANY: usize = 4096;
/// With wider rows, what is kept of a few takes more room than the whole state.
const WIDE: usize = 4096;

/// Scratch for steps of a system of so many rows.
pub(super) struct Sweeper {
    rows: usize,
    cols: usize,
    stages: usize,
    bands: Vec<Band>,
}

impl Sweeper {
    /// One for a system of rows, where it pays.
    pub fn new(system: &dyn ParticleSystem, stages: usize) -> Option<Self> {
        let rows = system.rows()?;
        let particles = rows.rows() * rows.cols();
        let pays = (stages > 2 || particles >= MANY) && rows.cols() <= WIDE;
        pays.then(|| Self::with_bands(rows, stages, threads(particles)))
    }

    pub fn with_bands(system: &dyn Rows, stages: usize, bands: usize) -> Self {
        let (rows, cols) = (system.rows(), system.cols());
        let bands = bands.clamp(1, rows);
        Self {
            rows,
            cols,
            stages,
            bands: (0..bands)
                .map(|k| Band::new(k * rows / bands..(k + 1) * rows / bands, rows, cols, stages))
                .collect(),
        }
    }

    /// Whether it is for such a system, and so many stages.
    pub fn fits(&self, system: &dyn Rows, stages: usize) -> bool {
        (self.rows, self.cols, self.stages) == (system.rows(), system.cols(), stages)
    }

    /// Takes y through the stages, after a drift from some time on.
    pub fn step(&mut self, system: &dyn Rows, lead: Option<Lead>, stages: &[Stage], y: &mut [f64]) {
        if self.bands.len() > 1 {
            for band in &mut self.bands {
                band.look_around(y);
            }
        }
        let mut columns = y.chunks_exact_mut(self.rows * self.cols);
        let columns = array::from_fn(|_| columns.next().unwrap_or_default());
        let job = Job {
            system,
            lead,
            stages,
        };
        fork(&mut self.bands, &job, columns);
    }
}

/// What a step begins with: a drift of such a length from some time (s).
pub(super) type Lead = (Part, (f64, f64));

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
    let at = (below[0].rows.start - above[0].rows.start) * above[0].cols;
    let firsts = split_off(&mut y, at);
    rayon::join(|| fork(above, job, firsts), || fork(below, job, y));
}

/// Some of the rows, and what a thread needs to step them.
struct Band {
    rows: Range<usize>,
    cols: usize,
    /// The rows that it sees, and y in those of them that are another's.
    seen: Range<usize>,
    above: Window,
    below: Window,
    /// Rows that a stage goes through at a time.
    block: usize,
    registers: Registers,
    sweep: Sweep,
}

impl Band {
    fn new(rows: Range<usize>, of: usize, cols: usize, stages: usize) -> Self {
        let seen = rows.start.saturating_sub(REACH * stages)..of.min(rows.end + REACH * stages);
        let block = (BLOCK / cols).max(1);
        let window = |depth: usize| Window::new(depth.max(1), 6, cols);
        let depth = block + REACH * stages;
        Self {
            cols,
            above: window(rows.start - seen.start),
            below: window(seen.end - rows.end),
            rows,
            seen,
            block,
            registers: Registers {
                y: window(depth),
                sum: window(depth),
                stage: window(depth),
            },
            sweep: Sweep::new(stages, cols),
        }
    }

    /// Copies the rows of other bands before these change them.
    fn look_around(&mut self, y: &[f64]) {
        let n = y.len() / 6;
        let copy = |rows: Range<usize>, to: &mut Window| {
            for row in rows {
                for c in 0..6 {
                    let from = c * n + row * self.cols;
                    to.column_mut(row, c)
                        .copy_from_slice(&y[from..from + self.cols]);
                }
            }
        };
        copy(self.seen.start..self.rows.start, &mut self.above);
        copy(self.rows.end..self.seen.end, &mut self.below);
    }

    /// Takes its rows of y through the stages.
    fn step(&mut self, job: &Job, mut y: Columns<6>) {
        let Job {
            system,
            lead,
            stages,
        } = job;
        system.begin(&mut self.sweep);
        let (mut loaded, mut front) = (self.seen.start, self.seen.start);
        loop {
            front += self.block;
            while loaded < (front + REACH).min(self.seen.end) {
                self.load(loaded, &y);
                if let Some((part, (t, h))) = *lead {
                    system.drift(part, t, h, loaded, &mut self.registers);
                }
                if stages[0].c.is_some() {
                    self.registers.begin(loaded);
                }
                loaded += 1;
            }
            for (number, stage) in stages.iter().enumerate() {
                // Fewer rows at either end than in the stage before, unless the system ends there.
                let more = REACH * (stages.len() - 1 - number);
                let first = self.rows.start.saturating_sub(more + REACH);
                let end = (self.rows.end + more).min(self.seen.end);
                let from = (front - self.block)
                    .saturating_sub(REACH * number)
                    .max(first);
                let to = front.saturating_sub(REACH * number).min(end);
                if from < to {
                    system.advance(
                        number,
                        stage,
                        from..to,
                        &mut self.registers,
                        &mut self.sweep,
                    );
                    if number + 1 == stages.len() {
                        self.store(from.max(self.rows.start)..to, &mut y);
                        if to == end {
                            return;
                        }
                    } else if stage.c.is_none() && stages[number + 1].c.is_some() {
                        (from..to).for_each(|row| self.registers.begin(row));
                    }
                }
            }
        }
    }

    /// Takes in a row.
    fn load(&mut self, row: usize, y: &Columns<6>) {
        for (c, y) in y.iter().enumerate() {
            let from = if row < self.rows.start {
                self.above.column(row, c)
            } else if row < self.rows.end {
                &y[(row - self.rows.start) * self.cols..][..self.cols]
            } else {
                self.below.column(row, c)
            };
            self.registers.stage.load(row, c, from);
        }
    }

    /// Gives out rows that are done.
    fn store(&self, rows: Range<usize>, y: &mut Columns<6>) {
        for row in rows {
            let at = (row - self.rows.start) * self.cols;
            for (c, y) in y.iter_mut().enumerate() {
                y[at..at + self.cols].copy_from_slice(self.registers.stage.column(row, c));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrators::runge_kutta::{EULER, RK4, RungeKutta, Table};
    use crate::integrators::splitting::Plan;
    use crate::integrators::{Integrator, pefrl, symplectic_euler, verlet};
    use crate::testing::cloth;
    use crate::{Grid, Scene};

    enum Of {
        Table(Table),
        Plan(&'static Plan),
    }

    /// The state after some steps, in such bands, or with whole arrays.
    fn after(scene: &Scene, method: &Of, bands: Option<usize>) -> Vec<f64> {
        let system = scene.model.system();
        let sweeper =
            |stages| bands.map(|bands| Sweeper::with_bands(system.rows().unwrap(), stages, bands));
        let mut method: Box<dyn Integrator> = match method {
            Of::Table(table) => {
                Box::new(RungeKutta::with(table, system.dim(), sweeper(table.len())))
            }
            Of::Plan(plan) => plan.with(system, sweeper(plan.stages_of_sweep(system))),
        };
        let mut y = scene.state.clone();
        for k in 0..5 {
            method
                .step(system, 1e-3 * f64::from(k), 1e-3, &mut y)
                .unwrap();
        }
        assert!(y.iter().all(|y| y.is_finite()) && y != scene.state);
        y
    }

    #[test]
    fn sweeps_in_any_bands_give_the_bits_of_whole_arrays() {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(3)
            .build()
            .unwrap();
        for (rows, cols) in [(2, 2), (3, 7), (20, 20), (9, 300), (70, 5)] {
            for damping_time in [0.0, 5e-4] {
                let scene = cloth(Grid::new(rows, cols).unwrap(), damping_time);
                for (k, method) in [
                    Of::Table(EULER),
                    Of::Table(RK4),
                    Of::Plan(&symplectic_euler::PLAN),
                    Of::Plan(&verlet::PLAN),
                    Of::Plan(&pefrl::PLAN),
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

    /// A state that was lost leaves nothing behind: what is beside the rows is zero again.
    #[test]
    fn a_step_is_a_function_of_its_arguments() {
        let grid = Grid::new(11, 13).unwrap();
        let scene = cloth(grid, 5e-4);
        let system = scene.model.system();
        let sweeper = || Some(Sweeper::with_bands(system.rows().unwrap(), RK4.len(), 2));
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
