//! Particles in rows of which only near ones act on each other. A whole step can then go over them
//! once, all of its stages a few rows apart: what it needs in between stays in the cache.

use std::array;
use std::ops::Range;

/// Largest distance of rows that act on each other.
pub(crate) const REACH: usize = 2;
/// Numbers beside a column on either side: as many as the longest vector has, for particles that
/// are not there.
pub(crate) const PAD: usize = 8;

/// The terms that a stage evaluates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Terms {
    /// All of y' = \[v | F / m\].
    Motion,
    /// v' = F / m of the forces that no drift carries (see [`Splitting`](crate::Splitting)), x
    /// standing still.
    KickForces,
    /// v' = F / m of all forces, x standing still: drifts carry none.
    AllForces,
}

/// A stage of a step: k = f(t, stage), sum + b k, and what the next stage is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stage {
    /// The terms that it evaluates.
    pub terms: Terms,
    /// Time of its evaluation (s).
    pub t: f64,
    /// Time of the next stage's evaluation, or of the end of the step after the last one (s).
    pub until: f64,
    /// Whether it is the method's first one: the sum then begins with the stage.
    pub first: bool,
    /// Weight b of its k in the sum (s).
    pub b: f64,
    /// What the next stage is.
    pub next: Next,
    /// Length of the drift that follows (s).
    pub drift: f64,
}

/// What follows a stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Next {
    /// The sum: the new state, or that from which another method begins.
    Sum,
    /// y + c k with this c (s), as in an explicit Runge-Kutta method whose stages read only the one
    /// before them.
    FromY(f64),
    /// The sum after the drift, ahead of it by e = `keep` e + `add` k, `add` in s. There is no e
    /// before the first stage.
    Ahead {
        /// Share of e that is kept.
        keep: f64,
        /// Weight of k in e (s).
        add: f64,
    },
}

impl Next {
    /// Whether the next stage is found from the y at which the method began.
    pub fn is_from_y(self) -> bool {
        matches!(self, Self::FromY(_))
    }

    /// Whether the next stage is ahead of the sum.
    pub fn is_ahead(self) -> bool {
        matches!(self, Self::Ahead { .. })
    }
}

/// Some particles of a system that stand in rows, numbered row by row, and that no others act on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Patch {
    /// Number of its first particle in the system.
    pub first: usize,
    /// Number of rows.
    pub rows: usize,
    /// Particles in a row.
    pub cols: usize,
}

impl Patch {
    /// Number of particles.
    pub fn particles(&self) -> usize {
        self.rows * self.cols
    }

    /// Numbers of the particles in a row.
    pub fn row(&self, row: usize) -> Range<usize> {
        self.first + row * self.cols..self.first + (row + 1) * self.cols
    }
}

/// A system whose particles all stand in rows and feel those at most [`REACH`] rows away, and no
/// others. Its steps in a sweep must be those by whole arrays to the last bit.
pub(crate) trait Rows: Sync {
    /// Number of patches, which do not act on one another.
    fn patches(&self) -> usize;

    /// The patch of a number; each particle is in one of them.
    fn patch(&self, patch: usize) -> Patch;

    /// Columns of numbers that each stage keeps from row to row.
    fn kept_columns(&self) -> usize;

    /// Numbers that a sweep shares among all rows and stages.
    fn shared_numbers(&self) -> usize;

    /// Prepares the scratch of a sweep over some rows of a patch.
    fn begin(&self, patch: usize, scratch: &mut SweepScratch);

    /// Takes the stage's row through a drift of h from time t, to where pins are at t + h.
    fn drift(
        &self,
        patch: usize,
        terms: Terms,
        times: (f64, f64),
        row: usize,
        registers: &mut Registers,
    );

    /// Takes rows of a patch through stage `number` of the sweep and the drift that follows it, to
    /// where pins are at the end. Rows come in their order, from some row on: the first [`REACH`]
    /// of them may come out wrong unless they are the first of the patch. Rows up to [`REACH`]
    /// below them are still in the stage, those above no more.
    fn advance(
        &self,
        patch: usize,
        number: usize,
        stage: &Stage,
        rows: Range<usize>,
        registers: &mut Registers,
        scratch: &mut SweepScratch,
    );
}

/// The numbers of some rows during a step, six columns each, x y z of positions and of velocities:
/// y as it was, or how far the stage is ahead of the sum; the sum over the stages; and the stage
/// under way.
pub(crate) struct Registers {
    pub(crate) y: Window,
    pub(crate) sum: Window,
    pub(crate) stage: Window,
}

impl Registers {
    /// Registers of `depth` rows at a time.
    pub(crate) fn new(depth: usize, cols: usize) -> Self {
        let window = || Window::new(depth, 6, cols);
        Self {
            y: window(),
            sum: window(),
            stage: window(),
        }
    }

    /// Starts the next Runge-Kutta substep from the current stage values.
    pub(crate) fn begin(&mut self, row: usize) {
        self.y.row_mut(row).copy_from_slice(self.stage.row(row));
    }

    /// Takes the velocities of a row, which are at the sum, ahead of it.
    pub(crate) fn look_ahead(&mut self, row: usize) {
        for column in 3..6 {
            let (stage, ahead) = (
                self.stage.column_mut(row, column),
                self.y.column(row, column),
            );
            self.sum.column_mut(row, column).copy_from_slice(stage);
            for (v, ahead) in stage.iter_mut().zip(ahead) {
                *v += ahead;
            }
        }
    }

    /// Columns of a row of the stage under way.
    pub fn stage(&self, row: usize) -> [&[f64]; 6] {
        array::from_fn(|column| self.stage.column(row, column))
    }

    /// Columns of a row of the stage under way.
    pub fn stage_mut(&mut self, row: usize) -> [&mut [f64]; 6] {
        self.stage.columns_mut(row)
    }
}

/// Numbers that the rows of a sweep hand on to those below them, stage by stage, and that they all
/// read.
pub(crate) struct SweepScratch {
    pub(crate) shared: Window,
    /// A row for each stage.
    pub(crate) kept: Window,
    /// Addends to the forces on one row, by axis.
    pub(crate) addends: Window,
}

impl SweepScratch {
    /// Scratch for rows of so many particles.
    pub(crate) fn new(system: &dyn Rows, stages: usize, cols: usize) -> Self {
        Self {
            shared: Window::new(1, 1, system.shared_numbers()),
            kept: Window::new(stages, system.kept_columns(), cols),
            addends: Window::new(1, 3, cols),
        }
    }

    /// Numbers shared by all rows and stages.
    pub fn shared_mut(&mut self) -> &mut [f64] {
        self.shared.column_mut(0, 0)
    }

    /// Columns of forces on a row that are added to those of its own, by axis.
    pub(crate) fn addends_mut(&mut self) -> [&mut [f64]; 3] {
        let [x, y, z, ..] = self.addends.columns_mut(0);
        [x, y, z]
    }

    /// Sets all that stages keep to zero.
    pub fn clear_kept(&mut self) {
        self.kept.data.fill(0.0);
    }
}

/// Ring buffer of `depth` matrix rows: rows r and r + depth share a slot. Each row is some columns
/// of numbers, with zeros before and after, aligned for the processor's vectors.
pub(crate) struct Window {
    data: Vec<f64>,
    start: usize,
    depth: usize,
    columns: usize,
    stride: usize,
    cols: usize,
}

impl Window {
    pub fn new(depth: usize, columns: usize, cols: usize) -> Self {
        let stride = stride(cols);
        let data = vec![0.0; depth * columns * stride + PAD];
        // At a multiple of eight numbers, a cache line.
        let start = data.as_ptr().align_offset(PAD * size_of::<f64>()).min(PAD);
        Self {
            data,
            start,
            depth,
            columns,
            stride,
            cols,
        }
    }

    #[inline]
    fn place(&self, row: usize) -> Range<usize> {
        let length = self.columns * self.stride;
        let start = self.start + row % self.depth * length;
        start..start + length
    }

    /// All columns of a row, and what is beside them.
    #[inline]
    pub fn row(&self, row: usize) -> &[f64] {
        &self.data[self.place(row)]
    }

    /// All columns of a row, and what is beside them.
    #[inline]
    pub fn row_mut(&mut self, row: usize) -> &mut [f64] {
        let place = self.place(row);
        &mut self.data[place]
    }

    /// Three rows after one another, in a window that is at least as deep.
    #[inline]
    pub fn three_mut(&mut self, row: usize) -> [&mut [f64]; 3] {
        let places = [self.place(row), self.place(row + 1), self.place(row + 2)];
        self.data
            .get_disjoint_mut(places)
            .expect("rows of a window that is three deep are three")
    }

    /// Fills a column of a row, and the vector that it ends in with zeros: a state that was lost
    /// may have left others.
    pub fn load(&mut self, row: usize, column: usize, from: &[f64]) {
        let (stride, cols) = (self.stride, self.cols);
        let to = &mut self.row_mut(row)[column * stride + PAD..][..cols.next_multiple_of(PAD)];
        to[..cols].copy_from_slice(from);
        to[cols..].fill(0.0);
    }

    /// The first six columns of a row.
    pub fn columns_mut(&mut self, row: usize) -> [&mut [f64]; 6] {
        let (stride, cols) = (self.stride, self.cols);
        let mut columns = self.row_mut(row).chunks_exact_mut(stride);
        array::from_fn(|_| match columns.next() {
            Some(column) => &mut column[PAD..PAD + cols],
            None => &mut [],
        })
    }

    /// A column of a row.
    #[inline]
    pub fn column(&self, row: usize, column: usize) -> &[f64] {
        &self.row(row)[column * self.stride + PAD..][..self.cols]
    }

    /// A column of a row.
    #[inline]
    pub fn column_mut(&mut self, row: usize, column: usize) -> &mut [f64] {
        let (stride, cols) = (self.stride, self.cols);
        &mut self.row_mut(row)[column * stride + PAD..][..cols]
    }
}

/// Numbers from one column of so many to the next: an odd number of cache lines, because the
/// processor takes numbers that are a power of two apart for one another.
pub(crate) const fn stride(cols: usize) -> usize {
    ((cols.div_ceil(PAD) + 2) | 1) * PAD
}
