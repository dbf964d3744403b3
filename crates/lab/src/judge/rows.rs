//! Rows of a file that are judged: their times, their places on a grid of steps, and the first one
//! against the start of the scene.

use a3_core::Scene;
use a3_files::states::States;

use super::grid::Grid;

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
            return Err(match states.not_finite_at {
                Some(t) => {
                    format!("its numbers are not finite from {t} s on, the first after the start")
                }
                None => {
                    format!("it has no state between 0 and {until} s: there is nothing to judge")
                }
            });
        }
        let rounding = states.digits[0].rounding(until);
        let known = step.and_then(|step| Grid::of_step(times, rounding, step));
        let meets = |grid: &Grid| {
            let meeting = step.and_then(|step| grid.meeting(step));
            step.is_none() || meeting.is_some_and(|[points, _]| grid.meets(points))
        };
        let grid = known.or_else(|| Grid::of(times, rounding).filter(meets));
        let numbers = count * states.positions[0].len();
        let every = round(numbers.div_ceil(MAX_NUMBERS).max(count.div_ceil(MAX_ROWS)));
        let grid_ends = |grid: &Grid, k: usize| grid.numbers[k].is_multiple_of(every as u64);
        let is_kept = |k: &usize| grid.as_ref().is_none_or(|grid| grid_ends(grid, *k));
        let first = (0..every.min(count)).find(is_kept).unwrap_or(0);
        let kept: Vec<_> = (first..count).step_by(every).collect();
        let grid = grid.map(|grid| if every > 1 { grid.of_some(&kept) } else { grid });
        let times = match &grid {
            Some(grid) => grid.times().collect(),
            None => kept.iter().map(|k| times[*k]).collect(),
        };
        Ok(Self { states, kept, times, grid, count, every })
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
    all.into_iter().find(|round| *round >= number).unwrap_or(number)
}

/// Returns the root mean square over the particles of the distance between two states' positions
/// (m).
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
    (squares.sum::<f64>() / (a.len() as f64 / 3.0)).sqrt()
}

/// Returns the distances between two states' vectors, particle by particle.
fn distances(a: &[f64], b: &[f64]) -> impl Iterator<Item = f64> {
    let n = a.len() / 3;
    let square =
        move |i: usize| (0..3).map(move |axis| (a[axis * n + i] - b[axis * n + i]).powi(2));
    (0..n).map(move |i| square(i).sum::<f64>().sqrt())
}

/// Returns the particle that is farthest from its place, and its distance (m).
pub fn farthest(a: &[f64], b: &[f64]) -> (usize, f64) {
    let farther =
        |most: (usize, f64), next: (usize, f64)| if next.1 > most.1 { next } else { most };
    distances(a, b).enumerate().fold((0, 0.0), farther)
}

/// Coordinates of particles, column-major.
pub fn columns(vectors: &[[f64; 3]]) -> Vec<f64> {
    (0..3).flat_map(|axis| vectors.iter().map(move |v| v[axis])).collect()
}

/// Largest distance of a particle that is in its place, over the size of the scene.
const TOLERANCE: f64 = 1e-9;
/// Units in which programs give lengths, and how many of them are a metre.
const UNITS: [(&str, f64); 3] = [("mm", 1000.0), ("cm", 100.0), ("inches", 1.0 / 0.0254)];
/// Largest number of particles whose order is compared.
const MAX_SORTED: usize = 20_000;

/// Difference of a first state from the start of the scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// The first row is not at time 0 (s).
    Later(f64),
    /// The positions are those of the scene in another order.
    Order,
    /// The positions are those of the scene in another unit.
    Unit(&'static str),
    /// The axes y and z are exchanged, at all times.
    Axes,
    /// Number of particles that are elsewhere, and the farthest of them with its distance (m).
    Positions(usize, (usize, f64)),
    /// The particle whose velocity differs most, and the difference (m/s).
    Velocities(usize, f64),
}

/// Compares the first row with the start of the scene. `None` if they agree.
pub fn difference(scene: &Scene, rows: &Rows) -> Option<Difference> {
    if rows.begin() > 0.0 {
        return Some(Difference::Later(rows.begin()));
    }
    let n = scene.model.particles();
    let (start, own) = (&scene.state[..3 * n], rows.positions(0));
    let near = TOLERANCE * scene.extent().1 + 2.0 * rows.rounding(0);
    let far = farthest(start, own);
    if far.1 > near {
        return Some(if is_order(start, own, near) {
            Difference::Order
        } else if let Some(unit) = unit(start, own, near) {
            Difference::Unit(unit)
        } else {
            let away = distances(start, own).filter(|distance| *distance > near);
            Difference::Positions(away.count(), far)
        });
    }
    let has_velocities = scene.model.network().is_some();
    let velocities = rows.velocities(0).filter(|_| has_velocities)?;
    let given = &scene.state[3 * n..6 * n];
    let (i, far) = farthest(given, velocities);
    let both = given.iter().chain(velocities);
    let largest = both.fold(1.0, |most: f64, v| most.max(v.abs()));
    (far > 1e-6 * largest + 2.0 * rows.rounding(0)).then_some(Difference::Velocities(i, far))
}

/// Returns whether the positions are those of the scene in another order.
fn is_order(start: &[f64], own: &[f64], near: f64) -> bool {
    let n = start.len() / 3;
    if n > MAX_SORTED {
        return false;
    }
    let unit = near.max(f64::MIN_POSITIVE);
    let sorted = |x: &[f64]| {
        // No key is -0.
        let key = |value: f64| (value / (4.0 * unit)).round() + 0.0;
        let mut all: Vec<_> =
            (0..n).map(|i| [key(x[i]), key(x[n + i]), key(x[2 * n + i])]).collect();
        all.sort_by(|a, b| {
            let [x, y, z] = std::array::from_fn(|axis| a[axis].total_cmp(&b[axis]));
            x.then(y).then(z)
        });
        all
    };
    let pairs = sorted(start).into_iter().zip(sorted(own));
    pairs.flat_map(|(a, b)| a.into_iter().zip(b)).all(|(a, b)| (a - b).abs() <= 1.0)
}

/// Returns the unit in which positions are those of the scene.
fn unit(start: &[f64], own: &[f64], near: f64) -> Option<&'static str> {
    let in_unit = |(_, per_metre): &(&str, f64)| {
        let scaled: Vec<_> = own.iter().map(|x| x / per_metre).collect();
        distance(start, &scaled) <= near
    };
    let largest = start.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let mut known = UNITS.into_iter().filter(|_| largest > 0.0);
    let found = known.find(in_unit);
    found.map(|(name, _)| name)
}

/// Returns the positions whose axis z, which is up, becomes y; `sign` tells where y points.
pub fn with_y_up(x: &[f64], sign: f64) -> Vec<f64> {
    let n = x.len() / 3;
    let depth = x[n..2 * n].iter().map(|y| sign * y);
    let level = x[..n].iter().chain(&x[2 * n..]).copied();
    level.chain(depth).collect()
}
