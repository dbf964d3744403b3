//! Steps that hold where another did not.

use a3_core::stability::{Mode, largest_step, spectrum};
use a3_core::{Control, Simulation};

use crate::base::bounds::{LARGEST_STEP, SMALLEST_STEP};

/// Least simulated time (s) for which the window sees a step hold before it says so.
const HOLDING: f64 = 10.0;
/// Most [work](a3_core::Model::work) of the runs that try steps while a window waits: the same on
/// every machine, so that the step that is named is the same too.
const MOST_WORK: f64 = 8e6;
/// Most such work at the end of a command.
#[cfg(not(target_arch = "wasm32"))]
const MOST_WORK_OF_COMMANDS: f64 = 1e8;

/// Trials of steps on the scene of a run.
struct Trials<'a> {
    run: &'a Simulation,
    /// Simulated time for which a step has to hold (s).
    until: f64,
    /// Work that is left (evaluations).
    left: f64,
    /// Whether trials may go on, after so much work.
    goes_on: &'a dyn Fn(f64) -> bool,
}

/// The longest step (s) that was seen to hold until then (s) on the scene of a run, if it takes
/// fixed steps. `None` where none was found.
#[cfg(not(target_arch = "wasm32"))]
pub fn step_that_holds(run: &Simulation, until: f64) -> Option<f64> {
    let scene = run.scene();
    let modes = spectrum(scene.model.system(), 0.0, &scene.state);
    crate::base::interrupt::listen();
    let left = MOST_WORK_OF_COMMANDS / run.model().work();
    let bar = crate::base::progress::Bar::new(left);
    bar.say("looking for a step that holds ".into());
    let trials = Trials {
        run,
        until,
        left,
        goes_on: &|work| {
            bar.advance(work);
            crate::base::interrupt::go_on()
        },
    };
    let holds = trials.longest(&modes);
    bar.clear();
    holds
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
    let mut trials = Trials::of_window(run, HOLDING);
    let fails = past || !slow && trials.hold(step) == Some(false);
    let shorter = if slow {
        limit.map(|limit| rounded(0.9 * limit.step))
    } else {
        would_hold(run, HOLDING, &modes)
    };
    shorter.filter(|shorter| fails && (SMALLEST_STEP..step).contains(shorter))
}

/// The longest step (s) shorter than the run's own that was seen to hold until then (s), at least
/// for ten seconds, from just below the limit of all motion at the start of the scene. It depends
/// on the scene and the method alone: not on the state that was lost, nor on the step that was too
/// long. `None` where none was found, and for a run to a tolerance.
pub fn would_hold(run: &Simulation, until: f64, modes: &[Mode]) -> Option<f64> {
    Trials::of_window(run, until.max(HOLDING)).longest(modes)
}

impl<'a> Trials<'a> {
    /// Trials that a window waits for.
    fn of_window(run: &'a Simulation, until: f64) -> Self {
        Self {
            run,
            until,
            left: MOST_WORK / run.model().work(),
            goes_on: &|_| true,
        }
    }

    /// The longest step (s) below the limit of these modes, and below the run's own, that holds.
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

    /// Whether a run like this one, from the start of the scene with steps of h (s), is not lost,
    /// gains no energy and meets its constraints. `None` if that takes too much work.
    fn hold(&mut self, h: f64) -> Option<bool> {
        let (run, control) = (self.run, Control::Step(h));
        let mut again = Simulation::new(run.scene().clone(), run.method(), control).ok()?;
        again.set_wind(run.windy());
        again.set_swinging(run.swinging());
        // Surfaces that cross at the beginning cannot touch there.
        again.set_touching(run.touching()).ok()?;
        while again.time() < self.until {
            let before = again.work().total();
            if again.take_steps(4).is_err() {
                return Some(false);
            }
            let work = again.work().total() - before;
            self.left -= work;
            if self.left <= 0.0 || !(self.goes_on)(work) {
                return None;
            }
        }
        let broken = again.worst_constraint().is_some_and(|c| c.is_visible());
        Some(again.conclude().is_ok() && again.gained().is_none() && !broken)
    }
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
