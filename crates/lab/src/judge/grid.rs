//! Grid of the times of a file: all times are multiples of its step.

use a3_files::rounding::short;

/// Largest error of a time, relative to it, by which programs that add up steps are off.
const TOLERANCE: f64 = 1e-9;
/// Largest number of grid points in the shortest distance between two times.
const MAX_PARTS: u32 = 10;
/// Largest error of a time over the step.
const MAX_SHARE: f64 = 0.02;
/// Largest number of grid points between two at which a step ends.
pub const MAX_EVERY: u64 = 25;
/// Least number of rows at the ends of steps if others lie between them, or of rows in single
/// precision.
pub const MIN_AT_STEPS: usize = 4;
/// Largest multiple of the step.
const MAX_MULTIPLE: f64 = 1e9;

/// Times as multiples of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Step (s).
    pub step: f64,
    /// Number of steps up to each time.
    pub numbers: Vec<u64>,
}

impl Grid {
    /// Returns the grid of increasing times, which a file gives up to an error (s). `None` if they
    /// are no multiples of a step.
    pub fn of(times: &[f64], rounding: f64) -> Option<Self> {
        let gaps = times.windows(2).map(|pair| pair[1] - pair[0]);
        let gaps = gaps.chain(times.first().copied());
        let shortest = gaps.filter(|gap| *gap > 0.0).reduce(f64::min)?;
        // Times with few digits may be exact.
        [0.0, rounding].into_iter().find_map(|rounding| {
            let mut guesses = (1..=MAX_PARTS).map(|parts| shortest / f64::from(parts));
            guesses.find_map(|guess| Self::near(times, rounding, guess))
        })
    }

    /// Times as multiples of a known step (s).
    pub fn of_step(times: &[f64], rounding: f64, step: f64) -> Option<Self> {
        let numbers: Vec<_> = times.iter().map(|t| (t / step).round() as u64).collect();
        let fits = |rounding: &f64| {
            let within =
                |(t, n): (&f64, &u64)| (t - *n as f64 * step).abs() <= tolerance(*t, *rounding);
            let is_fine = tolerance(0.0, *rounding) < MAX_SHARE * step;
            is_fine && times.iter().zip(&numbers).all(within)
        };
        let fits = [0.0, rounding].iter().any(fits);
        fits.then_some(Self { step, numbers })
    }

    /// Times as multiples of a step near `guess` (s).
    fn near(times: &[f64], rounding: f64, guess: f64) -> Option<Self> {
        let mut step = guess;
        let (mut least, mut most) = (0.0, f64::INFINITY);
        let mut numbers = vec![];
        for t in times {
            let number = (t / step).round();
            let tolerance = tolerance(*t, rounding);
            if number > MAX_MULTIPLE
                || tolerance > MAX_SHARE * step
                || (t - number * step).abs() > MAX_SHARE * step + tolerance
            {
                return None;
            }
            if number > 0.0 {
                least = f64::max(least, (t - tolerance) / number);
                most = f64::min(most, (t + tolerance) / number);
                step = t / number;
            }
            numbers.push(number as u64);
        }
        let step = (least <= most && most.is_finite()).then(|| simplest(least, most))?;
        Some(Self { step, numbers })
    }

    /// Returns the coarsest grid of the times with these indices.
    pub fn of_some(&self, kept: &[usize]) -> Self {
        let part = kept.iter().map(|k| self.numbers[*k]).fold(0, gcd).max(1);
        Self {
            step: self.step * part as f64,
            numbers: kept.iter().map(|k| self.numbers[*k] / part).collect(),
        }
    }

    /// Returns the least number of grid points that a whole number of steps (s) lasts, and that
    /// number.
    pub fn meeting(&self, step: f64) -> Option<[u64; 2]> {
        (1..=MAX_EVERY).find_map(|every| {
            let parts = every as f64 * self.step / step;
            let is_whole = (parts - parts.round()).abs() <= TOLERANCE * parts;
            (is_whole && parts > 0.5).then(|| [every, parts.round() as u64])
        })
    }

    /// Returns whether enough times are multiples of a number of grid points.
    pub fn meets(&self, points: u64) -> bool {
        let meet = self.numbers.iter().filter(|n| **n % points == 0);
        points == 1 || meet.count() >= MIN_AT_STEPS
    }

    /// Times of the grid points (s).
    pub fn times(&self) -> impl Iterator<Item = f64> {
        self.numbers.iter().map(|n| *n as f64 * self.step)
    }
}

/// Returns the largest error of a time t (s) in a file that rounds it by up to `rounding` (s).
fn tolerance(t: f64, rounding: f64) -> f64 {
    1.01 * rounding + TOLERANCE * t
}

/// Returns the simplest number from `least` to `most`, both above 0: one with few digits, or a part
/// of 1.
fn simplest(least: f64, most: f64) -> f64 {
    let middle = 0.5 * (least + most);
    let fits = |number: &f64| (least..=most).contains(number);
    let decimals = |digits: std::ops::RangeInclusive<usize>| digits.map(|n| short(middle, n));
    let part = 1.0 / (1.0 / middle).round();
    let all = decimals(1..=3).chain([part]).chain(decimals(4..=15));
    all.into_iter().find(fits).unwrap_or(middle)
}

/// Returns the greatest common divisor.
pub fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

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
    let mut all: Vec<_> =
        all.filter(|pace| is_typed(seconds(pace)) || is_typed(1.0 / seconds(pace))).collect();
    all.sort_by(|a, b| seconds(b).total_cmp(&seconds(a)));
    all.sort_by_key(|pace| (pace.steps < pace.points, !has(1, seconds(pace))));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_found_in_rounded_and_summed_times() {
        let sums = |h: f64, count: usize| {
            let next = |t: &mut f64, _| {
                *t += h;
                Some(*t)
            };
            (0..count).scan(0.0, next).collect::<Vec<_>>()
        };
        let grid = Grid::of(&sums(0.1, 1000), 0.0).unwrap();
        assert_eq!((grid.step, grid.numbers[999]), (0.1, 1000));
        let sixtieth: Vec<_> = (0..500).map(|k| f64::from(k) / 60.0).collect();
        let rounded: Vec<_> = sixtieth.iter().map(|t| (t * 1e6).round() / 1e6).collect();
        for (times, rounding) in [(&sixtieth, 0.0), (&rounded, 5e-7)] {
            let grid = Grid::of(times, rounding).unwrap();
            assert_eq!((grid.step, grid.numbers[499]), (1.0 / 60.0, 499));
        }
        // Times of two digits, which would be rounded by up to half a step.
        assert_eq!(Grid::of(&[0.01, 0.02, 0.03], 0.005).unwrap().step, 0.01);
        let uneven = Grid::of(&[0.0, 0.1, 0.25, 0.6], 0.0).unwrap();
        assert_eq!((uneven.step, uneven.numbers), (0.05, vec![0, 2, 5, 12]));
        assert_eq!(Grid::of(&[0.0, 0.1, 0.1 + 0.1 * 2f64.sqrt()], 0.0), None);
        assert_eq!(Grid::of(&[0.0], 0.0), None);
        assert_eq!(Grid::of(&[0.25], 0.0).unwrap().numbers, [1]);
        assert!(Grid::of_step(&sixtieth, 0.0, 0.01).is_none());
        assert_eq!(Grid::of_step(&[0.3], 0.0, 0.1).unwrap().numbers, [3]);
        let frames = Grid::of(&sixtieth, 0.0).unwrap();
        assert_eq!(frames.meeting(0.01), Some([3, 5]));
        assert_eq!(frames.meeting(0.01 + 1e-6), None);
    }
}
