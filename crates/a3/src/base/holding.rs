//! Search for a stable step, after a run with a longer one blew up.

use a3_core::stability::{Mode, largest_step, spectrum};
use a3_core::{Control, Simulation};

use crate::base::bounds::{LARGEST_STEP, SMALLEST_STEP};

/// Least simulated time (s) for which a step has to hold before the window recommends it.
const MIN_HOLD_TIME: f64 = 10.0;
/// Largest [work](a3_core::Model::work) of the trial runs while a window waits (evaluations of
/// single springs). It is the same on every machine, so that the recommended step is the same too.
const MAX_WORK: f64 = 8e6;
/// Largest work of the trial runs at the end of a command, in the same unit.
#[cfg(not(target_arch = "wasm32"))]
const MAX_COMMAND_WORK: f64 = 1e8;

/// Trial runs of a scene with shorter steps.
struct Trials<'a> {
    run: &'a Simulation,
    /// Simulated time for which a step has to hold (s).
    until: f64,
    /// Work that is left (evaluations).
    left: f64,
    /// Returns whether trials may continue; it is told the work done since its last call.
    may_continue: &'a dyn Fn(f64) -> bool,
}

/// Returns the longest step (s) of the trials that holds until the time `until` (s) on the scene of
/// a run with fixed steps. `None` if there is none, or for a run to a tolerance.
#[cfg(not(target_arch = "wasm32"))]
pub fn step_that_holds(run: &Simulation, until: f64) -> Option<f64> {
    let scene = run.scene();
    let modes = spectrum(scene.model.system(), 0.0, &scene.state);
    crate::base::interrupt::listen();
    let left = MAX_COMMAND_WORK / run.model().work();
    let bar = crate::base::progress::Bar::new(left);
    bar.say("looking for a step that holds ".into());
    let trials = Trials {
        run,
        until,
        left,
        may_continue: &|work| {
            bar.advance(work);
            crate::base::interrupt::go_on()
        },
    };
    let holds = trials.longest(&modes);
    bar.clear();
    holds
}

/// Returns a shorter step (s) for a run whose own fixed step does not hold on its scene; `None` if
/// that step was not found to fail. Scenes with contact or rigid bodies are judged by their modes
/// alone, because trial runs of them take too long.
pub fn shorter_step(run: &Simulation) -> Option<f64> {
    let step = run.control().step()?;
    let scene = run.scene();
    let modes = spectrum(scene.model.system(), 0.0, &scene.state);
    let limit = largest_step(run.method(), &modes).ok().flatten();
    let past = limit.is_some_and(|limit| step > limit.step);
    let network = run.model().network();
    let slow = network.is_some_and(|n| n.contact_layer().is_some() || !n.bodies().is_empty());
    let mut trials = Trials::of_window(run, MIN_HOLD_TIME);
    let fails = past || !slow && trials.hold(step) == Some(false);
    let shorter = if slow {
        limit.map(|limit| rounded(0.9 * limit.step))
    } else {
        would_hold(run, MIN_HOLD_TIME, &modes)
    };
    shorter.filter(|shorter| fails && (SMALLEST_STEP..step).contains(shorter))
}

/// Returns a shorter step (s), as [`shorter_step`] does, for a run whose own fixed step is beyond
/// the limit of the modes at the start of its scene: without trials if it is not.
pub fn step_within_limit(run: &Simulation) -> Option<f64> {
    let step = run.control().step()?;
    let modes = spectrum(run.model().system(), 0.0, &run.scene().state);
    let limit = largest_step(run.method(), &modes).ok().flatten()?;
    (step > limit.step).then(|| shorter_step(run)).flatten()
}

/// Returns the longest step (s) of the trials that is shorter than the run's own and holds until
/// the time `until` (s), at least for ten seconds. Trials start just below the stability limit of
/// these modes, those at the start of the scene, so that the result depends neither on the state in
/// which the run diverged nor, except for being shorter, on its step. `None` if there is none, or
/// for a run to a tolerance.
pub fn would_hold(run: &Simulation, until: f64, modes: &[Mode]) -> Option<f64> {
    Trials::of_window(run, until.max(MIN_HOLD_TIME)).longest(modes)
}

impl<'a> Trials<'a> {
    /// Creates trials while a window waits.
    fn of_window(run: &'a Simulation, until: f64) -> Self {
        Self {
            run,
            until,
            left: MAX_WORK / run.model().work(),
            may_continue: &|_| true,
        }
    }

    /// Finds the longest step (s) of the trials that holds, below the limit of these modes and
    /// below the run's own.
    fn longest(mut self, modes: &[Mode]) -> Option<f64> {
        let own = self.run.control().step()?;
        // Never fails for a method in METHODS.
        let limit = largest_step(self.run.method(), modes).ok().flatten();
        let most = limit.map_or(own, |limit| limit.step).min(LARGEST_STEP);
        let mut step = rounded(0.9 * most);
        while step >= SMALLEST_STEP {
            if step < own && self.hold(step)? {
                return Some(step);
            }
            step = rounded(0.6 * step);
        }
        None
    }

    /// Returns whether a run from the start of the scene with steps of h (s) does not diverge,
    /// gains no energy and meets its constraints. `None` if that takes too much work.
    fn hold(&mut self, h: f64) -> Option<bool> {
        let (run, control) = (self.run, Control::Step(h));
        let mut again = Simulation::new(run.scene().clone(), run.method(), control).ok()?;
        again.set_wind(run.windy());
        again.set_swinging(run.swinging());
        // Fails if surfaces cross at the start, where contact cannot begin.
        again.set_touching(run.touching()).ok()?;
        while again.time() < self.until {
            let before = again.work().total();
            if again.take_steps(4).is_err() {
                return Some(false);
            }
            let work = again.work().total() - before;
            self.left -= work;
            if self.left <= 0.0 || !(self.may_continue)(work) {
                return None;
            }
        }
        let broken = again.worst_constraint().is_some_and(|c| c.is_visible());
        Some(again.conclude().is_ok() && again.gained().is_none() && !broken)
    }
}

/// Rounds a number down to one digit.
fn rounded(most: f64) -> f64 {
    let unit = 10f64.powi(most.log10().floor() as i32);
    // Printing and reading removes the rounding error.
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
