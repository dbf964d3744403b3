//! A pane: one run of the session, its appearance, its readings, and its largest stable step,
//! which is updated as it advances.

use std::sync::Arc;

use a3_core::stability::{Growth, LargestMode, Limit, Mode, largest_step, spectrum};
use a3_core::{Checkpoint, Control, Error, Mechanics, Method, Simulation};
use a3_files::holding::{Sought, would_hold};
use a3_files::progress;
use a3_media::show::Show;
use a3_render::Topology;
use a3_scenes::{Defaults, Presentation, Splice};
use web_time::{Duration, Instant};

use super::rows::Samples;
use super::traces::Traces;

/// Simulated time that an adaptive method advances at a time (s).
pub const ADAPTIVE_SLICE: f64 = 1.0 / 240.0;

/// A run on the screen.
pub struct Pane {
    /// The run.
    pub simulation: Simulation,
    /// How the run is drawn.
    pub show: Show,
    /// The solver that the user chose, even if another one integrates the present scene.
    pub wanted: &'static Method,
    /// The step (s) that the user chose, if a shorter one is in use because the scene would blow
    /// up.
    pub wanted_step: Option<f64>,
    /// Total energy (J), if the scene has any.
    pub energy: Option<f64>,
    /// The largest length over rest length, if the scene has springs.
    pub stretch: Option<f64>,
    /// Estimates of the largest stable step.
    pub limit: LimitWatch,
    /// Root mean square distance of the particles from the reference (m), if there is one.
    pub error: Option<f64>,
    /// Cost of the run, once it was measured.
    pub cost: Option<Cost>,
    /// Samples for the plots.
    pub samples: Samples,
    /// What the user plots.
    pub traces: Traces,
    /// Number of times that the scene of the run was changed while it went on.
    exchanges: usize,
    /// Computing time of steps.
    computing: Duration,
    /// Simulated time (s), evaluations and computing time when the cost was last measured.
    counted: (f64, f64, Duration),
}

/// Cost of a simulated second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Evaluations, plus linear algebra in equivalent evaluations.
    pub evaluations: f64,
    /// Computing time (ms).
    pub computing: f64,
}

impl Pane {
    /// Creates a pane for a run.
    pub fn new(simulation: Simulation, show: Show) -> Self {
        Self {
            wanted: simulation.method(),
            wanted_step: None,
            show,
            energy: None,
            limit: LimitWatch::default(),
            stretch: None,
            error: None,
            cost: None,
            samples: Samples::default(),
            traces: Traces::default(),
            exchanges: 0,
            computing: Duration::ZERO,
            counted: (simulation.time(), simulation.work().total(), Duration::ZERO),
            simulation,
        }
    }

    /// Returns the triangles and wires of the surface.
    pub fn topology(&self) -> Topology {
        self.show.topology(&self.simulation)
    }

    /// Returns numbers that change with the topology in one scene: that of torn springs, and that
    /// of exchanges of the run.
    pub fn topology_version(&self) -> [usize; 2] {
        [self.simulation.tears(), self.exchanges]
    }

    /// Returns whether the run has not diverged.
    pub fn alive(&self) -> bool {
        self.simulation.blow_up().is_none()
    }

    /// Takes the steps that end by `time` (s), or advances an adaptive method to `time`. A blow-up
    /// is stored in the run.
    pub fn take_due_steps(&mut self, time: f64) {
        let begun = Instant::now();
        let adaptive = self.simulation.control().step().is_none();
        let step = self.slice();
        let due = ((time - self.simulation.time()) / step + 1e-9).floor() as u64;
        if !self.alive() {
        } else if adaptive && !self.is_followed() {
            // The state at `time` is interpolated within the last step.
            let _ = self.simulation.advance_to(time);
        } else if adaptive {
            while self.alive() && self.simulation.time() < time {
                let next = (self.simulation.time() + ADAPTIVE_SLICE).min(time);
                let _ = self.simulation.advance_to(next);
                self.follow();
            }
        } else if due > 0 {
            // Trails and plots have a point per slice, or per step if steps are longer.
            let at_once =
                if self.is_followed() { ((ADAPTIVE_SLICE / step) as u64).max(1) } else { due };
            let mut left = due;
            while left > 0 && self.alive() {
                let _ = self.simulation.take_steps(left.min(at_once));
                left -= left.min(at_once);
                self.follow();
            }
        }
        self.computing += begun.elapsed();
    }

    /// Returns the simulated time that the run advances at a time (s): its step, or
    /// `ADAPTIVE_SLICE` for an adaptive method, whose state can be interpolated at any time.
    pub fn slice(&self) -> f64 {
        self.simulation.control().step().unwrap_or(ADAPTIVE_SLICE)
    }

    /// Advances the run to exactly `time` (s), however long that takes, and takes its readings. A
    /// blow-up is stored in the run.
    pub fn run_to(&mut self, time: f64) {
        let (begun, mut aside) = (Instant::now(), Duration::ZERO);
        let show = &mut self.show;
        let done = progress::advance(&mut self.simulation, time, |simulation| {
            let begun = Instant::now();
            show.follow(simulation);
            aside += begun.elapsed();
        });
        let _ = done.and_then(|()| self.simulation.conclude());
        self.computing += begun.elapsed().saturating_sub(aside);
        self.read_state();
        self.read_cost();
    }

    /// Returns whether each state on the way is needed: for a trail or for plots.
    fn is_followed(&self) -> bool {
        self.show.has_trail() || !self.traces.is_empty()
    }

    /// Adds the present state to the trail and to the plots, unless the run has diverged.
    pub fn follow(&mut self) {
        if self.alive() {
            self.show.follow(&self.simulation);
            self.traces.take(&self.simulation);
        }
    }

    /// Sets the displacements of the particles from the reference (m), n x 3; empty if they are not
    /// known.
    pub fn set_errors(&mut self, errors: Vec<f64>) {
        let sum = errors.iter().map(|part| part * part).sum::<f64>();
        let mean = sum / self.simulation.particles() as f64;
        self.error = (!errors.is_empty()).then_some(mean.sqrt());
        self.show.colouring.errors = errors;
    }

    /// Updates energy, stretch, samples and the stable step from the present state.
    pub fn read_state(&mut self) {
        let energy = self.simulation.energy();
        self.energy = energy.map(|energy| energy.total());
        self.stretch = self.simulation.largest_stretch();
        let computing = self.computing.as_secs_f64();
        self.samples.take(&self.simulation, energy, self.stretch, computing);
        self.limit.update(&self.simulation);
    }

    /// Updates the cost to that since the last measurement, if any time was simulated.
    pub fn read_cost(&mut self) {
        let (time, evaluations, computing) = self.counted;
        let simulated = self.simulation.time() - time;
        if simulated > 0.0 {
            let evaluated = self.simulation.work().total() - evaluations;
            self.cost = Some(Cost {
                evaluations: evaluated / simulated,
                computing: (self.computing.saturating_sub(computing)).as_secs_f64() * 1e3
                    / simulated,
            });
            self.restart_cost();
        }
    }

    /// Restarts the measurement of cost, and sets the method of the stable step, after a change of
    /// method or step.
    pub fn restart_cost(&mut self) {
        self.limit.set_method(self.simulation.method());
        let evaluations = self.simulation.work().total();
        self.counted = (self.simulation.time(), evaluations, self.computing);
    }

    /// Restarts all measurements, because the forces of the scene have changed.
    pub fn forces_changed(&mut self) {
        // The next update estimates again.
        self.limit.next = None;
        self.restart_cost();
    }

    /// Returns the step or tolerance that a solver gets: that of the run if it takes the same kind.
    pub fn control_of(&self, method: &Method, defaults: &Defaults) -> Control {
        let run = &self.simulation;
        if method.is_adaptive() == run.method().is_adaptive() {
            run.control()
        } else {
            defaults.control_of(method)
        }
    }

    /// Changes the solver, and keeps the step or tolerance if the new one takes the same kind.
    /// Fails if the solver cannot integrate the scene.
    pub fn set_method(
        &mut self,
        method: &'static Method,
        defaults: &Defaults,
    ) -> Result<(), Error> {
        self.wanted_step = None;
        self.simulation.set_method(method, self.control_of(method, defaults))?;
        self.wanted = method;
        self.restart_cost();
        Ok(())
    }

    /// Changes the step (s) or tolerance. Fails if it is out of range.
    pub fn set_step(&mut self, value: f64) -> Result<(), Error> {
        self.wanted_step = None;
        let control = self.simulation.control().with_value(value);
        self.simulation.set_control(control)?;
        self.restart_cost();
        Ok(())
    }

    /// Restores the run from a checkpoint, and releases the grabbed particle or sphere. Fails if
    /// the checkpoint is of another scene.
    pub fn restore(&mut self, checkpoint: &Checkpoint) -> Result<(), Error> {
        self.simulation.restore(checkpoint)?;
        self.simulation.release();
        self.simulation.release_obstacle();
        self.wanted = self.simulation.method();
        self.traces.forget();
        self.show.clear_trail();
        self.forces_changed();
        Ok(())
    }

    /// Resets the run to the initial state.
    pub fn reset(&mut self) {
        self.simulation.reset();
        self.traces.forget();
        self.show.clear_trail();
        self.set_errors(vec![]);
        self.restart_cost();
    }

    /// Replaces the run by one of a changed scene, which goes on from the same state with particles
    /// and rigid bodies of new numbers, and returns the former run. The camera stays.
    pub fn exchange(
        &mut self,
        simulation: Simulation,
        presentation: &Arc<Presentation>,
        [particles, bodies]: [Splice; 2],
    ) -> Simulation {
        let before = std::mem::replace(&mut self.simulation, simulation);
        let viewpoint = self.show.presentation.viewpoint;
        self.show.presentation =
            Arc::new(Presentation { viewpoint, ..Presentation::clone(presentation) });
        self.show.hovered = None;
        self.show.springs_of = self.show.springs_of.and_then(|i| particles.number(i));
        self.traces.renumber([particles, bodies]);
        if particles != Splice::default() {
            self.set_errors(vec![]);
        }
        self.exchanges += 1;
        self.forces_changed();
        before
    }

    /// Replaces the run by one of another scene.
    pub fn set_simulation(&mut self, simulation: Simulation, presentation: Arc<Presentation>) {
        self.simulation = simulation;
        self.show.set_presentation(presentation);
        self.samples.clear();
        self.traces = Traces::default();
        self.set_errors(vec![]);
        self.cost = None;
        self.limit = LimitWatch::default();
        self.restart_cost();
    }
}

/// Shortest time between two estimates.
const MIN_INTERVAL: Duration = Duration::from_millis(250);
/// Shortest time between two estimates, over the time that one takes: estimates use at most 2 % of
/// the time.
const MIN_IDLE_RATIO: u32 = 50;
/// Longest state, in numbers, for which a run computes all modes: that takes two evaluations a
/// number.
const MAX_STATE_LENGTH: usize = 300;
/// Twice the growth rate of a mode over its frequency, above which it is unstable by itself. Below,
/// the growth is attributed to rounding.
const MIN_GROWTH_RATIO: f64 = 0.01;

/// Periodic estimates of the largest stable step of a run.
#[derive(Default)]
pub struct LimitWatch {
    fastest: LargestMode,
    modes: Vec<Mode>,
    /// The latest estimate of the limit.
    pub limit: Option<Limit>,
    next: Option<Instant>,
    /// The result of the search for a step or a tolerance with which the diverged run would have
    /// held.
    pub sought: Option<Sought>,
}

impl LimitWatch {
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
            return if modes.iter().any(grows) { vec![] } else { modes };
        };
        let fastest = self.fastest.estimate(free, run.time(), &y[..y.len() / 2]);
        if small && self.fastest.mixes() { all() } else { fastest.into_iter().collect() }
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
    use a3_core::{Control, integrators};

    use super::*;

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
            watch.sought.unwrap()
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
        assert_eq!(watch.limit, None);
        watch.update(&run);
        let flat = watch.limit.unwrap().step;
        assert!((flat - 0.0349).abs() < 0.001, "{flat}");
        run.advance_to(1.5).unwrap();
        // Too early for another estimate.
        watch.update(&run);
        assert_eq!(watch.limit.unwrap().step, flat);
        for _ in 0..8 {
            watch.next = None;
            watch.update(&run);
        }
        let stretched = watch.limit.unwrap().step;
        assert!(stretched < 0.985 * flat && stretched > 0.9 * flat, "{stretched}");
        watch.set_method(method("implicit"));
        assert!(watch.limit.unwrap().step.is_infinite());
        watch.set_method(method("trapezoid"));
        assert!(watch.limit.unwrap().step < 0.3 * flat);
    }
}
