//! Steps that hold where another did not.

use a3_core::stability::{Mode, largest_step, spectrum};
use a3_core::{Control, Simulation};

use crate::bounds::LARGEST_STEP;

/// Simulated time (s) for which a step was seen to hold before it is said to hold.
const HOLDING: f64 = 10.0;
/// Most [work](a3_core::Model::work) of the runs that try steps, after which a step counts
/// as holding: the same on every machine, so that the step that is named is the same too.
const MOST_WORK: f64 = 8e6;

/// The longest step (s) that was seen to hold on the scene of a run, if it takes fixed steps.
pub fn step_that_holds(run: &Simulation) -> Option<f64> {
    let scene = run.scene();
    let modes = spectrum(scene.model.system(), 0.0, &scene.state);
    would_hold(run, &modes)
}

/// A step (s) for a run whose own fixed step does not hold on its scene; `None` where that was not
/// seen to fail. Scenes with contact or rigid bodies are judged by their modes alone: runs of them
/// take too long.
pub fn shorter_step(run: &Simulation) -> Option<f64> {
    let step = run.control().step()?;
    let scene = run.scene();
    let modes = spectrum(scene.model.system(), 0.0, &scene.state);
    let limit = largest_step(run.method(), &modes).ok().flatten();
    let past = limit.is_some_and(|limit| step > limit.step);
    let network = run.model().network();
    let slow = network.is_some_and(|n| n.contact_layer().is_some() || !n.bodies().is_empty());
    let mut left = MOST_WORK / run.model().work();
    let fails = past || !slow && !holds(run, step, &mut left);
    let shorter = if slow {
        limit.map(|limit| rounded(0.9 * limit.step))
    } else {
        would_hold(run, &modes)
    };
    shorter.filter(|shorter| fails && *shorter < step)
}

/// The longest step (s) that was seen to hold, from just below the limit of all motion at the start
/// of the scene. It depends on the scene and the method alone: not on the state that was lost, nor
/// on the step that was too long. `None` for a run to a tolerance.
pub fn would_hold(run: &Simulation, modes: &[Mode]) -> Option<f64> {
    run.control().step()?;
    // Never fails for a method in METHODS.
    let limit = largest_step(run.method(), modes).ok().flatten()?;
    let mut step = rounded(0.9 * limit.step.min(LARGEST_STEP));
    let mut left = MOST_WORK / run.model().work();
    while left > 0.0 && !holds(run, step, &mut left) {
        step = rounded(0.6 * step);
    }
    Some(step)
}

/// Whether a run from the start of the scene is not lost with steps of h (s), for which it does no
/// more work (in evaluations) than is `left`.
fn holds(run: &Simulation, h: f64, left: &mut f64) -> bool {
    let Ok(mut again) = Simulation::new(run.scene().clone(), run.method(), Control::Step(h)) else {
        return true;
    };
    while again.time() < HOLDING && *left > 0.0 {
        let before = again.work().total();
        if again.take_steps(4).is_err() {
            return false;
        }
        *left -= again.work().total() - before;
    }
    true
}

/// A number rounded down to one digit.
fn rounded(most: f64) -> f64 {
    let unit = 10f64.powi(most.log10().floor() as i32);
    // The shortest decimal, as one would type it.
    let digits = (most / unit + 1e-9).floor() * unit;
    format!("{digits:.0e}").parse().unwrap_or(digits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_rounded_down_to_a_digit() {
        for (most, expected) in [
            (0.013, 0.01),
            (0.031, 0.03),
            (0.000_35, 0.000_3),
            (0.09, 0.09),
        ] {
            assert_eq!(rounded(most), expected);
        }
    }
}
