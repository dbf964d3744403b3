//! Measurement of a single run: its errors against a reference, and its computing time.

use std::time::{Duration, Instant};

use a3_core::accuracy::{self, Errors, Frames, GoOn, Metric, Outcome, Precision, Reference, Scope};
use a3_core::{Control, Method, Scene, Simulation};

use super::record::Record;
use crate::base::failure::Failure;

/// Largest work of a reference, in evaluations. Small scenes may take more, see
/// [`MAX_REFERENCE_NUMBERS`].
const MAX_REFERENCE_EVALUATIONS: f64 = 80_000.0;
/// Largest work of the reference of a small scene, in evaluations times the length of the state.
const MAX_REFERENCE_NUMBERS: f64 = 1.5e8;
/// Uncertainty of a reference, over the motion of the scene, that suffices for any run.
const UNCERTAINTY: f64 = 1e-10;
/// Largest number of times that a run is timed, including the run whose errors are measured. The
/// shortest time counts.
const MAX_TIMINGS: u32 = 3;
/// Total computing time of two or more runs after which no other is timed.
const MAX_TOTAL: Duration = Duration::from_millis(20);
/// Computing time of a single run after which no other is timed.
const MAX_SINGLE: Duration = Duration::from_millis(50);

/// Runs a method with the setting of `like`, and compares the run with the reference of its scene.
/// Returns its record and its computing time; `None` if `go_on` returned false. `coordinates`
/// receives the largest error of each coordinate (m), n x 3, unless it is empty.
pub fn compared(
    like: Record,
    scene: &Scene,
    method: &'static Method,
    reference: &Reference,
    coordinates: &mut [f64],
    go_on: GoOn,
) -> Result<Option<(Record, Duration)>, Failure> {
    let (control, begun) = (method.control(like.setting), Instant::now());
    let clock = || begun.elapsed();
    let outcome = accuracy::measure_by(
        &clock,
        scene,
        method,
        control,
        reference,
        coordinates,
        go_on,
    )
    .map_err(Failure::run)?;
    let Some(Outcome {
        errors,
        work,
        guarded,
        lost,
        time,
    }) = outcome
    else {
        return Ok(None);
    };
    let Errors {
        position,
        state,
        energy,
        strain,
        momentum,
        phase,
        penetration,
        impact,
    } = errors;
    let (floor, still) = (reference.floor, reference.still);
    let of = |error: f64| Some(error).filter(|_| lost.is_none());
    let record = Record {
        error_position: of(position),
        error_energy: of(energy),
        error_strain: of(strain),
        error_momentum: of(momentum),
        error_phase: of(phase),
        error_penetration: of(penetration),
        error_impact: of(impact),
        error_state: of(state),
        floor_position: floor.position,
        floor_energy: floor.energy,
        floor_strain: floor.strain,
        floor_momentum: floor.momentum,
        floor_phase: floor.phase,
        floor_penetration: floor.penetration,
        floor_impact: floor.impact,
        floor_state: floor.state,
        still_position: still.position,
        still_strain: still.strain,
        still_penetration: still.penetration,
        still_impact: still.impact,
        still_state: still.state,
        lost_at: lost.map(|lost| lost.time),
        guard_impulses: guarded.impulses,
        guard_cuts: guarded.cuts,
        guard_lost: guarded.lost,
        work: work.total(),
        evaluations: work.evaluations,
        solves: work.solves,
        iterations: work.iterations,
        factorizations: work.factorizations,
        rejections: work.rejections,
        ..like
    };
    Ok(Some((record, time)))
}

/// Returns the precision of a reference for all errors that a chart may show. `motion` is the
/// largest distance of the particles from where they start (m).
pub fn precision(scene: &Scene, motion: f64) -> Precision {
    Precision {
        metric: Metric::of_motion(&scene.model),
        uncertainty: UNCERTAINTY * motion,
        max_work: MAX_REFERENCE_EVALUATIONS.max(MAX_REFERENCE_NUMBERS / scene.state.len() as f64),
    }
}

/// Computes the reference of a scene from its start. `None` if `go_on` returned false.
pub fn reference(
    go_on: GoOn,
    scene: &Scene,
    frames: Frames,
    scope: Scope,
    precision: Precision,
) -> Result<Option<Reference>, Failure> {
    Reference::new(scene, frames, scope, precision, go_on)
        .map_err(|e| Failure::run(format!("the reference could not be computed: {e}")))
}

/// Measures the computing time of a run: the shortest of several, including `before` if it is
/// given. `None` if `go_on` returned false.
pub fn time(
    go_on: GoOn,
    scene: &Scene,
    method: &'static Method,
    control: Control,
    frames: &Frames,
    before: Option<Duration>,
) -> Result<Option<Duration>, Failure> {
    let (mut best, mut sum) = (before.unwrap_or(Duration::MAX), before.unwrap_or_default());
    for runs in u32::from(before.is_some())..MAX_TIMINGS {
        if runs > 0 && sum > if runs == 1 { MAX_SINGLE } else { MAX_TOTAL } {
            break;
        }
        let mut run = Simulation::new(scene.clone(), method, control).map_err(Failure::run)?;
        let begun = Instant::now();
        let end = accuracy::run(&mut run, frames, go_on, None);
        let elapsed = begun.elapsed();
        if end.map_err(Failure::run)?.is_none() {
            return Ok(None);
        }
        best = best.min(elapsed);
        sum += elapsed;
    }
    Ok(Some(best))
}
