//! Choice of the cheapest method for a given error, among steps or tolerances from the coarsest
//! that makes sense.

use super::frames::{Frames, GoOn};
use super::measure::{Outcome, measure};
use super::reference::Reference;
use super::snapshot::Metric;
use crate::control::Control;
use crate::error::Error;
use crate::integrators::{METHODS, Method};
use crate::scene::Scene;
use crate::stability::{Mode, largest_step, spectrum};

/// Ratio of the shortest step that fails to the longest that meets the error, at which the search
/// ends.
const MAX_STEP_RATIO: f64 = 1.02;
/// The same ratio for tolerances, on which the cost depends only weakly.
const MAX_TOLERANCE_RATIO: f64 = 1.3;
/// Least and greatest ratio of the measured order of the error to the method's own, at which
/// further steps are predicted by that order.
const TRUSTED_ORDER_RATIOS: (f64, f64) = (0.6, 1.5);
/// Largest number of steps of a run.
const MAX_STEPS: u64 = 1_000_000;

/// Cost of a method, over that of the second cheapest so far, at which it is given up.
const MAX_COST_RATIO: f64 = 2.0;
/// The same if computing times count in a small scene, where methods spend most of their time
/// outside evaluations.
const SMALL_MAX_COST_RATIO: f64 = 5.0;
/// [Work](crate::Model::work) of an evaluation below which a scene is small.
const SMALL_WORK: f64 = 100.0;
/// Largest average of the steps that a method chooses in a stiff system, over the limit of
/// stability at the start: its modes may become slower.
const MAX_AVERAGE_RATIO: f64 = 2.0;
/// Error with a longer step, over the one that the method's order predicts from a shorter step,
/// above which the longer step counts as unstable.
const MIN_UNSTABLE_RATIO: f64 = 10.0;

/// Reason why no larger step or tolerance was chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetBy {
    /// Its error is too large.
    Accuracy,
    /// Its run is unstable.
    Stability,
    /// No larger one was tried.
    Nothing,
}

/// Demand on the methods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Demand {
    /// Error that counts.
    pub metric: Metric,
    /// Largest error, in the unit of the metric.
    pub error: f64,
    /// Whether the caller will compare computing times, so that methods count that take more
    /// evaluations.
    pub timed: bool,
}

/// Run of a search, measured in any way.
#[derive(Clone, Copy, Debug)]
pub struct Trial<T> {
    /// Error of the run; infinite if it blew up.
    pub error: f64,
    /// Work of the whole run, in evaluations.
    pub work: f64,
    /// More of the run, which the search passes on.
    pub outcome: T,
}

/// Method with its step or tolerance, and the outcome of its run.
#[derive(Clone, Copy, Debug)]
pub struct Candidate<T = Outcome> {
    /// Method of the run.
    pub method: &'static Method,
    /// Step or tolerance of the run.
    pub control: Control,
    /// Work of the run, in evaluations.
    pub work: f64,
    /// Errors and cost of the run.
    pub outcome: T,
    /// Reason why the step or the tolerance is not larger.
    pub set_by: SetBy,
}

/// Finds the cheapest step or tolerance of each method of the table that meets the error `error`,
/// in the unit of the metric; the cheapest method comes first.
///
/// The search gives up a method that would cost more than twice as much as the second cheapest so
/// far. `begin` is called with each method before its runs. Returns `None` if `go_on` returned
/// false.
///
/// The cheapest methods for an error of 1e-8 on a rotation y' = (-y2, y1), over ten seconds:
///
/// ```
/// # use std::sync::Arc;
/// use a3_core::accuracy::{Frames, Metric, Reference, choose};
/// # use a3_core::{Model, ParticleSystem, Scene};
/// # struct Turning;
/// # impl ParticleSystem for Turning {
/// #     fn dim(&self) -> usize { 2 }
/// #     fn eval_f(&self, _t: f64, y: &[f64], dydt: &mut [f64]) {
/// #         dydt.copy_from_slice(&[-y[1], y[0]]);
/// #     }
/// # }
/// # let scene = Scene::new("turning", Model::FirstOrder(Arc::new(Turning)), vec![1.0, 0.0]);
///
/// let go_on = || true;
/// let reference = Reference::finest(&scene, Frames::new(10.0), &go_on)?.unwrap();
/// let found = choose(&scene, &reference, Metric::State, 1e-8, &go_on, |_| {})?.unwrap();
/// let cheapest = found[0];
/// assert_eq!(cheapest.method.name, "dop853");
/// assert!(cheapest.outcome.errors.state <= 1e-8);
/// assert!(found[1].outcome.work.total() > cheapest.outcome.work.total());
/// # Ok::<(), a3_core::Error>(())
/// ```
///
/// # Errors
/// The scene cannot be run, or the metric needs particles that it does not have.
pub fn choose(
    scene: &Scene,
    reference: &Reference,
    metric: Metric,
    error: f64,
    go_on: GoOn,
    begin: impl FnMut(&'static Method),
) -> Result<Option<Vec<Candidate>>, Error> {
    let methods: Vec<_> = METHODS.iter().collect();
    let demand = Demand { metric, error, timed: false };
    choose_among(&methods, scene, reference, demand, go_on, begin)
}

/// Does what [`choose`] does, among these methods. Those that do not support the scene are left
/// out. If computing times count, the search gives up a method of a small scene only at five times
/// the cost of the second cheapest so far.
///
/// # Errors
/// The scene cannot be run, or the metric needs particles that it does not have.
pub fn choose_among(
    methods: &[&'static Method],
    scene: &Scene,
    reference: &Reference,
    demand: Demand,
    go_on: GoOn,
    mut begin: impl FnMut(&'static Method),
) -> Result<Option<Vec<Candidate>>, Error> {
    let metric = demand.metric;
    metric.check(&scene.model)?;
    // The reference's own uncertainty is part of the error that is allowed.
    let error = demand.error - metric.of(&reference.floor);
    let measure = |method, control| -> Result<_, Error> {
        let outcome = measure(scene, method, control, reference, go_on)?;
        Ok(outcome.map(|outcome| Trial {
            error: match outcome.lost {
                // Smaller steps would cost even more.
                Some(_) if outcome.is_too_costly() => f64::MAX,
                Some(_) => f64::INFINITY,
                None => metric.of(&outcome.errors),
            },
            work: outcome.work.total(),
            outcome,
        }))
    };
    let is_small = scene.model.work() < SMALL_WORK;
    let max_ratio = if is_small && demand.timed { SMALL_MAX_COST_RATIO } else { MAX_COST_RATIO };
    let max_cost = |found: &[Candidate]| {
        let second = found.get(1).map_or(f64::INFINITY, |c| max_ratio * c.work);
        second.min(reference.max_work)
    };
    // Methods of high order come first: their cost limits the runs of methods of low order. In a
    // stiff system, so do implicit ones, above all those that choose their steps.
    let mut methods = methods.to_vec();
    methods.sort_by_key(|method| {
        let is_late = |fits: bool| reference.is_stiff && !fits;
        let order = std::cmp::Reverse(method.order);
        (is_late(method.is_implicit()), is_late(method.is_adaptive()), order)
    });
    let frames = &reference.frames;
    let would_stall =
        |method: &Method| reference.is_stiff && method.is_adaptive() && !method.is_implicit();
    let (late, early): (Vec<_>, Vec<_>) = methods.into_iter().partition(|m| would_stall(m));
    let found = choose_by(&early, scene, frames, error, max_cost, measure, &mut begin)?;
    let Some(mut found) = found else {
        return Ok(None);
    };
    if late.is_empty() {
        return Ok(Some(found));
    }
    // An explicit method that chooses its steps chooses those that stability allows.
    let most = max_cost(&found);
    let modes = spectrum(scene.model.system(), 0.0, &scene.state);
    let mut affordable = vec![];
    for method in late {
        let limit = largest_step(method, &modes)?.filter(|limit| limit.step > 0.0);
        let longest = limit.map_or(f64::INFINITY, |limit| MAX_AVERAGE_RATIO * limit.step);
        if frames.until / longest * f64::from(method.evaluations) <= most {
            affordable.push(method);
        }
    }
    let limit = |_: &[Candidate]| most;
    let more = choose_by(&affordable, scene, frames, error, limit, measure, begin)?;
    let Some(more) = more else {
        return Ok(None);
    };
    found.extend(more);
    found.sort_by(|a, b| a.work.total_cmp(&b.work));
    Ok(Some(found))
}

/// Does what [`choose`] does, for errors that the caller measures. `measure` runs the scene, or a
/// variant of it, by one of the methods with a step or a tolerance, and returns `None` to end the
/// search. The methods are tried in their order. A method is given up if it would cost more than
/// `max_cost` evaluations, a bound that may depend on the choices so far. Methods that do not
/// support the scene are left out.
///
/// # Errors
/// Those of `measure`, or the scene cannot be run.
pub fn choose_by<T: Copy, E: From<Error>>(
    methods: &[&'static Method],
    scene: &Scene,
    frames: &Frames,
    error: f64,
    max_cost: impl Fn(&[Candidate<T>]) -> f64,
    mut measure: impl FnMut(&'static Method, Control) -> Result<Option<Trial<T>>, E>,
    mut begin: impl FnMut(&'static Method),
) -> Result<Option<Vec<Candidate<T>>>, E> {
    let mut found: Vec<Candidate<T>> = vec![];
    let modes = spectrum(scene.model.system(), 0.0, &scene.state);
    for &method in methods {
        if method.check(scene.model.system()).is_err() {
            continue;
        }
        begin(method);
        let mut search = MethodSearch {
            modes: &modes,
            frames,
            error,
            method,
            max_cost: max_cost(&found),
            measure: &mut measure,
        };
        match search.run()? {
            Found::Stopped => return Ok(None),
            Found::Nothing => {}
            Found::Best(candidate) => found.push(candidate),
        }
        found.sort_by(|a, b| a.work.total_cmp(&b.work));
    }
    Ok(Some(found))
}

/// Result of the search for one method.
enum Found<T> {
    /// Cheapest run that meets the error.
    Best(Candidate<T>),
    /// No run meets the error, or it would cost too much.
    Nothing,
    /// The search was told to stop.
    Stopped,
}

/// Search for the cheapest step or tolerance of one method.
struct MethodSearch<'a, M> {
    modes: &'a [Mode],
    frames: &'a Frames,
    /// Largest error that is allowed.
    error: f64,
    method: &'static Method,
    /// Largest cost of a run, in evaluations.
    max_cost: f64,
    /// Measures a run of the method.
    measure: &'a mut M,
}

impl<M> MethodSearch<'_, M> {
    fn run<T: Copy, E: From<Error>>(&mut self) -> Result<Found<T>, E>
    where
        M: FnMut(&'static Method, Control) -> Result<Option<Trial<T>>, E>,
    {
        let (method, frames) = (self.method, self.frames);
        let rungs = ladder(self.modes, method, frames, MAX_STEPS)?;
        // The last run that failed: its step or tolerance, and its ratio.
        let mut fails: Option<(f64, f64)> = None;
        let mut i = 0;
        let (mut good, mut best) = loop {
            let Some(&control) = rungs.get(i) else {
                return Ok(Found::Nothing);
            };
            // The least cost of a run with fixed steps is known beforehand.
            let least =
                control.step().map(|step| frames.until / step * f64::from(method.evaluations));
            if least.is_some_and(|least| least > self.max_cost) {
                return Ok(Found::Nothing);
            }
            let Some(trial) = (self.measure)(method, control)? else {
                return Ok(Found::Stopped);
            };
            let ratio = trial.error / self.error;
            if trial.work > self.max_cost && trial.error.is_finite() {
                return Ok(Found::Nothing);
            }
            if ratio <= 1.0 {
                break (control, trial);
            }
            let bound = self.predicted_bound(fails, (control.value(), ratio));
            fails = Some((control.value(), ratio));
            let next = rungs[i + 1..].iter().position(|rung| rung.value() <= bound);
            i = next.map_or(rungs.len() - 1, |k| i + 1 + k).max(i + 1);
        };
        let mut bad = fails;
        // The limit of stability is that of the start state, and may be larger in motion.
        while bad.is_none()
            && let Some(longer) = coarser(good, frames)
        {
            let Some(next) = (self.measure)(method, longer)? else {
                return Ok(Found::Stopped);
            };
            let ratio = next.error / self.error;
            if ratio <= 1.0 {
                (good, best) = (longer, next);
            } else {
                bad = Some((longer.value(), ratio));
            }
        }
        while let Some(middle) = bad.and_then(|(bad, _)| between(good, bad, frames.until)) {
            let Some(next) = (self.measure)(method, middle)? else {
                return Ok(Found::Stopped);
            };
            let ratio = next.error / self.error;
            if ratio <= 1.0 {
                (good, best) = (middle, next);
            } else {
                bad = Some((middle.value(), ratio));
            }
        }
        Ok(Found::Best(Candidate {
            method,
            control: good,
            work: best.work,
            outcome: best.outcome,
            set_by: self.set_by((good, best.error / self.error), bad),
        }))
    }

    /// Returns the reason why no step as long as `bad` was chosen instead of `good`, whose error
    /// over the allowed one is `own`.
    fn set_by(&self, (good, own): (Control, f64), bad: Option<(f64, f64)>) -> SetBy {
        let Some((value, ratio)) = bad else {
            return SetBy::Nothing;
        };
        let growth = (value / good.value()).powi(self.method.order as i32);
        // An error far below the allowed one may grow much before it is too large.
        if good.step().is_some()
            && ratio > MIN_UNSTABLE_RATIO * growth * own.max(1.0 / MIN_UNSTABLE_RATIO)
        {
            SetBy::Stability
        } else {
            SetBy::Accuracy
        }
    }

    /// Returns the step or tolerance above which no run is expected to meet the error. It is
    /// predicted by the order, with a margin, if the last two runs failed as the order predicts;
    /// else it is that of the last run.
    fn predicted_bound(&self, before: Option<(f64, f64)>, last: (f64, f64)) -> f64 {
        let order = if self.method.is_adaptive() { 1.0 } else { f64::from(self.method.order) };
        let measured = before.map(|before| (before.1 / last.1).ln() / (before.0 / last.0).ln());
        match measured {
            Some(measured)
                if (TRUSTED_ORDER_RATIOS.0..TRUSTED_ORDER_RATIOS.1)
                    .contains(&(measured / order)) =>
            {
                last.0 * (0.5 * last.1).powf(-1.0 / order)
            }
            _ => last.0,
        }
    }
}

/// Returns a tolerance between one that meets the error and one that fails, or a step between two
/// such steps that divides the time `until` (s); `None` if they are close to each other.
fn between(good: Control, bad: f64, until: f64) -> Option<Control> {
    let middle = (good.value() * bad).sqrt();
    match good {
        Control::Tolerance(good) => {
            // Rounded as a user would type it, so that the recommended tolerance is one that was
            // run.
            let typed = format!("{middle:.1e}").parse().unwrap_or(middle);
            (bad > MAX_TOLERANCE_RATIO * good).then_some(Control::Tolerance(typed))
        }
        Control::Step(good) => {
            let (most, least) = ((until / good).round() as u64, (until / bad).round() as u64);
            let count = ((until / middle).round() as u64).clamp(least + 1, most.max(MIN_STEPS));
            (bad > MAX_STEP_RATIO * good && count < most)
                .then_some(Control::Step(until / count as f64))
        }
    }
}

/// Ratio of a step to the next shorter one, as far as whole numbers of steps allow.
const RUNG_RATIO: f64 = 1.5;
/// Longest step over the method's stability limit: one or two steps beyond the limit show where it
/// is.
const MAX_LIMIT_RATIO: f64 = 1.4;
/// Least number of steps of a run.
pub(super) const MIN_STEPS: u64 = 4;
/// Least multiple of the smallest whole number of steps of 1/n s to which numbers of steps are
/// rounded.
const MIN_ROUNDED_UNITS: f64 = 3.0;
/// Exponents of the largest and the smallest tolerance of adaptive methods, in half powers of ten:
/// from 10^-1 to 10^-12, or to 10^-8 for methods of low order.
const TOLERANCES: (i32, [i32; 2]) = (-2, [-24, -16]);
/// Least order that is high.
const MIN_HIGH_ORDER: u32 = 5;

/// Lists steps that divide the time of all frames, from just beyond the method's stability limit on
/// the scene's `modes` down, or, for an adaptive method, tolerances from 0.1 down.
///
/// The coarsest comes first. The list of steps ends where a run would take more than `most` steps.
///
/// # Errors
/// Never fails for a method in [`METHODS`](crate::integrators::METHODS).
pub fn ladder(
    modes: &[Mode],
    method: &'static Method,
    frames: &Frames,
    most: u64,
) -> Result<Vec<Control>, Error> {
    if method.is_adaptive() {
        let least = TOLERANCES.1[usize::from(method.order < MIN_HIGH_ORDER)];
        return Ok((least..=TOLERANCES.0)
            .rev()
            .map(|half| {
                let digits = if half % 2 == 0 { 1.0 } else { 3.0 };
                let power = (f64::from(half) / 2.0).floor() as i32;
                Control::Tolerance(digits / 10f64.powi(-power))
            })
            .collect());
    }
    // Where every step is unstable, any is as good as another.
    let limit = largest_step(method, modes)?.filter(|limit| limit.step > 0.0);
    let limit = limit.map_or(f64::INFINITY, |limit| limit.step);
    let until = frames.until;
    let mut count = round((until / (MAX_LIMIT_RATIO * limit)).ceil().max(MIN_STEPS as f64), until);
    let mut steps = vec![];
    while count <= most {
        steps.push(Control::Step(until / count as f64));
        count = round((count as f64 * RUNG_RATIO).floor(), until).max(count + 1);
    }
    Ok(steps)
}

/// Returns a number of steps near `count` with which steps are 1/n s long, in a time (s) with few
/// decimals; `count` itself if it is too small to be rounded.
fn round(count: f64, until: f64) -> u64 {
    let is_whole = |steps: &f64| *steps > 0.5 && (steps - steps.round()).abs() < 1e-9;
    let unit = (1..=20).map(|n| f64::from(n) * until).find(is_whole);
    match unit.map(f64::round) {
        Some(unit) if count >= MIN_ROUNDED_UNITS * unit => ((count / unit).round() * unit) as u64,
        _ => count as u64,
    }
}

/// Returns the next longer step of a ladder; `None` beyond the longest, and for tolerances.
#[must_use]
pub fn coarser(control: Control, frames: &Frames) -> Option<Control> {
    let count = (frames.until / control.step()?).round();
    let fewer = round((count / RUNG_RATIO).floor().max(MIN_STEPS as f64), frames.until);
    ((fewer as f64) < count).then(|| Control::Step(frames.until / fewer as f64))
}
