//! The largest stable step of a run, as the run goes on.

use web_time::{Duration, Instant};

use a3_core::stability::{LargestMode, Limit, Mode, largest_step, spectrum};
use a3_core::{Mechanics, Method, Simulation};

use crate::base::holding::would_hold;

/// The least time from one estimate to the next.
const MIN_INTERVAL: Duration = Duration::from_millis(250);
/// The least time from one estimate to the next, over the time that the estimate took: estimates
/// take two percent of the time at most.
const MIN_IDLE_RATIO: u32 = 50;
/// Most numbers in a state for all of its modes to be computed while it runs: that takes two
/// evaluations for each number.
const MAX_STATE_LENGTH: usize = 300;
/// Rate at which a mode grows by itself, over its frequency, twice: less is that of rounding.
const MIN_GROWTH_RATIO: f64 = 0.01;

/// The largest stable step for the fastest motion of a run, estimated every now and then.
#[derive(Default)]
pub struct LimitWatch {
    fastest: LargestMode,
    modes: Vec<Mode>,
    limit: Option<Limit>,
    next: Option<Instant>,
    would_hold: Option<f64>,
    /// Whether such a step was looked for.
    searched: bool,
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
    pub fn update(&mut self, run: &Simulation) {
        let begun = Instant::now();
        let blow_up = run.blow_up();
        let wait = if blow_up.is_some() {
            self.searched
        } else {
            self.next.is_some_and(|next| begun < next)
        };
        if wait {
            return;
        }
        if let Some(blow_up) = blow_up {
            // The state of a lost run is crumpled: the limits that count are those of the scene.
            let scene = run.scene();
            let modes = spectrum(scene.model.system(), 0.0, &scene.state);
            self.modes.clone_from(&modes);
            self.set_method(run.method());
            self.would_hold = would_hold(run, blow_up.time, &modes);
            self.searched = true;
            return;
        }
        self.modes = self.modes_of(run);
        self.set_method(run.method());
        let after = Instant::now();
        self.next = Some(after + MIN_INTERVAL.max(MIN_IDLE_RATIO * after.duration_since(begun)));
    }

    /// The modes that set the limit: the fastest, or all of them where damping mixes modes, and
    /// where rods, wires or rigid bodies are. Such a scene has none if its state is too large for
    /// that, or if a mode grows by itself: then the modes set no limit.
    fn modes_of(&mut self, run: &Simulation) -> Vec<Mode> {
        let (system, y) = (run.model().system(), run.state());
        let small = y.len() <= MAX_STATE_LENGTH;
        let all = || spectrum(system, run.time(), y);
        let linearized = system.mechanics().and_then(Mechanics::linearized);
        let Some(free) = linearized.filter(|m| m.baumgarte_frequency().is_none()) else {
            let modes = if small { all() } else { vec![] };
            let grows =
                |mode: &Mode| mode.drag + mode.damping < -MIN_GROWTH_RATIO * mode.frequency();
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
    pub fn expire(&mut self) {
        self.next = None;
    }

    /// Finds the limit of another method, for the motion that was seen last.
    pub fn set_method(&mut self, method: &Method) {
        // Fails for a method that does not serve damped springs, on a mode that they damp.
        self.limit = largest_step(method, &self.modes).ok().flatten();
        (self.would_hold, self.searched) = (None, false);
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
            watch.update(&run);
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
        watch.update(&run);
        let flat = watch.limit().unwrap().step;
        assert!((flat - 0.0349).abs() < 0.001, "{flat}");
        run.advance_to(1.5).unwrap();
        // Not yet time to look.
        watch.update(&run);
        assert_eq!(watch.limit().unwrap().step, flat);
        for _ in 0..8 {
            watch.next = None;
            watch.update(&run);
        }
        let stretched = watch.limit().unwrap().step;
        assert!(
            stretched < 0.985 * flat && stretched > 0.9 * flat,
            "{stretched}"
        );
        watch.set_method(method("implicit"));
        assert!(watch.limit().unwrap().step.is_infinite());
        watch.set_method(method("trapezoid"));
        assert!(watch.limit().unwrap().step < 0.3 * flat);
    }
}
