//! Search for the largest step that holds, by bisection over runs, within a budget of work.

use std::cell::Cell;

use super::limit::{HORIZON, STEPS};
use super::observation::Observation;
use crate::elements::Sheet;
use crate::error::Error;
use crate::integrators::Method;
use crate::network::Element;
use crate::scene::Model;
use crate::simulation::Simulation;

/// Longest step that is tried where no limit is expected (s).
const LONGEST: f64 = 1.0;
/// Longest step that is tried where a limit is expected, as a multiple of that limit.
const BEYOND: f64 = 32.0;
/// Most work of a run, in steps times that of an evaluation: some seconds.
pub(super) const MOST: f64 = 2e8;
/// Number of checks during a run that holds.
const LOOKS: u64 = 200;
/// Longest run of a search, as a share of the search's budget.
const RUN: f64 = 0.25;
/// Work between two looks at what is spent, as a share of the search's budget.
const PORTION: f64 = 0.01;
/// Least number of particles that count: a small system costs more than its particles.
const PARTICLES: usize = 20;
/// Number of steps to which no run is shortened.
const FEWEST: f64 = 100.0;

/// Price of an evaluation for a particle, over that for one of a sheet of springs: with other
/// forces, ...
const OTHER: f64 = 3.5;
/// ... in a fluid, ...
const FLUID: f64 = 10.0;
/// ... and where surfaces touch, whose pairs are listed anew where they move fast.
const TOUCHING: f64 = 50.0;
/// Distance from a limit, as a factor, at which longer runs tell whether it is sharp.
const NEAR: f64 = 1.1;
/// Shortest step that is tried below a limit, as a share of it.
const LEAST: f64 = 1.0 / 16.0;
/// Price of an impulse of the guard of surfaces, with the search for what it meets next.
const IMPULSE: f64 = 50.0;

/// Work that a search may do, in evaluations of one particle on a sheet of springs, which take 20
/// to 40 ns: counted, so that a search ends at the same run on every machine.
#[derive(Debug)]
pub struct Budget {
    most: f64,
    /// What may be spent now.
    allowed: Cell<f64>,
    spent: Cell<f64>,
    limits: Cell<bool>,
}

impl Budget {
    /// Budget of that much work.
    #[must_use]
    pub fn new(most: f64) -> Self {
        Self {
            most,
            allowed: Cell::new(most),
            spent: Cell::new(0.0),
            limits: Cell::new(false),
        }
    }

    /// Budget that limits nothing.
    #[must_use]
    pub fn unlimited() -> Self {
        Self::new(f64::INFINITY)
    }

    /// Allows what comes next a share of what is left.
    pub fn allow(&self, share: f64) {
        let spent = self.spent.get();
        self.allowed.set(spent + share * (self.most - spent));
    }

    /// Work that was done.
    #[must_use]
    pub fn spent(&self) -> f64 {
        self.spent.get()
    }

    /// Whether it ended a search, or made its runs shorter.
    #[must_use]
    pub fn limits(&self) -> bool {
        self.limits.get()
    }

    /// Number of steps of a run, at most `wanted`, that this budget has room for.
    pub(super) fn room(&self, method: &Method, model: &Model, wanted: u64) -> u64 {
        let each = f64::from(method.evaluations) * price(model);
        let room = (RUN * self.most / each).max(FEWEST);
        if room < wanted as f64 {
            self.limits.set(true);
            return room as u64;
        }
        wanted
    }

    /// Takes steps of a run. Returns whether it holds; `None` once the budget is spent.
    pub(super) fn take(&self, run: &mut Simulation, steps: u64) -> Option<bool> {
        let (mut left, mut portion) = (steps, 1);
        while left > 0 {
            let before = cost(run);
            let holds = run.take_steps(portion).is_ok();
            let work = cost(run) - before;
            self.spent.set(self.spent.get() + work);
            if !holds {
                return Some(false);
            }
            if self.spent.get() > self.allowed.get() {
                self.limits.set(true);
                return None;
            }
            left -= portion;
            let room = PORTION * self.most * portion as f64 / work;
            portion = (room as u64).clamp(1, left.max(1));
        }
        Some(true)
    }
}

/// Price of an evaluation of a model.
fn price(model: &Model) -> f64 {
    let each = model.network().map_or(1.0, |network| {
        let is_light = |element: &Element| {
            element.get::<Sheet>().is_some() || element.force().drift_forces().is_some()
        };
        if network.contact_layer().is_some() {
            TOUCHING
        } else if network.fluid().is_some() {
            FLUID
        } else if !network.elements().iter().all(is_light) {
            OTHER
        } else {
            1.0
        }
    });
    each * model.particles().max(PARTICLES) as f64
}

/// Work of a run so far.
pub(super) fn cost(run: &Simulation) -> f64 {
    run.work().total() * price(run.model()) + IMPULSE * run.guarded().impulses as f64
}

/// Number of steps of h (s) in a run: those that fill [`HORIZON`], and [`STEPS`] at least, or a
/// twentieth of these where no limit is expected.
pub(super) fn steps(h: f64, expected: f64) -> u64 {
    let least = if expected.is_finite() { 1.0 } else { 0.05 };
    (HORIZON / h).ceil().max(least * STEPS) as u64
}

/// Calls `look` with numbers of steps to take and to check, `steps` in all, and then 8 more, one by
/// one. Returns what `look` does as soon as that is not `Some(true)`.
pub(super) fn step_and_look(steps: u64, mut look: impl FnMut(u64) -> Option<bool>) -> Option<bool> {
    let mut left = steps;
    while left > 0 {
        let count = (steps / LOOKS).clamp(1, left);
        if !look(count)? {
            return Some(false);
        }
        left -= count;
    }
    for _ in 0..8 {
        if !look(1)? {
            return Some(false);
        }
    }
    Some(true)
}

/// Why a search ends before it has found what it looks for.
enum Stop {
    /// A run says neither that its step holds nor that it does not.
    Open,
    Failed(Error),
}

/// Trials of steps (s), and what they have shown.
struct Trials<F> {
    holds: F,
    runs: u32,
    /// Steps, and whether they held.
    tried: Vec<(f64, bool)>,
}

impl<F: Fn(f64) -> Result<Option<bool>, Error>> Trials<F> {
    fn new(holds: F) -> Self {
        Self {
            holds,
            runs: 0,
            tried: vec![],
        }
    }

    fn hold(&mut self, h: f64) -> Result<bool, Stop> {
        self.runs += 1;
        let holds = (self.holds)(h).map_err(Stop::Failed)?.ok_or(Stop::Open)?;
        self.tried.push((h, holds));
        Ok(holds)
    }

    /// Brackets the limit, from an expected one (s), and bisects it, unless the longest step holds
    /// or no step of at least `shortest` (s) does.
    fn search(
        &mut self,
        guess: f64,
        [shortest, longest]: [f64; 2],
        precision: f64,
        near: bool,
    ) -> Result<(), Stop> {
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

    /// Tries steps around a limit (s) that is not known to be sharp: from half of it to twice it,
    /// and shorter ones as long as these fail. Then bisects both ends of the interval in which some
    /// hold and some fail.
    fn spread(&mut self, limit: f64, precision: f64) -> Result<(), Stop> {
        for quarters in (-4..=4).filter(|quarters| *quarters != 0) {
            self.hold(limit * 2f64.powf(0.25 * f64::from(quarters)))?;
        }
        let mut lowest = 0.5 * limit;
        while lowest > LEAST * limit && self.longest_that_held(lowest).is_none() {
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

    /// Longest step up to a limit (s) that held.
    fn longest_that_held(&self, limit: f64) -> Option<f64> {
        let held = self.tried.iter().filter(|(h, holds)| *holds && *h <= limit);
        held.map(|(h, _)| *h).max_by(f64::total_cmp)
    }

    /// Shortest step of at least a limit (s) that failed.
    fn shortest_that_failed(&self, limit: f64) -> Option<f64> {
        let failed = self
            .tried
            .iter()
            .filter(|(h, holds)| !*holds && *h >= limit);
        failed.map(|(h, _)| *h).min_by(f64::total_cmp)
    }

    /// The shortest step that failed, after the longest shorter one that held (s).
    fn lower_end(&self) -> Option<(f64, f64)> {
        let failed = self.shortest_that_failed(0.0)?;
        Some((self.longest_that_held(failed)?, failed))
    }

    /// The longest step that held, before the shortest longer one that failed (s).
    fn upper_end(&self) -> Option<(f64, f64)> {
        let held = self.longest_that_held(f64::INFINITY)?;
        Some((held, self.shortest_that_failed(held)?))
    }

    /// What the trials have shown, if any step held.
    fn observation(&self) -> Option<Observation> {
        self.longest_that_held(f64::INFINITY)
            .map(|held| Observation {
                held,
                failed: self.shortest_that_failed(0.0).unwrap_or(f64::INFINITY),
                runs: self.runs,
            })
    }
}

/// Largest step (s) for which `holds` returns true, by bisection of its logarithm from the expected
/// limit (s), infinity if there is none, to a relative precision. `None` if runs would take too
/// long; `work` is that of an evaluation.
///
/// With `near`, the step next to the limit is tried before the others: two runs are enough where
/// the limit is as expected, if steps shorter than one that holds hold too.
///
/// Where `holds` returns `None`, the search ends with what it knows.
pub(super) fn bisect(
    expected: f64,
    work: f64,
    precision: f64,
    near: bool,
    holds: impl Fn(f64) -> Result<Option<bool>, Error>,
) -> Result<Option<Observation>, Error> {
    let shortest = (HORIZON * work / MOST).max(1e-6);
    let limited = expected.is_finite();
    let longest = if limited { BEYOND * expected } else { LONGEST };
    let guess = expected.min(longest);
    if guess < shortest {
        return Ok(None);
    }
    let mut trials = Trials::new(holds);
    match trials.search(guess, [shortest, longest], precision, near) {
        Err(Stop::Failed(error)) => Err(error),
        Ok(()) | Err(Stop::Open) => Ok(trials.observation()),
    }
}

/// What longer runs show of a limit that shorter ones have shown: a sharp limit or, if they fail at
/// shorter steps or hold at longer ones, the interval of both. `sharp` tells whether one is
/// expected: then two runs close to it are enough where they agree.
pub(super) fn sharpen(
    seen: Observation,
    sharp: bool,
    precision: f64,
    holds: impl Fn(f64) -> Result<Option<bool>, Error>,
) -> Result<Observation, Error> {
    let limit = seen.held;
    let mut trials = Trials::new(holds);
    trials.runs = seen.runs;
    let mut look = || {
        let is_above = trials.hold(limit * NEAR)?;
        let is_below = trials.hold(limit / NEAR)?;
        if sharp && is_below && !is_above {
            return Ok(true);
        }
        trials.spread(limit, precision).map(|()| false)
    };
    match look() {
        Err(Stop::Failed(error)) => return Err(error),
        Ok(true) => {
            return Ok(Observation {
                runs: trials.runs,
                ..seen
            });
        }
        Ok(false) | Err(Stop::Open) => {}
    }
    let failed = trials.shortest_that_failed(0.0).unwrap_or(seen.failed);
    let long = trials.longest_that_held(f64::INFINITY).unwrap_or(0.0);
    // Where longer runs fail at steps with which shorter ones held, both set the interval.
    let held = if failed * NEAR > limit {
        long
    } else {
        long.max(limit)
    };
    Ok(Observation {
        held,
        failed,
        runs: trials.runs,
    })
}

/// Step next to one end of an interval that is bisected to a relative precision.
fn next(end: f64, other: f64, precision: f64) -> f64 {
    let mut step = other;
    while (step / end).max(end / step) > 1.0 + precision {
        step = (end * step).sqrt();
    }
    step
}
