//! Choice of the cheapest method, with its step or tolerance, for a given error.

use super::{GoOn, Metric, Outcome, Reference, ladder, measure};
use crate::control::Control;
use crate::error::Error;
use crate::integrators::{METHODS, Method};
use crate::scene::Scene;

/// Ratio of the shortest step that fails to the longest that meets the error, at which the search
/// ends.
const CLOSE: f64 = 1.08;
/// The same ratio for tolerances, on which the cost depends only weakly.
const CLOSE_TOLERANCE: f64 = 1.7;
/// Largest number of steps of a run.
const MOST_STEPS: u64 = 1_000_000;

/// Method with its step or tolerance, and the outcome of its run.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// Method of the run.
    pub method: &'static Method,
    /// Step or tolerance of the run.
    pub control: Control,
    /// Errors and cost of the run.
    pub outcome: Outcome,
}

/// Cheapest step or tolerance of each method that meets the error `error`, in the unit of the
/// metric; the cheapest method comes first.
///
/// The search gives up a method that would cost more than twice as much as the second cheapest so
/// far. Returns `None` if `go_on` returned false.
///
/// # Errors
/// The scene cannot be run.
pub fn choose(
    scene: &Scene,
    reference: &Reference,
    metric: Metric,
    error: f64,
    go_on: GoOn,
) -> Result<Option<Vec<Candidate>>, Error> {
    let mut found: Vec<Candidate> = vec![];
    // Methods of high order come first: their cost bounds the runs of those of low order.
    let mut methods: Vec<_> = METHODS.iter().collect();
    methods.sort_by_key(|method| std::cmp::Reverse(method.order));
    for method in methods {
        if method.check(scene.model.system()).is_err() {
            continue;
        }
        // Cost limit: twice that of the second cheapest candidate so far.
        let dearest = found
            .get(1)
            .map_or(f64::INFINITY, |c| 2.0 * c.outcome.work.total());
        let mut search = Search {
            scene,
            reference,
            metric,
            error,
            method,
            dearest,
            go_on,
        };
        match search.run()? {
            Found::Stopped => return Ok(None),
            Found::Nothing => {}
            Found::Best(candidate) => found.push(candidate),
        }
        found.sort_by(|a, b| {
            let work = |c: &Candidate| c.outcome.work.total();
            work(a).total_cmp(&work(b))
        });
    }
    Ok(Some(found))
}

/// Result of the search for one method.
enum Found {
    /// Cheapest run that meets the error.
    Best(Candidate),
    /// No run meets the error, or it would be too dear.
    Nothing,
    /// The search was told to stop.
    Stopped,
}

/// Search for the cheapest step or tolerance of one method.
struct Search<'a> {
    scene: &'a Scene,
    reference: &'a Reference,
    metric: Metric,
    error: f64,
    method: &'static Method,
    /// Largest cost of a run, in evaluations.
    dearest: f64,
    go_on: GoOn<'a>,
}

impl Search<'_> {
    fn measure(&self, control: Control) -> Result<Option<Outcome>, Error> {
        measure(self.scene, self.method, control, self.reference, self.go_on)
    }

    /// Error of the run over the one asked for; infinite if the run was lost.
    fn ratio(&self, outcome: &Outcome) -> f64 {
        if outcome.lost.is_some() {
            f64::INFINITY
        } else {
            self.metric.of(&outcome.errors) / self.error
        }
    }

    fn run(&mut self) -> Result<Found, Error> {
        let frames = self.reference.frames;
        let rungs = ladder(self.scene, self.method, &frames, MOST_STEPS)?;
        let (mut fails, mut i) = (None, 0);
        let (mut good, mut outcome) = loop {
            let Some(&control) = rungs.get(i) else {
                return Ok(Found::Nothing);
            };
            // The least cost of a run with fixed steps is known beforehand.
            let least = control
                .step()
                .map(|step| frames.until / step * f64::from(self.method.evaluations));
            if least.is_some_and(|least| least > self.dearest) {
                return Ok(Found::Nothing);
            }
            let Some(outcome) = self.measure(control)? else {
                return Ok(Found::Stopped);
            };
            let ratio = self.ratio(&outcome);
            if ratio <= 1.0 {
                break (control, outcome);
            }
            if outcome.work.total() > self.dearest && outcome.lost.is_none() {
                return Ok(Found::Nothing);
            }
            fails = Some(control.value());
            // By the method's order, rungs coarser than `aim` cannot meet the error: they are
            // skipped.
            let order = match control {
                Control::Step(_) => f64::from(self.method.order),
                Control::Tolerance(_) => 1.0,
            };
            let aim = if ratio.is_finite() {
                control.value() * (0.5 * ratio).powf(-1.0 / order)
            } else {
                control.value()
            };
            let next = rungs[i + 1..].iter().position(|rung| rung.value() <= aim);
            i = next.map_or(rungs.len() - 1, |k| i + 1 + k).max(i + 1);
        };
        let close = match good {
            Control::Step(_) => CLOSE,
            Control::Tolerance(_) => CLOSE_TOLERANCE,
        };
        while let Some(bad) = fails.filter(|bad| bad / good.value() > close) {
            let Some(middle) = between(good, bad, &frames) else {
                break;
            };
            let Some(next) = self.measure(middle)? else {
                return Ok(Found::Stopped);
            };
            if self.ratio(&next) <= 1.0 {
                (good, outcome) = (middle, next);
            } else {
                fails = Some(middle.value());
            }
        }
        Ok(Found::Best(Candidate {
            method: self.method,
            control: good,
            outcome,
        }))
    }
}

/// Tolerance between one that meets the error and one that fails, or a step between two such steps
/// that fits the frames; `None` if there is none.
fn between(good: Control, bad: f64, frames: &super::Frames) -> Option<Control> {
    let middle = (good.value() * bad).sqrt();
    let Control::Step(good) = good else {
        return Some(Control::Tolerance(middle));
    };
    let spacing = frames.spacing();
    let inside = |h: f64| h > good * (1.0 + 1e-9) && h < bad * (1.0 - 1e-9);
    let step = if middle < spacing {
        spacing / (spacing / middle).round()
    } else {
        let stride = (middle / spacing).round() as u64;
        // The nearest stride that divides the number of frames.
        let fits = |stride: &u64| *stride > 0 && frames.count.is_multiple_of(*stride);
        let near = (0..frames.count).flat_map(|d| [stride + d, stride.saturating_sub(d)]);
        near.into_iter().find(fits)? as f64 * spacing
    };
    inside(step).then_some(Control::Step(step))
}
