//! The search for the cheapest solvers, and their computing times.

use a3_core::accuracy::{Candidate, Metric, Reference, SetBy, choose, ladder, measure};
use a3_core::stability::spectrum;
use a3_core::{Method, Scene};

use crate::base::failure::Failure;
use crate::base::interrupt;
use crate::base::progress::Bar;
use crate::cli::WorkMeasure;
use crate::commands::chart::single::time;
use crate::commands::chart::{methods, unit};

/// Smallest error that may be asked for, over the uncertainty of the reference.
const MIN_MARGIN: f64 = 3.0;
/// Error over the uncertainty of the reference at which the reference is precise enough.
pub const ENOUGH_MARGIN: f64 = 100.0;
/// Number of candidates that are shown.
const SHOWN: usize = 3;
/// Simulated time of a frame (s).
const FRAME_TIME: f64 = 1.0 / 60.0;

/// Finds the cheapest methods for an error, with the computing times of their frames (ms). `None`
/// if the command was interrupted.
///
/// # Errors
/// The error is too small for the reference, or a run fails.
pub fn cheapest(
    scene: &Scene,
    reference: &Reference,
    (metric, error): (Metric, f64),
    work: WorkMeasure,
    bar: &Bar,
) -> Result<Option<Vec<(Candidate, f64)>>, Failure> {
    let (floor, still) = (metric.of(&reference.floor), metric.of(&reference.still));
    let (unit, until) = (unit(metric), reference.frames.until);
    if error < MIN_MARGIN * floor {
        return Err(Failure::usage(format!(
            "the reference of this scene over {until} s is itself known to {floor:.0e} {unit} only: ask for an error \
             of at least {:.0e}",
            MIN_MARGIN * floor
        )));
    }
    if metric == Metric::Position && error > still {
        bar.warn(&format!(
            "warning: nothing moves further than {still:.0e} m in {until} s: an error of {error:e} m says nothing"
        ));
    }
    bar.start();
    let mut begun = 0;
    let begin = |method: &'static Method| {
        bar.say(format!("{:<10} ", method.name));
        bar.advance(f64::from(u8::from(begun > 0)));
        begun += 1;
    };
    let found = choose(scene, reference, metric, error, &interrupt::go_on, begin);
    bar.clear();
    let Some(mut found) = found.map_err(Failure::run)? else {
        return Ok(None);
    };
    let by_time = work == WorkMeasure::Time;
    if !by_time {
        found.truncate(SHOWN);
    }
    let timed = found.into_iter().map(|candidate| {
        let cost = milliseconds(scene, &candidate, reference)?;
        Ok(cost.map(|cost| (candidate, cost)))
    });
    let mut timed = timed.collect::<Result<Option<Vec<_>>, Failure>>()?;
    if let Some(timed) = timed.as_mut().filter(|_| by_time) {
        timed.sort_by(|(_, a), (_, b)| a.total_cmp(b));
        timed.truncate(SHOWN);
    }
    Ok(timed)
}

/// Measures the computing time of a frame (ms), averaged over the whole run. `None` if the command
/// was interrupted.
fn milliseconds(
    scene: &Scene,
    candidate: &Candidate,
    reference: &Reference,
) -> Result<Option<f64>, Failure> {
    let time = time(
        scene,
        candidate.method,
        candidate.control,
        &reference.frames,
        None,
    )?;
    Ok(time.map(|time| 1e3 * time.as_secs_f64() * FRAME_TIME / reference.frames.until))
}

/// Finds the three most accurate methods, each at its most accurate step or tolerance whose frames
/// take no longer than the budget (ms). `None` if the command was interrupted.
pub fn within(
    scene: &Scene,
    reference: &Reference,
    metric: Metric,
    budget: f64,
    bar: &Bar,
) -> Result<Option<Vec<(Candidate, f64)>>, Failure> {
    let mut found = vec![];
    let modes = spectrum(scene.model.system(), 0.0, &scene.state);
    let error = |c: &Candidate| metric.of(&c.outcome.errors);
    let conserved = matches!(metric, Metric::Energy | Metric::Momentum | Metric::Phase);
    let max_error = if conserved {
        f64::INFINITY
    } else {
        metric.of(&reference.still)
    };
    bar.start();
    for method in methods(scene, &[])? {
        bar.say(format!("{:<10} ", method.name));
        let mut best: Option<(Candidate, f64)> = None;
        for control in ladder(&modes, method, &reference.frames, 1_000_000).map_err(Failure::run)? {
            let outcome = measure(scene, method, control, reference, &interrupt::go_on)
                .map_err(Failure::run)?;
            let Some(outcome) = outcome else {
                return Ok(None);
            };
            let candidate = Candidate {
                method,
                control,
                work: outcome.work.total(),
                outcome,
                set_by: SetBy::Accuracy,
            };
            let Some(cost) = milliseconds(scene, &candidate, reference)? else {
                return Ok(None);
            };
            if cost > budget {
                break;
            }
            // An error larger than the motion says nothing.
            if outcome.lost.is_none()
                && error(&candidate) < max_error
                && best
                    .as_ref()
                    .is_none_or(|(best, _)| error(&candidate) < error(best))
            {
                best = Some((candidate, cost));
            }
            if error(&candidate) < ENOUGH_MARGIN * metric.of(&reference.floor) {
                break;
            }
        }
        found.extend(best);
        bar.advance(1.0);
    }
    bar.clear();
    found.sort_by(|(a, _), (b, _)| error(a).total_cmp(&error(b)));
    found.truncate(SHOWN);
    Ok(Some(found))
}
