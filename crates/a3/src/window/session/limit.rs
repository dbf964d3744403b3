//! The largest stable step of a run, updated as it advances.

use web_time::{Duration, Instant};

use a3_core::stability::{Growth, LargestMode, Limit, Mode, largest_step, spectrum};
use a3_core::{Mechanics, Method, Simulation};

use crate::base::holding::{Sought, would_hold};

/// Shortest time between two estimates.
const MIN_INTERVAL: Duration = Duration::from_millis(250);
/// Shortest time between two estimates, over the time that one takes: estimates use at most 2 % of
/// the time.
const MIN_IDLE_RATIO: u32 = 50;
/// Longest state of which all modes are computed during a run, at two evaluations per number.
const MAX_STATE_LENGTH: usize = 300;
/// Twice the growth rate of a mode over its frequency, above which it is unstable by itself. Below,
/// the growth is attributed to rounding.
const MIN_GROWTH_RATIO: f64 = 0.01;

/// Periodic estimates of the largest stable step of a run.
#[derive(Default)]
pub struct LimitWatch {
    fastest: LargestMode,
    modes: Vec<Mode>,
    limit: Option<Limit>,
    next: Option<Instant>,
    sought: Option<Sought>,
}

impl LimitWatch {
    /// Returns the latest estimate of the limit, if there is one.
    pub fn limit(&self) -> Option<Limit> {
        self.limit
    }

    /// Returns the result of the search for a step or a tolerance with which the diverged run would
    /// have held.
    pub fn sought(&self) -> Option<Sought> {
        self.sought
    }

    /// Returns the time (s) in which the motion of the mode that sets the limit grows tenfold in
    /// steps of h (s) of a method; `None` if it does not grow.
    pub fn tenfold_time(&self, method: &Method, h: f64) -> Option<f64> {
        let mode = self.modes.get(self.limit?.mode)?;
        let growth = Growth::new(method, *mode).ok()?.of_step(h);
        let time = h * 10f64.ln() / growth.ln();
        (time > 0.0).then_some(time)
    }

    /// Updates the estimate if it is old enough, or if the run has just diverged.
    pub fn update(&mut self, run: &Simulation) {
        let begun = Instant::now();
        let blow_up = run.blow_up();
        let wait = if blow_up.is_some() {
            self.sought.is_some()
        } else {
            self.next.is_some_and(|next| begun < next)
        };
        if wait {
            return;
        }
        if let Some(blow_up) = blow_up {
            // The state of a diverged run is meaningless, so use the modes of the scene's initial
            // state.
            let scene = run.scene();
            let modes = spectrum(scene.model.system(), 0.0, &scene.state);
            self.modes.clone_from(&modes);
            self.set_method(run.method());
            self.sought = Some(would_hold(run, blow_up.time, &modes));
            return;
        }
        self.modes = self.modes_of(run);
        self.set_method(run.method());
        let after = Instant::now();
        self.next = Some(after + MIN_INTERVAL.max(MIN_IDLE_RATIO * after.duration_since(begun)));
    }

    /// Returns the modes that set the limit. With rods, wires or rigid bodies these are all modes,
    /// or none if the state is too long or a mode is unstable by itself. Otherwise they are all
    /// modes if damping couples them and the state is short enough, or else the fastest mode.
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

    /// Makes the next update estimate again, because the forces have changed.
    pub fn expire(&mut self) {
        self.next = None;
    }

    /// Computes the limit of another method from the last modes.
    pub fn set_method(&mut self, method: &Method) {
        // Fails for a damped mode if the method cannot integrate damped springs.
        self.limit = largest_step(method, &self.modes).ok().flatten();
        self.sought = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use a3_core::{Control, integrators};

    #[test]
    fn the_suggested_step_depends_on_the_scene_alone() {
        // Explicit Euler is limited by slow undamped modes, not by the fastest one.
        let scene = a3_scenes::find("cloth").unwrap().build(None).unwrap().scene;
        let euler = integrators::find("euler").unwrap();
        let named = [0.02, 0.01, 0.007].map(|step| {
            let mut run = Simulation::new(scene.clone(), euler, Control::Step(step)).unwrap();
            assert!(run.advance_to(10.0).is_err());
            let mut watch = LimitWatch::default();
            watch.update(&run);
            watch.sought().unwrap()
        });
        // The suggested step does not depend on the step that was too long.
        let step = 0.003;
        assert_eq!(named, [Sought::Holds(Control::Step(step)); 3]);
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
        // Too early for another estimate.
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
