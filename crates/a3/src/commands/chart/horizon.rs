//! The time up to which the motion of a scene can be predicted.

use a3_core::Scene;
use a3_core::accuracy::{Horizon, horizon};

use crate::base::failure::Failure;
use crate::base::monitor::Monitor;

/// Growth of a small difference from which on it is told.
const MIN_GROWTH: f64 = 2.0;

/// Finds the time up to which the motion of a scene can be predicted. `until` of the result is the
/// end of the runs: `asked` (s), or else that time. Notes the end and its reason if it was not
/// asked for, and warns of one that is too late. `None` if the monitor stopped it.
pub fn look_ahead(
    scene: &Scene,
    asked: Option<f64>,
    stiffness: f64,
    monitor: &dyn Monitor,
) -> Result<Option<Horizon>, Failure> {
    let longest = asked.unwrap_or(f64::INFINITY);
    let Some(found) = horizon(scene, longest, &|| monitor.go_on()).map_err(Failure::run)? else {
        return Ok(None);
    };
    let Horizon {
        until,
        lyapunov,
        growth,
        buckles,
        ..
    } = found;
    let of = if stiffness == 1.0 {
        scene.name.clone()
    } else {
        format!("{} at {stiffness} times its stiffness", scene.name)
    };
    let why = if buckles {
        format!(
            "compressed springs buckle out of the plane of the motion, and errors grow e-fold every {lyapunov:.2} s"
        )
    } else if lyapunov.is_finite() {
        format!("errors grow by themselves e-fold every {lyapunov:.2} s (Lyapunov time)")
    } else if growth > MIN_GROWTH {
        format!("small differences grow {growth:.0}-fold by themselves in {until} s")
    } else {
        "small differences hardly grow by themselves".to_owned()
    };
    match asked {
        Some(asked) if asked > until * (1.0 + 1e-9) && lyapunov.is_finite() => {
            monitor.warn(&format!(
                "warning: {of}: {why}: past {until} s an error in position says little: compare the \
                 energy, or leave out --until"
            ));
        }
        Some(_) => {}
        None => monitor.note(&format!("{of}: {why}; runs of {until} s"))?,
    }
    Ok(Some(Horizon {
        until: asked.unwrap_or(until),
        ..found
    }))
}

/// Checks that something moves in the scene.
pub fn check_motion(scene: &Scene, horizon: &Horizon) -> Result<(), Failure> {
    if horizon.motion > 0.0 {
        return Ok(());
    }
    Err(Failure::usage(format!(
        "nothing moves in {} within {} s, so there are no errors to measure: give something a velocity or a force, or \
         ask for a longer --until",
        scene.name, horizon.until
    )))
}
