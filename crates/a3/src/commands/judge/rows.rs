//! Rows of a file that are judged: their times, and their places on a grid of steps.

use super::grid::Grid;
use crate::files::states::States;

/// Largest number of rows that are judged, and of their coordinates. Of longer files, every second
/// row is judged, or every fifth, tenth, ...
const MAX_ROWS: usize = 2_000;
const MAX_NUMBERS: usize = 1_000_000;

/// Rows of a file up to an end.
pub struct Rows<'a> {
    states: &'a States,
    /// Indices of the rows that are judged.
    kept: Vec<usize>,
    /// Their times (s).
    pub times: Vec<f64>,
    /// Their times as multiples of a step.
    pub grid: Option<Grid>,
    /// Number of rows up to the end.
    pub count: usize,
    /// One of how many of them is judged.
    pub every: usize,
}

impl<'a> Rows<'a> {
    /// Returns the rows up to `until` (s), on a grid of steps `step` (s) if it is known.
    ///
    /// # Errors
    /// There is no row between 0 and `until`.
    pub fn of(states: &'a States, until: f64, step: Option<f64>) -> Result<Self, String> {
        let end = until * (1.0 + 1e-9);
        let count = states.times.iter().take_while(|t| **t <= end).count();
        let times = &states.times[..count];
        if times.last().is_none_or(|last| *last <= 0.0) {
            if let Some(t) = states.not_finite_at {
                return Err(format!(
                    "its numbers are not finite from {t} s on, the first after the start"
                ));
            }
            return Err(format!(
                "it has no state between 0 and {until} s: there is nothing to judge"
            ));
        }
        let rounding = states.digits[0].rounding(until);
        let known = step.and_then(|step| Grid::of_step(times, rounding, step));
        let meets = |grid: &Grid| {
            let meeting = |step| grid.meeting(step);
            step.is_none_or(|step| meeting(step).is_some_and(|[points, _]| grid.meets(points)))
        };
        let grid = known.or_else(|| Grid::of(times, rounding).filter(meets));
        let numbers = count * states.positions[0].len();
        let every = round(numbers.div_ceil(MAX_NUMBERS).max(count.div_ceil(MAX_ROWS)));
        let is_kept = |k: &usize| {
            let grid = grid.as_ref();
            grid.is_none_or(|grid| grid.numbers[*k] % every as u64 == 0)
        };
        let first = (0..every.min(count)).find(is_kept).unwrap_or(0);
        let kept: Vec<_> = (first..count).step_by(every).collect();
        let grid = grid.map(|grid| if every > 1 { grid.of_some(&kept) } else { grid });
        let times = match &grid {
            Some(grid) => grid.times().collect(),
            None => kept.iter().map(|k| times[*k]).collect(),
        };
        Ok(Self {
            states,
            kept,
            times,
            grid,
            count,
            every,
        })
    }

    /// Returns the number of rows that are judged.
    pub fn len(&self) -> usize {
        self.kept.len()
    }

    /// Returns the positions of row k (m), column-major.
    pub fn positions(&self, k: usize) -> &'a [f64] {
        &self.states.positions[self.kept[k]]
    }

    /// Returns the velocities of row k (m/s), column-major, if the file has them.
    pub fn velocities(&self, k: usize) -> Option<&'a [f64]> {
        let rows = self.states.velocities.as_ref()?;
        Some(&rows[self.kept[k]])
    }

    /// Returns whether all positions are numbers in single precision, to the digits of the file.
    pub fn are_single(&self) -> bool {
        (0..self.len()).all(|k| {
            let rounding = 1.01 * self.rounding(k);
            let mut all = self.positions(k).iter();
            all.all(|x| (x - f64::from(*x as f32)).abs() <= rounding)
        })
    }

    /// Returns the largest error of the positions of row k (m) by the digits of the file.
    pub fn rounding(&self, k: usize) -> f64 {
        let row = self.positions(k).iter();
        let largest = row.fold(0.0, |most: f64, x| most.max(x.abs()));
        self.states.digits[1].rounding(largest)
    }

    /// Returns the time of the file's first row (s).
    pub fn begin(&self) -> f64 {
        self.states.times[0]
    }

    /// Returns the last time (s).
    pub fn until(&self) -> f64 {
        self.times[self.times.len() - 1]
    }
}

/// Returns the least of the numbers 1, 2, 5, 10, 20, ... that is as large as a number.
fn round(number: usize) -> usize {
    let decades = std::iter::successors(Some(1), |decade: &usize| decade.checked_mul(10));
    let all = decades.flat_map(|decade| [1, 2, 5].map(|digit| digit * decade));
    all.into_iter()
        .find(|round| *round >= number)
        .unwrap_or(number)
}

/// Returns the root mean square over the particles of the distance between two states' positions
/// (m).
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
    (squares.sum::<f64>() / (a.len() as f64 / 3.0)).sqrt()
}

/// Returns the particle that is farthest from its place, and its distance (m).
pub fn farthest(a: &[f64], b: &[f64]) -> (usize, f64) {
    let n = a.len() / 3;
    let apart = |i: usize| {
        let squares = (0..3).map(|axis| (a[axis * n + i] - b[axis * n + i]).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let all = (0..n).map(|i| (i, apart(i)));
    all.fold(
        (0, 0.0),
        |most, next| if next.1 > most.1 { next } else { most },
    )
}

/// Coordinates of particles, column-major.
pub fn columns(vectors: &[[f64; 3]]) -> Vec<f64> {
    (0..3)
        .flat_map(|axis| vectors.iter().map(move |v| v[axis]))
        .collect()
}
