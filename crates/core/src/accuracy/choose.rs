//! The cheapest method and setting for an error.

use super::{GoOn, Metric, Outcome, Reference, ladder, measure};
use crate::error::Error;
use crate::integrators::{METHODS, Method};
use crate::scene::Scene;

/// A setting is searched until the next coarser one that fails is no farther than this factor in steps.
const CLOSE: f64 = 1.08;
/// ... or in tolerance, on which the cost hardly depends.
const CLOSE_TOLERANCE: f64 = 1.7;
/// No run takes more steps.
const MOST_STEPS: u64 = 1_000_000;

/// A method at a setting, and how it went.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// The method.
    pub method: &'static Method,
    /// The step (s), or the relative tolerance.
    pub setting: f64,
    /// What was measured.
    pub outcome: Outcome,
}

/// The cheapest setting of each method that meets the error, cheapest method first. Methods that cost more than twice as
/// much as the two best are left out. `None` if it was told to stop.
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
    /// A run that costs more is not tried.
    dearest: f64,
    go_on: GoOn<'a>,
}

impl Search<'_> {
    fn measure(&self, setting: f64) -> Result<Option<Outcome>, Error> {
        measure(self.scene, self.method, setting, self.reference, self.go_on)
    }

    /// The error over the one asked for; infinite if the run was lost.
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
            let Some(&setting) = rungs.get(i) else {
                return Ok(Found::Nothing);
            };
            // Of a method with fixed steps the least cost is known beforehand.
            let steps = frames.until / setting;
            let least = steps * f64::from(self.method.evaluations);
            if !self.method.is_adaptive() && least > self.dearest {
                return Ok(Found::Nothing);
            }
            let Some(outcome) = self.measure(setting)? else {
                return Ok(Found::Stopped);
            };
            let ratio = self.ratio(&outcome);
            if ratio <= 1.0 {
                break (setting, outcome);
            }
            if outcome.work.total() > self.dearest && outcome.lost.is_none() {
                return Ok(Found::Nothing);
            }
            fails = Some(setting);
            // Rungs that the order says are in vain are skipped.
            let order = if self.method.is_adaptive() {
                1.0
            } else {
                f64::from(self.method.order)
            };
            let aim = if ratio.is_finite() {
                setting * (0.5 * ratio).powf(-1.0 / order)
            } else {
                setting
            };
            let next = rungs[i + 1..].iter().position(|rung| *rung <= aim);
            i = next.map_or(rungs.len() - 1, |k| i + 1 + k).max(i + 1);
        };
        let close = if self.method.is_adaptive() {
            CLOSE_TOLERANCE
        } else {
            CLOSE
        };
        while let Some(bad) = fails.filter(|bad| bad / good > close) {
            let Some(middle) = between(good, bad, &frames, self.method.is_adaptive()) else {
                break;
            };
            let Some(next) = self.measure(middle)? else {
                return Ok(Found::Stopped);
            };
            if self.ratio(&next) <= 1.0 {
                (good, outcome) = (middle, next);
            } else {
                fails = Some(middle);
            }
        }
        Ok(Found::Best(Candidate {
            method: self.method,
            setting: good,
            outcome,
        }))
    }
}

/// A setting between two others: a step that fits the frames, if there is one left.
fn between(good: f64, bad: f64, frames: &super::Frames, adaptive: bool) -> Option<f64> {
    let middle = (good * bad).sqrt();
    if adaptive {
        return Some(middle);
    }
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
    inside(step).then_some(step)
}
