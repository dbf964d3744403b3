//! Search for the largest step that holds, by bisection over runs, which are checked while they
//! take their steps and do a limited amount of work.

use std::cell::{Cell, RefCell};

use super::limit::{HORIZON, STEPS};
use super::mode::Observation;
use crate::elements::Sheet;
use crate::error::Error;
use crate::failure::succeeded;
use crate::integrators::Method;
use crate::network::Element;
use crate::scene::Model;
use crate::simulation::Simulation;

/// Longest trial step if no limit is expected (s).
const MAX_STEP: f64 = 1.0;
/// Longest trial step over the expected limit.
const MAX_LIMIT_RATIO: f64 = 32.0;
/// Largest work of a run, in steps times the work of an evaluation: some seconds.
pub(super) const MAX_RUN_WORK: f64 = 2e8;
/// Ratio of steps to a limit at which longer runs check whether it is sharp.
const SHARP_TEST_RATIO: f64 = 1.1;
/// Shortest trial step below a limit, as a share of it.
const MIN_LIMIT_SHARE: f64 = 1.0 / 16.0;
/// Ratio of trial steps below a limit that is not sharp: some may fail between others that hold.
const CLOSE_RATIO: f64 = 1.03;
/// The same below a limit that seems to be sharp.
const WIDE_RATIO: f64 = 1.19;
/// Ratio of the shortest step that failed to the shortest trial step.
const CLEAR_RATIO: f64 = 2.0;

/// Returns the number of steps of h (s) in a run that lasts for [`HORIZON`] and [`STEPS`] steps at
/// least, or a twentieth of these if no limit is expected.
pub(super) fn steps(h: f64, expected: f64) -> u64 {
    let least = if expected.is_finite() { 1.0 } else { 0.05 };
    (HORIZON / h).ceil().max(least * STEPS) as u64
}

/// Reason why a search ends before it has found the limit.
enum SearchEnd {
    /// A run showed neither that its step holds nor that it fails.
    Open,
    Failed(Error),
}

/// Trial steps (s) and their results.
struct Trials<F> {
    holds: F,
    runs: u32,
    /// Trial steps, and whether they held.
    tried: Vec<(f64, bool)>,
}

impl<F: Fn(f64) -> Result<Option<bool>, Error>> Trials<F> {
    fn new(holds: F) -> Self {
        Self { holds, runs: 0, tried: vec![] }
    }

    fn hold(&mut self, h: f64) -> Result<bool, SearchEnd> {
        self.runs += 1;
        let holds = (self.holds)(h).map_err(SearchEnd::Failed)?.ok_or(SearchEnd::Open)?;
        self.tried.push((h, holds));
        Ok(holds)
    }

    /// Brackets the limit, starting from an expected one (s), and bisects it, unless the longest
    /// step holds or no step of at least `shortest` (s) does.
    fn search(
        &mut self,
        guess: f64,
        [shortest, longest]: [f64; 2],
        precision: f64,
        near: bool,
    ) -> Result<(), SearchEnd> {
        let (mut low, mut high);
        if self.hold(guess)? {
            (low, high) = (guess, (guess * 1.05).min(longest));
            if near && guess < longest && !self.hold(next(low, high, precision))? {
                high = low;
            }
            while low < high && self.hold(high)? {
                (low, high) = (high, (high * 1.4).min(longest));
            }
            if low == longest {
                return Ok(());
            }
        } else {
            (low, high) = (guess / 1.05, guess);
            let close = next(high, low, precision);
            if near && self.hold(close)? {
                low = close;
            } else {
                while !self.hold(low)? {
                    (low, high) = (low / 1.4, low);
                    if low < shortest {
                        return Ok(());
                    }
                }
            }
        }
        while high / low > 1.0 + precision {
            let middle = (low * high).sqrt();
            if self.hold(middle)? {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok(())
    }

    /// Tries steps around a limit (s) that may not be sharp: from half of it to twice it, and
    /// shorter ones as long as these fail. Then bisects both ends of the interval in which some
    /// hold and some fail.
    fn spread(&mut self, limit: f64, precision: f64) -> Result<(), SearchEnd> {
        for quarters in (-4..=4).filter(|quarters| *quarters != 0) {
            self.hold(limit * 2f64.powf(0.25 * f64::from(quarters)))?;
        }
        let mut lowest = 0.5 * limit;
        while lowest > MIN_LIMIT_SHARE * limit && self.longest_that_held(lowest).is_none() {
            lowest *= 0.5;
            self.hold(lowest)?;
        }
        while let Some((low, high)) = self.lower_end().filter(|(l, h)| h / l > 1.0 + precision) {
            self.hold((low * high).sqrt())?;
        }
        while let Some((low, high)) = self.upper_end().filter(|(l, h)| h / l > 1.0 + precision) {
            self.hold((low * high).sqrt())?;
        }
        Ok(())
    }

    /// Tries shorter and shorter steps below a limit (s), until the last is half of the shortest
    /// that failed, or as short as `shortest` (s). Returns whether all held.
    fn descend(&mut self, limit: f64, shortest: f64, ratio: f64) -> Result<bool, SearchEnd> {
        let (mut h, mut failed) = (limit, limit);
        while h > shortest && h > failed / CLEAR_RATIO {
            h /= ratio;
            if !self.hold(h)? {
                failed = h;
            }
        }
        Ok(failed == limit)
    }

    /// Returns the longest step that held, up to a limit (s).
    fn longest_that_held(&self, limit: f64) -> Option<f64> {
        let held = self.tried.iter().filter(|(h, holds)| *holds && *h <= limit);
        held.map(|(h, _)| *h).max_by(f64::total_cmp)
    }

    /// Returns the shortest step that failed, from a limit (s) on.
    fn shortest_that_failed(&self, limit: f64) -> Option<f64> {
        let failed = self.tried.iter().filter(|(h, holds)| !*holds && *h >= limit);
        failed.map(|(h, _)| *h).min_by(f64::total_cmp)
    }

    /// Returns the longest step that held below the shortest one that failed, and the latter (s).
    fn lower_end(&self) -> Option<(f64, f64)> {
        let failed = self.shortest_that_failed(0.0)?;
        Some((self.longest_that_held(failed)?, failed))
    }

    /// Returns the longest step that held, and the shortest longer one that failed (s).
    fn upper_end(&self) -> Option<(f64, f64)> {
        let held = self.longest_that_held(f64::INFINITY)?;
        Some((held, self.shortest_that_failed(held)?))
    }

    /// Returns the result of the trials, if any step held.
    fn observation(&self) -> Option<Observation> {
        self.longest_that_held(f64::INFINITY).map(|held| Observation {
            held,
            failed: self.shortest_that_failed(0.0).unwrap_or(f64::INFINITY),
            runs: self.runs,
        })
    }
}

/// Finds the largest step (s) for which `holds` returns true, to a relative precision: by bisection
/// of its logarithm, starting from the expected limit (s), or infinity if none is expected. `None`
/// if runs would take too long; `work` is that of an evaluation.
///
/// With `near`, the step closest to the limit is tried before others: two runs are enough if the
/// limit is as expected, provided that steps shorter than one that holds hold too.
///
/// If `holds` returns `None`, the search ends with the result so far.
pub(super) fn bisect(
    expected: f64,
    work: f64,
    precision: f64,
    near: bool,
    holds: impl Fn(f64) -> Result<Option<bool>, Error>,
) -> Result<Option<Observation>, Error> {
    let shortest = (HORIZON * work / MAX_RUN_WORK).max(1e-6);
    let limited = expected.is_finite();
    let longest = if limited { MAX_LIMIT_RATIO * expected } else { MAX_STEP };
    let guess = expected.min(longest);
    if guess < shortest {
        return Ok(None);
    }
    let mut trials = Trials::new(holds);
    match trials.search(guess, [shortest, longest], precision, near) {
        Err(SearchEnd::Failed(error)) => Err(error),
        Ok(()) | Err(SearchEnd::Open) => Ok(trials.observation()),
    }
}

/// Checks a limit by runs with shorter steps, and by `times` longer ones. Returns a sharp limit or,
/// if runs fail at shorter steps or hold at longer ones, the interval of both. `sharp` tells
/// whether a sharp limit is expected: then a few runs are enough if they agree. If `holds` returns
/// `None`, the search ends with the result so far.
pub(super) fn sharpen(
    seen: Observation,
    sharp: bool,
    (times, precision): (u64, f64),
    holds: impl Fn(f64, u64) -> Result<Option<bool>, Error>,
) -> Result<Observation, Error> {
    let limit = seen.held;
    let mut long = Trials::new(|h| holds(h, times));
    let mut short = Trials::new(|h| holds(h, 1));
    let mut agree = || {
        let is_above = long.hold(limit * SHARP_TEST_RATIO)?;
        let is_below = long.hold(limit / SHARP_TEST_RATIO)?;
        let shortest = MIN_LIMIT_SHARE * limit;
        if sharp && is_below && !is_above && short.descend(limit, shortest, WIDE_RATIO)? {
            return Ok(true);
        }
        long.spread(limit, precision)?;
        let failed = long.shortest_that_failed(0.0).unwrap_or(limit).min(limit);
        short.descend(failed, shortest, CLOSE_RATIO)?;
        Ok(false)
    };
    let agree = match agree() {
        Err(SearchEnd::Failed(error)) => return Err(error),
        Err(SearchEnd::Open) => false,
        Ok(agree) => agree,
    };
    let runs = seen.runs + long.runs + short.runs;
    if agree {
        return Ok(Observation { runs, ..seen });
    }
    let all = [&long.tried, &short.tried].into_iter().flatten();
    let failed = all.filter(|(_, holds)| !holds).map(|(h, _)| *h);
    let failed = failed.fold(seen.failed, f64::min);
    let longest = long.longest_that_held(f64::INFINITY).unwrap_or(limit);
    // If longer runs fail at steps at which shorter ones held, both set the interval.
    let held = if failed * SHARP_TEST_RATIO > limit { longest } else { longest.max(limit) };
    Ok(Observation { held, failed, runs })
}

/// Returns the first step next to `end`, when the interval to `other` is bisected to a relative
/// precision.
fn next(end: f64, other: f64, precision: f64) -> f64 {
    let mut step = other;
    while (step / end).max(end / step) > 1.0 + precision {
        step = (end * step).sqrt();
    }
    step
}

/// Largest work of a run, as a share of the search's budget.
const MAX_RUN_SHARE: f64 = 0.25;
/// Work between two checks of the budget, as a share of it.
const CHECK_SHARE: f64 = 0.01;
/// Least number of particles that count as work: a small system costs more than its particles.
const MIN_PARTICLES: usize = 20;
/// Least number of steps to which a run is shortened.
const MIN_STEPS: f64 = 100.0;

/// Cost of an evaluation per particle, relative to a sheet of springs: with other forces.
const OTHER_PRICE: f64 = 3.5;
/// The same in a fluid.
const FLUID_PRICE: f64 = 10.0;
/// The same where surfaces touch, whose pairs are listed again where they move fast.
const CONTACT_PRICE: f64 = 50.0;
/// Cost of an impulse of the collision safeguard, with the search for the next one.
const IMPULSE_PRICE: f64 = 50.0;

/// Work that a search may do, in evaluations of one particle on a sheet of springs, which take 20
/// to 40 ns. It is counted, not timed, so that a search ends at the same run on every machine.
#[derive(Debug)]
pub struct Budget {
    most: f64,
    /// Work that may be done now.
    allowed: Cell<f64>,
    spent: Cell<f64>,
    limits: Cell<bool>,
    /// Failure of a callback in a run, if there was one.
    failure: RefCell<Option<Error>>,
}

impl Budget {
    /// Creates a budget of that amount of work.
    #[must_use]
    pub fn new(most: f64) -> Self {
        Self {
            most,
            allowed: Cell::new(most),
            spent: Cell::new(0.0),
            limits: Cell::new(false),
            failure: RefCell::new(None),
        }
    }

    /// Creates an unlimited budget.
    #[must_use]
    pub fn unlimited() -> Self {
        Self::new(f64::INFINITY)
    }

    /// Allows the next search a share of the remaining work.
    pub fn allow(&self, share: f64) {
        let spent = self.spent.get();
        self.allowed.set(spent + share * (self.most - spent));
    }

    /// Returns the work done so far.
    #[must_use]
    pub fn spent(&self) -> f64 {
        self.spent.get()
    }

    /// Returns whether the budget ended a search, or shortened its runs.
    #[must_use]
    pub fn limits(&self) -> bool {
        self.limits.get()
    }

    /// Returns the number of steps of a run, at most `wanted`, that the budget allows.
    pub(super) fn room(&self, method: &Method, model: &Model, wanted: u64) -> u64 {
        let each = f64::from(method.evaluations) * price(model);
        let room = (MAX_RUN_SHARE * self.most / each).max(MIN_STEPS);
        if room < wanted as f64 {
            self.limits.set(true);
            return room as u64;
        }
        wanted
    }

    /// Checks that no callback has failed in a run.
    ///
    /// # Errors
    /// That failure.
    pub(super) fn check(&self) -> Result<(), Error> {
        self.failure.take().map_or(Ok(()), Err)
    }

    /// Takes steps of a run. Returns whether the run holds; `None` once the budget is spent, and if
    /// a callback fails.
    pub fn take(&self, run: &mut Simulation, steps: u64) -> Option<bool> {
        let (mut left, mut portion) = (steps, 1);
        while left > 0 {
            let before = self.spent.get();
            if !self.spend(run, |run| run.take_steps(portion))? {
                return Some(false);
            }
            left -= portion;
            let work = self.spent.get() - before;
            let room = CHECK_SHARE * self.most * portion as f64 / work;
            portion = (room as u64).clamp(1, left.max(1));
        }
        Some(true)
    }

    /// Advances a run to a time (s). Returns what [`take`](Self::take) returns.
    pub fn reach(&self, run: &mut Simulation, time: f64) -> Option<bool> {
        self.spend(run, |run| run.advance_to(time))
    }

    /// Advances a run, and counts the work.
    fn spend(
        &self,
        run: &mut Simulation,
        advance: impl FnOnce(&mut Simulation) -> Result<(), Error>,
    ) -> Option<bool> {
        let before = cost(run);
        let advanced =
            succeeded(advance(run)).map_err(|failure| self.failure.replace(Some(failure)));
        self.spent.set(self.spent.get() + cost(run) - before);
        let holds = advanced.ok()?;
        if holds && self.spent.get() > self.allowed.get() {
            self.limits.set(true);
            return None;
        }
        Some(holds)
    }
}

/// Returns the cost of an evaluation of a model.
fn price(model: &Model) -> f64 {
    let each = model.network().map_or(1.0, |network| {
        let is_light = |element: &Element| {
            element.get::<Sheet>().is_some() || element.force().drift_forces().is_some()
        };
        if network.contact_layer().is_some() {
            CONTACT_PRICE
        } else if network.fluid().is_some() {
            FLUID_PRICE
        } else if !network.elements().iter().all(is_light) {
            OTHER_PRICE
        } else {
            1.0
        }
    });
    each * model.particles().max(MIN_PARTICLES) as f64
}

/// Returns the work of a run so far.
pub(super) fn cost(run: &Simulation) -> f64 {
    run.work().total() * price(run.model()) + IMPULSE_PRICE * run.guarded().impulses as f64
}

/// Number of checks during a run that holds.
const CHECKS: u64 = 200;

/// Takes `steps` steps and then 8 more, one by one: calls `check` with numbers of steps to take and
/// to check. Returns its result as soon as that is not `Some(true)`.
pub(super) fn take_checked(steps: u64, mut check: impl FnMut(u64) -> Option<bool>) -> Option<bool> {
    let mut left = steps;
    while left > 0 {
        let count = (steps / CHECKS).clamp(1, left);
        if !check(count)? {
            return Some(false);
        }
        left -= count;
    }
    for _ in 0..8 {
        if !check(1)? {
            return Some(false);
        }
    }
    Some(true)
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// Searches where steps below 0.06 s hold, except those in some intervals (s), by no more runs
    /// than `most`.
    fn search(fail: &[[f64; 2]], sharp: bool, most: u32) -> Observation {
        let runs = Cell::new(0);
        let holds = |h: f64, _: u64| {
            runs.set(runs.get() + 1);
            let holds = h < 0.06 && !fail.iter().any(|[from, to]| (*from..*to).contains(&h));
            Ok((runs.get() <= most).then_some(holds))
        };
        let seen = bisect(0.07, 1.0, 0.02, false, |h| holds(h, 1));
        sharpen(seen.unwrap().unwrap(), sharp, (10, 0.02), holds).unwrap()
    }

    #[test]
    fn a_sharp_limit_is_found() {
        for sharp in [true, false] {
            let seen = search(&[], sharp, u32::MAX);
            assert!(seen.is_sharp() && (0.058..0.06).contains(&seen.held), "{seen:?}");
        }
    }

    #[test]
    fn steps_that_fail_below_others_that_hold_are_found() {
        let narrow = [[0.0305, 0.0325], [0.02, 0.021]];
        for (fail, sharp) in [(&narrow[..], false), (&[[0.02, 0.045]], true)] {
            let seen = search(fail, sharp, u32::MAX);
            assert!(seen.held > 0.058 && (0.02..0.021).contains(&seen.failed), "{seen:?}");
        }
    }

    /// However early the runs end, the interval is one of steps that were tried.
    #[test]
    fn an_interval_does_not_begin_at_zero() {
        for most in 5..60 {
            let seen = search(&[[0.03, 0.04]], false, most);
            assert!(seen.failed >= 0.03 && seen.held > 0.04, "{most}: {seen:?}");
        }
    }
}
