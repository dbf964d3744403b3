//! Measurement of a single run: its errors against a reference, and its computing time.

use std::time::{Duration, Instant};

use a3_core::accuracy::{self, Errors, Frames, Metric, Outcome, Precision, Reference, Scope};
use a3_core::{Control, Method, Scene, Simulation};

use super::record::Record;
use crate::base::failure::Failure;
use crate::base::interrupt;

/// Work of the runs of the reference at which it is no longer refined: in evaluations, and in those
/// times the length of the state, whichever is more work.
const MOST_OF_REFERENCE: (f64, f64) = (80_000.0, 1.5e8);
/// Uncertainty of the reference over the motion of the scene, below which it is fine enough for any
/// run.
const FINE: f64 = 1e-10;
/// Most times that a run is timed, with the run that is compared. The shortest time counts.
const RUNS: u32 = 3;
/// Total computing time after which a run is timed no more, if it was timed twice.
const TOGETHER: Duration = Duration::from_millis(20);
/// Computing time of a single run after which it is timed no more.
const ALONE: Duration = Duration::from_millis(50);

/// The record of a run by a method with the setting of `like`, compared with the reference of its
/// scene, and the computing time of that run. `coordinates` receives the largest error of each
/// coordinate (m), n x 3, unless it is empty. `None` if it was interrupted.
pub fn compared(
    like: Record,
    scene: &Scene,
    method: &'static Method,
    reference: &Reference,
    coordinates: &mut [f64],
) -> Result<Option<(Record, Duration)>, Failure> {
    let (control, begun) = (method.control(like.setting), Instant::now());
    let clock = || begun.elapsed();
    let go_on = &interrupt::go_on;
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
        // Scenes of files have particles.
        state: _,
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
        floor_position: floor.position,
        floor_energy: floor.energy,
        floor_strain: floor.strain,
        floor_momentum: floor.momentum,
        floor_phase: floor.phase,
        floor_penetration: floor.penetration,
        floor_impact: floor.impact,
        still_position: still.position,
        still_strain: still.strain,
        still_penetration: still.penetration,
        still_impact: still.impact,
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

/// Precision of a reference for all errors that a chart may show, of a scene whose particles move
/// so far (m).
pub fn precision(scene: &Scene, motion: f64) -> Precision {
    let (evaluations, numbers) = MOST_OF_REFERENCE;
    Precision {
        metric: Metric::Position,
        uncertainty: FINE * motion,
        max_work: evaluations.max(numbers / scene.state.len() as f64),
    }
}

/// Reference of a scene from its start. `None` if it was interrupted.
pub fn reference(
    scene: &Scene,
    frames: Frames,
    scope: Scope,
    precision: Precision,
) -> Result<Option<Reference>, Failure> {
    Reference::new(scene, frames, scope, precision, &interrupt::go_on)
        .map_err(|e| Failure::run(format!("the reference could not be computed: {e}")))
}

/// Computing time of a run: the shortest of several, `before` among them, if that is given. `None`
/// if it was interrupted.
pub fn time(
    scene: &Scene,
    method: &'static Method,
    control: Control,
    frames: &Frames,
    before: Option<Duration>,
) -> Result<Option<Duration>, Failure> {
    let (mut best, mut sum) = (before.unwrap_or(Duration::MAX), before.unwrap_or_default());
    for runs in u32::from(before.is_some())..RUNS {
        if runs > 0 && sum > if runs == 1 { ALONE } else { TOGETHER } {
            break;
        }
        let mut run = Simulation::new(scene.clone(), method, control).map_err(Failure::run)?;
        let begun = Instant::now();
        let end = accuracy::run(&mut run, frames, &interrupt::go_on, None);
        let elapsed = begun.elapsed();
        if end.map_err(Failure::run)?.is_none() {
            return Ok(None);
        }
        best = best.min(elapsed);
        sum += elapsed;
    }
    Ok(Some(best))
}
