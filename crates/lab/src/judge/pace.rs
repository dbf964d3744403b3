//! Numbers of steps between the rows of a file.

use a3_files::rounding::short;

use super::grid::{Grid, MAX_EVERY, gcd};

/// Numbers of steps between two grid points that are tried.
const PARTS: [u64; 34] = [
    1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 15, 16, 18, 20, 24, 25, 30, 32, 40, 48, 50, 60, 64, 75, 80,
    96, 100, 120, 125, 128, 200, 250, 500,
];
/// Numbers of steps between two grid points that are tried at any cost, and for the nearest
/// method.
const FEW_PARTS: [u64; 5] = [1, 2, 4, 5, 10];
/// Digits of steps that are tried if rows lie between them, or of their number in a second.
const STEP_DIGITS: usize = 2;

/// Number of steps that last as long as a number of grid points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pace {
    pub steps: u64,
    /// Rows on other grid points lie between steps, and are not compared.
    pub points: u64,
}

impl Pace {
    /// Returns whether it is tried at any cost.
    pub fn is_one_of_few(self) -> bool {
        self.points == 1 && FEW_PARTS.contains(&self.steps)
    }
}

/// Returns the paces at which all rows are at the ends of steps, and those at which only some are.
/// `step` is that of the program (s), if it is known. `None` if the times are no multiples of a
/// step.
pub fn paces(grid: Option<&Grid>, step: Option<f64>) -> Option<[Vec<Pace>; 2]> {
    let each = |steps: u64| Pace { steps, points: 1 };
    let pace = |[points, steps]: [u64; 2]| Pace { steps, points };
    match (grid, step) {
        (None, None) => None,
        (None, Some(_)) => Some([vec![each(1)], vec![]]),
        (Some(grid), Some(step)) => {
            Some([grid.meeting(step).map(pace).into_iter().collect(), vec![]])
        }
        (Some(grid), None) => Some([PARTS.map(each).to_vec(), between(grid)]),
    }
}

/// Returns the paces of steps with few digits at which some grid points lie between steps: steps
/// shorter than the grid first, as most programs take, of these the ones of one digit, and the
/// longest of each.
fn between(grid: &Grid) -> Vec<Pace> {
    let seconds = |pace: &Pace| grid.step * pace.points as f64 / pace.steps as f64;
    let has = |digits: usize, value: f64| (short(value, digits) / value - 1.0).abs() < 1e-9;
    let is_typed = |value: f64| has(STEP_DIGITS, value);
    let all = (2..=MAX_EVERY).filter(|points| grid.meets(*points));
    let all = all.flat_map(|points| PARTS.map(|steps| Pace { steps, points }));
    let all = all.filter(|pace| gcd(pace.points, pace.steps) == 1);
    let mut all: Vec<_> = all
        .filter(|pace| is_typed(seconds(pace)) || is_typed(1.0 / seconds(pace)))
        .collect();
    all.sort_by(|a, b| seconds(b).total_cmp(&seconds(a)));
    all.sort_by_key(|pace| (pace.steps < pace.points, !has(1, seconds(pace))));
    all
}
