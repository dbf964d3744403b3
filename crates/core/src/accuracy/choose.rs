//! The cheapest method, and its step or tolerance, for an error.

use super::{GoOn, Metric, Outcome, Reference, ladder, measure};
use crate::control::Control;
use crate::error::Error;
use crate::integrators::{METHODS, Method};
use crate::scene::Scene;

/// Ratio of the shortest step that fails to the longest that is good enough, at which the search
/// ends.
const CLOSE: f64 = 1.08;
/// The same ratio for tolerances, on which the cost hardly depends.
const CLOSE_TOLERANCE: f64 = 1.7;
/// Most steps that a run takes.
const MOST_STEPS: u64 = 1_000_000;

/// A method with its step or tolerance, and what was measured of its run.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// The method.
    pub method: &'static Method,
    /// The step or the tolerance.
    pub control: Control,
    /// Errors and cost of the run.
    pub outcome: Outcome,
}

/// The cheapest step or tolerance of each method that meets the error, cheapest method first.
///
/// Methods that cost more than twice as much as the two best are left out. `None` if it was told to
/// stop.
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
    // High orders first: what they cost spares the long runs of low ones.
    let mut methods: Vec<_> = METHODS.iter().collect();
    methods.sort_by_key(|method| std::cmp::Reverse(method.order));
    for method in methods {
        if method.check(scene.model.system()).is_err() {
            continue;
        }
        // The second best, which is the runner-up so far.
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

enum Found {
    Best(Candidate),
    Nothing,
    Stopped,
}

struct Search<'a> {
    scene: &'a Scene,
    reference: &'a Reference,
    metric: Metric,
    error: f64,
    method: &'static Method,
    /// Largest cost of a run that is of use, in evaluations.
    dearest: f64,
    go_on: GoOn<'a>,
}

impl Search<'_> {
    fn measure(&self, control: Control) -> Result<Option<Outcome>, Error> {
        measure(self.scene, self.method, control, self.reference, self.go_on)
    }

    /// The error of an outcome over the one asked for; infinite if the run was lost.
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
            // The least cost of fixed steps is known beforehand.
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
            // Rungs that the order says are in vain are skipped.
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

/// A tolerance between a good one and a bad one, or a step between them that fits the frames, if
/// there is one left.
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
        // The nearest that divides the number of frames.
        let fits = |stride: &u64| *stride > 0 && frames.count.is_multiple_of(*stride);
        let near = (0..frames.count).flat_map(|d| [stride + d, stride.saturating_sub(d)]);
        near.into_iter().find(fits)? as f64 * spacing
    };
    inside(step).then_some(Control::Step(step))
}
