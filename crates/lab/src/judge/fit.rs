//! Fit of a constant of the scene to the rows of a file, by least squares.

use super::constant::{Change, Mistake};
use super::rows::distance;
use super::scheme::Scheme;
use super::trial::{Judged, Trial, Way};

/// Number of rows of the first fit. Each further one has several times as many, up to all.
const FIRST_ROWS: usize = 3;
const MORE_ROWS: usize = 4;
/// Largest number of iterations of each fit.
const MAX_ITERATIONS: usize = 8;
/// Change of the factor over which a rate of change is taken.
const DELTA: f64 = 1e-6;
/// Change of the factor that ends the iterations.
const SETTLED: f64 = 1e-14;
/// Least effect of a constant, over the distance that agrees, that tells its value.
const MIN_EFFECT: f64 = 100.0;
/// Largest factor.
const MAX_FACTOR: f64 = 100.0;
/// Largest work of fits, in springs and particles that are visited.
const MAX_WORK: f64 = 2e8;
/// Distance of rows from a fit to some of them, over that which agrees.
const SLACK: f64 = 3.0;

/// Differences of a run from rows (m), and the square of the largest distance that agrees in their
/// place, summed over them.
struct Residuals {
    all: Vec<f64>,
    bound: f64,
    /// Largest distance over that which agrees.
    worst: f64,
}

impl Judged<'_> {
    /// Returns a trial whose constant is fitted to the rows, by the Gauss-Newton method: first to
    /// those at the start, on which it acts almost linearly. `None` if rows differ by more than
    /// their bound, a function of their number and of the distance moved (m).
    pub fn fit(
        &self,
        trial: Trial,
        bound: &dyn Fn(usize, f64) -> f64,
        work: &mut f64,
    ) -> Option<Trial> {
        let Way::Scheme(scheme, Some(Mistake::Constant(mut change))) = trial.way else {
            return Some(trial);
        };
        let mut end = FIRST_ROWS;
        let mut is_fitted = false;
        loop {
            end = end.min(self.last());
            for _ in 0..MAX_ITERATIONS {
                if *work > MAX_WORK {
                    return None;
                }
                let now = self.residuals(with(trial, scheme, change), end, bound, work)?;
                let factor = change.factor + DELTA;
                let moved = with(trial, scheme, Change { factor, ..change });
                let moved = self.residuals(moved, end, bound, work)?;
                let (mut slope, mut square) = (0.0, 0.0);
                for (now, moved) in now.all.iter().zip(&moved.all) {
                    let rate = (moved - now) / DELTA;
                    slope += rate * now;
                    square += rate * rate;
                }
                is_fitted = square > MIN_EFFECT.powi(2) * now.bound;
                if !is_fitted {
                    break;
                }
                let less = slope / square;
                change.factor -= less;
                if less.abs() <= SETTLED {
                    break;
                }
            }
            if change.factor.abs() > MAX_FACTOR || !change.factor.is_finite() {
                change.factor = 1.0;
                is_fitted = false;
            }
            if is_fitted {
                let fitted = self.residuals(with(trial, scheme, change), end, bound, work)?;
                if fitted.worst > SLACK {
                    return None;
                }
            }
            if end == self.last() {
                break;
            }
            end *= MORE_ROWS;
        }
        if !is_fitted {
            return None;
        }
        let typed = with(trial, scheme, change.typed());
        let agrees = self.residuals(typed, end, bound, work)?.worst <= 1.0;
        let exact = with(trial, scheme, change);
        Some(if agrees { typed } else { exact })
    }

    /// Returns the differences of a trial from the first rows. `None` if it blows up there.
    fn residuals(
        &self,
        trial: Trial,
        end: usize,
        bound: &dyn Fn(usize, f64) -> f64,
        work: &mut f64,
    ) -> Option<Residuals> {
        let mut found = Residuals {
            all: vec![],
            bound: 0.0,
            worst: 0.0,
        };
        let (start, mut most) = (self.start(trial), 0.0);
        let passed = self.follow(trial, false, end, work, &mut |k, [x, _]| {
            let own = self.rows.positions(k);
            most = f64::max(most, distance(own, start));
            let bound = bound(k, most);
            found.bound += own.len() as f64 / 3.0 * bound.powi(2);
            found.worst = found
                .worst
                .max(distance(x, own) / bound.max(f64::MIN_POSITIVE));
            found.all.extend(x.iter().zip(own).map(|(x, own)| x - own));
            true
        })?;
        (passed == end).then_some(found)
    }
}

fn with(trial: Trial, scheme: Scheme, change: Change) -> Trial {
    let mistake = Some(Mistake::Constant(change));
    Trial {
        way: Way::Scheme(scheme, mistake),
        ..trial
    }
}
