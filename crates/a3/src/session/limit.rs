//! The largest stable step of a run, as the run goes on.

use std::time::{Duration, Instant};

use a3_core::stability::{LargestMode, Limit, Mode, largest_step, spectrum};
use a3_core::{Control, Mechanics, Method, Simulation};

use crate::bounds::LARGEST_STEP;

/// The least time from one estimate to the next.
const INTERVAL: Duration = Duration::from_millis(250);
/// The least time from one estimate to the next, over the time that the estimate took: estimates
/// take two percent of the time at most.
const IDLE: u32 = 50;
/// Largest state of a system without masses, or with rigid bodies, that is watched as it moves:
/// an estimate takes as many evaluations as there are numbers, twice.
const MOST_NUMBERS: usize = 300;
/// Simulated time (s) for which a step was seen to hold before it is said to hold.
const HOLDING: f64 = 10.0;
/// Most [work](a3_core::Model::work) of the runs that try steps, after which a step counts
/// as holding: the same on every machine, so that the step that is named is the same too.
const MOST_WORK: f64 = 8e6;

/// The largest stable step for the fastest motion of a run, estimated every now and then.
#[derive(Default)]
pub struct LimitWatch {
    fastest: LargestMode,
    mode: Option<Mode>,
    limit: Option<Limit>,
    next: Option<Instant>,
    would_hold: Option<f64>,
}

impl LimitWatch {
    /// The limit of the run's method for the fastest motion, as it was last estimated.
    pub fn limit(&self) -> Option<Limit> {
        self.limit
    }

    /// A step (s) with which a lost run would have held.
    pub fn would_hold(&self) -> Option<f64> {
        self.would_hold
    }

    /// Estimates again if the last estimate is old enough, or if the run was just lost.
    pub fn look(&mut self, run: &Simulation) {
        let begun = Instant::now();
        let lost = run.blow_up().is_some();
        let wait = if lost {
            self.would_hold.is_some()
        } else {
            self.next.is_some_and(|next| begun < next)
        };
        if wait {
            return;
        }
        if lost {
            // The state of a lost run is crumpled: the limits that count are those of the scene.
            let scene = run.scene();
            let modes = spectrum(scene.model.system(), 0.0, &scene.state);
            self.mode = modes.first().copied();
            self.ask(run.method());
            self.would_hold = would_hold(run, &modes);
            return;
        }
        let y = run.state();
        let system = run.model().system();
        self.mode = match system.mechanics().and_then(Mechanics::linearized) {
            Some(linearized) => {
                let (x, _) = y.split_at(y.len() / 2);
                self.fastest.estimate(linearized, run.time(), x)
            }
            None if y.len() <= MOST_NUMBERS => spectrum(system, run.time(), y).first().copied(),
            None => None,
        };
        self.ask(run.method());
        let after = Instant::now();
        self.next = Some(after + INTERVAL.max(IDLE * after.duration_since(begun)));
    }

    /// Makes the next look estimate again: the forces have changed.
    pub fn hurry(&mut self) {
        self.next = None;
    }

    /// Finds the limit of another method, for the motion that was seen last.
    pub fn ask(&mut self, method: &Method) {
        let modes = self.mode.as_slice();
        // Fails for a method that does not serve damped springs, on a mode that they damp.
        self.limit = largest_step(method, modes).ok().flatten();
        self.would_hold = None;
    }
}

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
fn would_hold(run: &Simulation, modes: &[Mode]) -> Option<f64> {
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
    use a3_core::integrators;

    #[test]
    fn a_step_that_would_hold_is_short_and_within() {
        for (most, expected) in [
            (0.013, 0.01),
            (0.031, 0.03),
            (0.000_35, 0.000_3),
            (0.09, 0.09),
        ] {
            assert_eq!(rounded(most), expected);
        }
        // Euler's method is limited by slow motion without damping, of which the fastest motion
        // knows nothing.
        let scene = a3_scenes::find("cloth").unwrap().build(None).unwrap().scene;
        let euler = integrators::find("euler").unwrap();
        let named = [0.02, 0.01, 0.007].map(|step| {
            let mut run = Simulation::new(scene.clone(), euler, Control::Step(step)).unwrap();
            assert!(run.advance_to(10.0).is_err());
            let mut watch = LimitWatch::default();
            watch.look(&run);
            watch.would_hold().unwrap()
        });
        // Whatever step was too long, the step that would have held is the same.
        let step = named[0];
        assert_eq!(named, [step; 3]);
        assert_eq!(step, 0.003);
        let mut run = Simulation::new(scene, euler, Control::Step(step)).unwrap();
        run.advance_to(10.0).unwrap();
    }

    #[test]
    fn the_limit_follows_the_method_and_the_cloth() {
        let scene = a3_scenes::find("mit").unwrap().build(None).unwrap().scene;
        let method = |name| integrators::find(name).unwrap();
        let mut run = Simulation::new(scene, method("rk4"), Control::Step(0.01)).unwrap();
        let mut watch = LimitWatch::default();
        assert_eq!(watch.limit(), None);
        watch.look(&run);
        let flat = watch.limit().unwrap().step;
        assert!((flat - 0.0349).abs() < 0.001, "{flat}");
        run.advance_to(1.5).unwrap();
        // Not yet time to look.
        watch.look(&run);
        assert_eq!(watch.limit().unwrap().step, flat);
        for _ in 0..8 {
            watch.next = None;
            watch.look(&run);
        }
        let stretched = watch.limit().unwrap().step;
        assert!(
            stretched < 0.985 * flat && stretched > 0.9 * flat,
            "{stretched}"
        );
        watch.ask(method("implicit"));
        assert!(watch.limit().unwrap().step.is_infinite());
        watch.ask(method("trapezoid"));
        assert!(watch.limit().unwrap().step < 0.3 * flat);
    }
}
