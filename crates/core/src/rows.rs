//! Systems of particles in rows, where only near rows act on each other. A whole step can then
//! sweep over the rows once, with all of its stages a few rows apart, so that the intermediate
//! numbers stay in the cache.

use std::array;
use std::ops::Range;

/// Largest distance of rows that act on each other.
pub(crate) const REACH: usize = 2;
/// Length of the padding on either side of a column, which stands for neighbours beyond the end of
/// a row: that of the longest SIMD vector.
pub(crate) const PAD: usize = 8;

/// Terms of y' = f that a stage evaluates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Terms {
    /// All of y' = \[v | F / m\].
    Motion,
    /// v' = F / m of the forces that drifts leave out (see [`Splitting`](crate::Splitting)), with x
    /// constant.
    KickForces,
    /// v' = F / m of all forces, with x constant: drifts have none.
    AllForces,
}

/// A stage of a step: it evaluates k = f(t, stage), adds b k to the sum, and forms the next stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stage {
    /// Terms that it evaluates.
    pub terms: Terms,
    /// Time of its evaluation (s).
    pub t: f64,
    /// Time of the next stage's evaluation, or of the end of the step after the last one (s).
    pub until: f64,
    /// Whether it is the first stage of the method: the sum then begins with the stage itself.
    pub first: bool,
    /// Weight b of k in the sum (s).
    pub b: f64,
    /// Rule for the next stage.
    pub next: Next,
    /// Length of the drift that follows (s).
    pub drift: f64,
}

/// Rule by which the next stage is formed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Next {
    /// The sum: the new state, or the first stage of the next substep.
    Sum,
    /// y + c k with this c (s), as in an explicit Runge-Kutta method whose stages depend only on
    /// the one before.
    FromY(f64),
    /// The sum after the drift, plus an extrapolation e of the velocities, which each stage updates
    /// to `keep` e + `add` k. e is 0 before the first stage.
    Ahead {
        /// Fraction of e that is kept.
        keep: f64,
        /// Weight of k in e (s).
        add: f64,
    },
}

impl Next {
    /// Returns whether the next stage is formed from the y at which the step began.
    pub fn is_from_y(self) -> bool {
        matches!(self, Self::FromY(_))
    }

    /// Returns whether the next stage is extrapolated from the sum.
    pub fn is_ahead(self) -> bool {
        matches!(self, Self::Ahead { .. })
    }
}

/// Particles of a system that stand in rows, are numbered row by row, and do not interact with
/// others.
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
    /// Returns the number of particles.
    pub fn particles(&self) -> usize {
        self.rows * self.cols
    }

    /// Returns the numbers of the particles in a row.
    pub fn row(&self, row: usize) -> Range<usize> {
        self.first + row * self.cols..self.first + (row + 1) * self.cols
    }
}

/// A system whose particles all stand in rows, and depend only on those at most [`REACH`] rows
/// away. Steps in a sweep must give the same bits as steps by whole arrays.
pub(crate) trait Rows: Sync {
    /// Returns the number of patches. Patches do not act on one another.
    fn patches(&self) -> usize;

    /// Returns a patch by its number. Each particle is in exactly one patch.
    fn patch(&self, patch: usize) -> Patch;

    /// Returns the number of columns that each stage keeps from row to row.
    fn kept_columns(&self) -> usize;

    /// Returns the number of values that all rows and stages of a sweep share.
    fn shared_numbers(&self) -> usize;

    /// Prepares the scratch of a sweep over some rows of a patch.
    fn begin(&self, patch: usize, scratch: &mut SweepScratch);

    /// Drifts a row of the stage from time t to t + h, with its pins in their places at t + h;
    /// times are (t, h) in s.
    fn drift(
        &self,
        patch: usize,
        terms: Terms,
        times: (f64, f64),
        row: usize,
        registers: &mut Registers,
    );

    /// Takes rows of a patch through stage `number` of the sweep and the drift that follows it,
    /// with pins in their places at the end. A band of rows is visited in order, from its first row
    /// on; the results of its first [`REACH`] rows are not used, unless they are the first of the
    /// patch. When a row is visited, the [`REACH`] rows below it are still in the stage, and those
    /// above have left it.
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

/// The numbers of some rows during a step, in six columns, x y z of positions and of velocities:
/// the y at which the step began, or the extrapolation e of [`Next::Ahead`]; the sum over the
/// stages; and the current stage.
pub(crate) struct Registers {
    pub(crate) y: Window,
    pub(crate) sum: Window,
    pub(crate) stage: Window,
}

impl Registers {
    /// Creates registers for `depth` rows at a time, of `cols` particles each.
    pub(crate) fn new(depth: usize, cols: usize) -> Self {
        let window = || Window::new(depth, 6, cols);
        Self { y: window(), sum: window(), stage: window() }
    }

    /// Starts the next Runge-Kutta substep from the current stage values.
    pub(crate) fn begin(&mut self, row: usize) {
        self.y.row_mut(row).copy_from_slice(self.stage.row(row));
    }

    /// Extrapolates the velocities of a row, after it stored them as the sum.
    pub(crate) fn look_ahead(&mut self, row: usize) {
        for column in 3..6 {
            let (stage, ahead) = (self.stage.column_mut(row, column), self.y.column(row, column));
            self.sum.column_mut(row, column).copy_from_slice(stage);
            for (v, ahead) in stage.iter_mut().zip(ahead) {
                *v += ahead;
            }
        }
    }

    /// Returns the columns of a row of the current stage.
    pub fn stage(&self, row: usize) -> [&[f64]; 6] {
        array::from_fn(|column| self.stage.column(row, column))
    }

    /// Returns the columns of a row of the current stage, to be changed.
    pub fn stage_mut(&mut self, row: usize) -> [&mut [f64]; 6] {
        self.stage.columns_mut(row)
    }
}

/// Numbers that the rows of a sweep pass on to those below, stage by stage, and numbers that all
/// rows share.
pub(crate) struct SweepScratch {
    pub(crate) shared: Window,
    /// Numbers kept from row to row, a row of the window for each stage.
    pub(crate) kept: Window,
    /// Forces on the current row that are added to those of springs, by axis.
    pub(crate) addends: Window,
}

impl SweepScratch {
    /// Creates scratch for rows of `cols` particles.
    pub(crate) fn new(system: &dyn Rows, stages: usize, cols: usize) -> Self {
        Self {
            shared: Window::new(1, 1, system.shared_numbers()),
            kept: Window::new(stages, system.kept_columns(), cols),
            addends: Window::new(1, 3, cols),
        }
    }

    /// Returns the values that all rows and stages share, to be changed.
    pub fn shared_mut(&mut self) -> &mut [f64] {
        self.shared.column_mut(0, 0)
    }

    /// Returns the forces on the current row that are added to those of springs, by axis, to be
    /// changed.
    pub(crate) fn addends_mut(&mut self) -> [&mut [f64]; 3] {
        let [x, y, z, ..] = self.addends.columns_mut(0);
        [x, y, z]
    }

    /// Sets the numbers that stages keep to zero.
    pub fn clear_kept(&mut self) {
        self.kept.data.fill(0.0);
    }
}

/// Ring buffer of `depth` matrix rows: rows r and r + depth share a slot. Each row consists of some
/// columns of numbers, each between zeros, aligned for SIMD vectors.
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
        // The start of a cache line, which is eight numbers long.
        let start = data.as_ptr().align_offset(PAD * size_of::<f64>()).min(PAD);
        Self { data, start, depth, columns, stride, cols }
    }

    #[inline]
    fn place(&self, row: usize) -> Range<usize> {
        let length = self.columns * self.stride;
        let start = self.start + row % self.depth * length;
        start..start + length
    }

    /// Returns all columns of a row, with their padding.
    #[inline]
    pub fn row(&self, row: usize) -> &[f64] {
        &self.data[self.place(row)]
    }

    /// Returns all columns of a row, with their padding.
    #[inline]
    pub fn row_mut(&mut self, row: usize) -> &mut [f64] {
        let place = self.place(row);
        &mut self.data[place]
    }

    /// Returns three consecutive rows, of a window that is at least three deep.
    #[inline]
    pub fn three_mut(&mut self, row: usize) -> [&mut [f64]; 3] {
        let places = [self.place(row), self.place(row + 1), self.place(row + 2)];
        self.data
            .get_disjoint_mut(places)
            .expect("a window at least three deep holds three different rows")
    }

    /// Fills a column of a row, and the rest of its last SIMD vector with zeros: a state that
    /// diverged may have left other numbers there.
    pub fn load(&mut self, row: usize, column: usize, from: &[f64]) {
        let (stride, cols) = (self.stride, self.cols);
        let to = &mut self.row_mut(row)[column * stride + PAD..][..cols.next_multiple_of(PAD)];
        to[..cols].copy_from_slice(from);
        to[cols..].fill(0.0);
    }

    /// Returns the first six columns of a row, to be changed.
    pub fn columns_mut(&mut self, row: usize) -> [&mut [f64]; 6] {
        let (stride, cols) = (self.stride, self.cols);
        let mut columns = self.row_mut(row).chunks_exact_mut(stride);
        array::from_fn(|_| match columns.next() {
            Some(column) => &mut column[PAD..PAD + cols],
            None => &mut [],
        })
    }

    /// Returns a column of a row.
    #[inline]
    pub fn column(&self, row: usize, column: usize) -> &[f64] {
        &self.row(row)[column * self.stride + PAD..][..self.cols]
    }

    /// Returns a column of a row.
    #[inline]
    pub fn column_mut(&mut self, row: usize, column: usize) -> &mut [f64] {
        let (stride, cols) = (self.stride, self.cols);
        &mut self.row_mut(row)[column * stride + PAD..][..cols]
    }
}

/// Returns the distance between columns of `cols` numbers: an odd number of cache lines, because
/// addresses a power of two apart fall into the same place of the cache.
pub(crate) const fn stride(cols: usize) -> usize {
    ((cols.div_ceil(PAD) + 2) | 1) * PAD
}
