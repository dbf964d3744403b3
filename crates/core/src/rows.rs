//! Particles in rows of which only those next to one another act on each other: a whole step can then go over them once,
//! all of its stages a few rows apart, and what it needs in between stays in the cache.

use std::array;
use std::ops::Range;

use crate::elements::sheet::kernel as sheet;

/// How far springs reach, in rows.
pub(crate) const REACH: usize = 2;
/// Numbers beside a column on either side: the longest vector, and zeros for springs that are not there.
pub(crate) const PAD: usize = 8;

/// What is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// y' = \[v | F / m\].
    All,
    /// v' = F / m, x standing still, without the forces that a drift carries.
    Kick,
    /// v' = F / m, x standing still, where drifts carry none.
    Push,
}

/// A stage of a step, that of an explicit Runge-Kutta method over `h` whose stages read only the one before them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stage {
    pub(crate) part: Part,
    /// When it evaluates (s), and when the next one does: the end of the step after the last one.
    pub(crate) t: f64,
    pub(crate) until: f64,
    /// Whether it is the method's first: y is then where the stage is.
    pub(crate) first: bool,
    /// How far its k goes into the sum of all (s).
    pub(crate) b: f64,
    /// How far the next stage follows it (s); none after the last one.
    pub(crate) c: Option<f64>,
    /// How long a drift follows (s).
    pub(crate) drift: f64,
}

/// What a step keeps of some rows: y as it was, the sum of what the stages found, and y of the stage under way.
pub struct Registers {
    pub(crate) y: Window,
    pub(crate) sum: Window,
    pub(crate) stage: Window,
}

/// A system whose rows of particles feel those up to two rows away, and no others.
pub trait Rows: Sync {
    /// Number of rows.
    fn rows(&self) -> usize;

    /// Particles in a row.
    fn cols(&self) -> usize;

    /// Prepares a sweep from some row on, with what is there now.
    fn begin(&self, sweep: &mut Sweep);

    /// Takes a row through a drift of h from time t.
    fn drift(&self, part: Part, t: f64, h: f64, row: usize, registers: &mut Registers);

    /// Takes rows through a stage, that of such a number in the sweep, in their order, each after the one above it: the first two of a sweep come out wrong
    /// unless they are the system's first. Reads up to two rows below them.
    fn advance(
        &self,
        number: usize,
        stage: &Stage,
        rows: Range<usize>,
        registers: &mut Registers,
        sweep: &mut Sweep,
    );
}

/// What rows hand on to those below them, stage by stage, and what they all read.
pub struct Sweep {
    /// Of the springs.
    pub(crate) laws: Window,
    /// A row for each stage.
    pub(crate) found: Window,
    /// Of a row.
    pub(crate) wind: Window,
}

impl Registers {
    /// Begins another method where the stage has arrived.
    pub(crate) fn begin(&mut self, row: usize) {
        self.y.row_mut(row).copy_from_slice(self.stage.row(row));
    }
}

impl Sweep {
    /// For rows of so many particles.
    pub(crate) fn new(stages: usize, cols: usize) -> Self {
        Self {
            laws: Window::new(1, 1, sheet::LAWS),
            found: Window::new(stages, sheet::FOUND, cols),
            wind: Window::new(1, 3, cols),
        }
    }
}

/// Some rows of a matrix that has more: row r is where row r + depth will be. Each is so many columns of numbers, with
/// zeros before and after, at places that suit the processor's vectors.
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
        // Of eight numbers, a cache line.
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

    /// Sets all to zero.
    pub fn clear(&mut self) {
        self.data.fill(0.0);
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

    #[inline]
    pub fn row_mut(&mut self, row: usize) -> &mut [f64] {
        let place = self.place(row);
        &mut self.data[place]
    }

    /// Three rows after one another, of which there have to be so many.
    #[inline]
    pub fn three_mut(&mut self, row: usize) -> [&mut [f64]; 3] {
        let places = [self.place(row), self.place(row + 1), self.place(row + 2)];
        self.data
            .get_disjoint_mut(places)
            .expect("rows of a window that is three deep are three")
    }

    /// Fills a column of a row, and the vector that it ends in with zeros: a state that was lost may have left others.
    pub fn load(&mut self, row: usize, column: usize, from: &[f64]) {
        let (stride, cols) = (self.stride, self.cols);
        let to = &mut self.row_mut(row)[column * stride + PAD..][..cols.next_multiple_of(PAD)];
        to[..cols].copy_from_slice(from);
        to[cols..].fill(0.0);
    }

    /// The six columns of a row.
    pub fn columns_mut(&mut self, row: usize) -> [&mut [f64]; 6] {
        let (stride, cols) = (self.stride, self.cols);
        let mut columns = self.row_mut(row).chunks_exact_mut(stride);
        array::from_fn(|_| &mut columns.next().unwrap_or_default()[PAD..PAD + cols])
    }

    /// A column of a row.
    #[inline]
    pub fn column(&self, row: usize, column: usize) -> &[f64] {
        &self.row(row)[column * self.stride + PAD..][..self.cols]
    }

    #[inline]
    pub fn column_mut(&mut self, row: usize, column: usize) -> &mut [f64] {
        let (stride, cols) = (self.stride, self.cols);
        &mut self.row_mut(row)[column * stride + PAD..][..cols]
    }
}

/// From one column of so many numbers to the next: an odd number of cache lines, because the processor takes numbers that
/// are a power of two apart for one another.
pub(crate) const fn stride(cols: usize) -> usize {
    ((cols.div_ceil(PAD) + 2) | 1) * PAD
}
