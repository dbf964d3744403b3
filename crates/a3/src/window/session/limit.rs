//! The largest stable step of a run, as the run goes on.

use web_time::{Duration, Instant};

use a3_core::stability::{LargestMode, Limit, Mode, largest_step, spectrum};
use a3_core::{Mechanics, Method, Simulation};

use crate::base::holding::would_hold;

/// The least time from one estimate to the next.
const INTERVAL: Duration = Duration::from_millis(250);
/// The least time from one estimate to the next, over the time that the estimate took: estimates
/// take two percent of the time at most.
const IDLE: u32 = 50;
/// Most numbers in a state for all of its modes to be computed while it runs: that takes two
/// evaluations for each number.
const MOST_NUMBERS: usize = 300;
/// Rate at which a mode grows by itself, over its frequency, twice: less is that of rounding.
const GROWS: f64 = 0.01;

/// The largest stable step for the fastest motion of a run, estimated every now and then.
#[derive(Default)]
pub struct LimitWatch {
    fastest: LargestMode,
    modes: Vec<Mode>,
    limit: Option<Limit>,
    next: Option<Instant>,
    would_hold: Option<f64>,
    /// Whether such a step was looked for.
    tried: bool,
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
        let lost = run.blow_up();
        let wait = if lost.is_some() {
            self.tried
        } else {
            self.next.is_some_and(|next| begun < next)
        };
        if wait {
            return;
        }
        if let Some(lost) = lost {
            // The state of a lost run is crumpled: the limits that count are those of the scene.
            let scene = run.scene();
            let modes = spectrum(scene.model.system(), 0.0, &scene.state);
            self.modes.clone_from(&modes);
            self.ask(run.method());
            self.would_hold = would_hold(run, lost.time, &modes);
            self.tried = true;
            return;
        }
        self.modes = self.modes_of(run);
        self.ask(run.method());
        let after = Instant::now();
        self.next = Some(after + INTERVAL.max(IDLE * after.duration_since(begun)));
    }

    /// The modes that set the limit: the fastest, or all of them where damping mixes modes, and
    /// where rods, wires or rigid bodies are. Such a scene has none if its state is too large for
    /// that, or if a mode grows by itself: then the modes set no limit.
    fn modes_of(&mut self, run: &Simulation) -> Vec<Mode> {
        let (system, y) = (run.model().system(), run.state());
        let small = y.len() <= MOST_NUMBERS;
        let all = || spectrum(system, run.time(), y);
        let linearized = system.mechanics().and_then(Mechanics::linearized);
        let Some(free) = linearized.filter(|m| m.baumgarte_frequency().is_none()) else {
            let modes = if small { all() } else { vec![] };
            let grows = |mode: &Mode| mode.drag + mode.damping < -GROWS * mode.frequency();
            return if modes.iter().any(grows) {
                vec![]
            } else {
                modes
            };
        };
        let fastest = self.fastest.estimate(free, run.time(), &y[..y.len() / 2]);
        if small && self.fastest.mixes() {
            all()
        } else {
            fastest.into_iter().collect()
        }
    }

    /// Makes the next look estimate again: the forces have changed.
    pub fn hurry(&mut self) {
        self.next = None;
    }

    /// Finds the limit of another method, for the motion that was seen last.
    pub fn ask(&mut self, method: &Method) {
        // Fails for a method that does not serve damped springs, on a mode that they damp.
        self.limit = largest_step(method, &self.modes).ok().flatten();
        (self.would_hold, self.tried) = (None, false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use a3_core::{Control, integrators};

    #[test]
    fn a_step_that_would_have_held_is_that_of_the_scene() {
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
