//! A step in one sweep over a system's rows: each stage follows the one before it, a few rows behind, so that what passes
//! between them is still in the cache. On several threads, each sweeps over a band of rows, and over those beside it
//! that its own depend on.

use std::array;
use std::ops::Range;

use crate::rows::{REACH, Registers, Rows, Stage, Sweep, Window};
use crate::threads::{Columns, split_off, threads};

/// Particles that a stage goes through at a time.
const BLOCK: usize = 256;

/// Scratch for steps of a system of so many rows.
pub(super) struct Sweeper {
    rows: usize,
    cols: usize,
    bands: Vec<Band>,
}

impl Sweeper {
    pub fn new(system: &dyn Rows, stages: usize) -> Self {
        let particles = system.rows() * system.cols();
        Self::with_bands(system, stages, threads(particles))
    }

    pub fn with_bands(system: &dyn Rows, stages: usize, bands: usize) -> Self {
        let (rows, cols) = (system.rows(), system.cols());
        let bands = bands.clamp(1, rows);
        Self {
            rows,
            cols,
            bands: (0..bands)
                .map(|k| Band::new(k * rows / bands..(k + 1) * rows / bands, rows, cols, stages))
                .collect(),
        }
    }

    /// Whether it is for such a system.
    pub fn fits(&self, system: &dyn Rows) -> bool {
        (self.rows, self.cols) == (system.rows(), system.cols())
    }

    /// Takes y through the stages.
    pub fn step(&mut self, system: &dyn Rows, stages: &[Stage], y: &mut [f64]) {
        if self.bands.len() > 1 {
            for band in &mut self.bands {
                band.look_around(y);
            }
        }
        let mut columns = y.chunks_exact_mut(self.rows * self.cols);
        let columns = array::from_fn(|_| columns.next().unwrap_or_default());
        fork(&mut self.bands, system, stages, columns);
    }
}

fn fork(bands: &mut [Band], system: &dyn Rows, stages: &[Stage], mut y: Columns<6>) {
    if let [band] = bands {
        band.step(system, stages, y);
        return;
    }
    let (above, below) = bands.split_at_mut(bands.len() / 2);
    let at = (below[0].rows.start - above[0].rows.start) * above[0].cols;
    let firsts = split_off(&mut y, at);
    rayon::join(
        || fork(above, system, stages, firsts),
        || fork(below, system, stages, y),
    );
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
    fn step(&mut self, system: &dyn Rows, stages: &[Stage], mut y: Columns<6>) {
        system.begin(&mut self.sweep);
        let (mut loaded, mut front) = (self.seen.start, self.seen.start);
        loop {
            front += self.block;
            while loaded < (front + REACH).min(self.seen.end) {
                self.load(loaded, &y);
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
                    system.advance(stage, from..to, &mut self.registers, &mut self.sweep);
                    if number + 1 == stages.len() {
                        self.store(from.max(self.rows.start)..to, &mut y);
                        if to == end {
                            return;
                        }
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
            self.registers.y.column_mut(row, c).copy_from_slice(from);
            self.registers
                .stage
                .column_mut(row, c)
                .copy_from_slice(from);
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
