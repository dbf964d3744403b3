//! The search for the cheapest solvers, and their computing times.

use a3_core::accuracy::{Candidate, Metric, Reference, SetBy, choose_among, ladder, measure};
use a3_core::stability::spectrum;
use a3_core::{Method, Scene};
use a3_files::failure::Failure;
use a3_files::monitor::Monitor;

use crate::chart::measure::time;
use crate::chart::unit;

/// Smallest error that may be asked for, over the uncertainty of the reference.
const MIN_MARGIN: f64 = 3.0;
/// Error over the uncertainty of the reference at which the reference is precise enough.
pub const ENOUGH_MARGIN: f64 = 100.0;
/// Number of candidates that are shown.
const SHOWN: usize = 3;
/// Largest number of steps of a run.
const MAX_STEPS: f64 = 1e6;
/// Simulated time of a frame (s).
const FRAME_TIME: f64 = 1.0 / 60.0;

/// Finds the cheapest methods for an error, with the computing times of their frames (ms). `None`
/// if the monitor stopped it.
///
/// # Errors
/// The error is too small for the reference, or a run fails.
pub fn cheapest(
    methods: &[&'static Method],
    scene: &Scene,
    reference: &Reference,
    (metric, error): (Metric, f64),
    timed: bool,
    monitor: &dyn Monitor,
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
    if matches!(metric, Metric::Position | Metric::State) && error > still {
        monitor.warn(&format!(
            "warning: nothing moves further than {still:.0e} {unit} in {until} s: an error of {error:e} {unit} says nothing"
        ));
    }
    monitor.start();
    let mut begun = 0;
    let begin = |method: &'static Method| {
        monitor.stage(method.name);
        monitor.advance(f64::from(u8::from(begun > 0)));
        begun += 1;
    };
    let go_on = &|| monitor.go_on();
    let found = choose_among(methods, scene, reference, metric, error, go_on, begin);
    monitor.clear();
    let Some(mut found) = found.map_err(Failure::run)? else {
        return Ok(None);
    };
    if !timed {
        found.truncate(SHOWN);
    }
    let measured = found.into_iter().map(|candidate| {
        let cost = milliseconds(scene, &candidate, reference, monitor)?;
        Ok(cost.map(|cost| (candidate, cost)))
    });
    let mut measured = measured.collect::<Result<Option<Vec<_>>, Failure>>()?;
    if let Some(measured) = measured.as_mut().filter(|_| timed) {
        measured.sort_by(|(_, a), (_, b)| a.total_cmp(b));
        measured.truncate(SHOWN);
    }
    Ok(measured)
}

/// Measures the computing time of a frame (ms), averaged over the whole run. `None` if the command
/// was interrupted.
fn milliseconds(
    scene: &Scene,
    candidate: &Candidate,
    reference: &Reference,
    monitor: &dyn Monitor,
) -> Result<Option<f64>, Failure> {
    let time = time(
        &|| monitor.go_on(),
        scene,
        candidate.method,
        candidate.control,
        &reference.frames,
        None,
    )?;
    Ok(time.map(|time| 1e3 * time.as_secs_f64() * FRAME_TIME / reference.frames.until))
}

/// Finds the three most accurate methods, each at its most accurate step or tolerance whose frames
/// take no longer than the budget (ms). `None` if the monitor stopped it.
pub fn within(
    methods: &[&'static Method],
    scene: &Scene,
    reference: &Reference,
    metric: Metric,
    budget: f64,
    monitor: &dyn Monitor,
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
    monitor.start();
    for &method in methods {
        monitor.stage(method.name);
        let mut best: Option<(Candidate, f64)> = None;
        let most = MAX_STEPS.min(reference.max_work) as u64;
        for control in ladder(&modes, method, &reference.frames, most).map_err(Failure::run)? {
            let outcome = measure(scene, method, control, reference, &|| monitor.go_on())
                .map_err(Failure::run)?;
            let Some(outcome) = outcome else {
                return Ok(None);
            };
            if outcome.is_too_costly() {
                break;
            }
            let candidate = Candidate {
                method,
                control,
                work: outcome.work.total(),
                outcome,
                set_by: SetBy::Accuracy,
            };
            let Some(cost) = milliseconds(scene, &candidate, reference, monitor)? else {
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
        monitor.advance(1.0);
    }
    monitor.clear();
    found.sort_by(|(a, _), (b, _)| error(a).total_cmp(&error(b)));
    found.truncate(SHOWN);
    Ok(Some(found))
}
