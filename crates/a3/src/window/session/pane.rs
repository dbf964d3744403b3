//! A pane: one run of the session, its appearance, and its readings.

use std::sync::Arc;
use web_time::{Duration, Instant};

use a3_core::{Checkpoint, Control, Error, Method, Simulation};
use a3_render::Topology;
use a3_scenes::{Defaults, Presentation, Splice};

use super::limit::LimitWatch;
use super::samples::Samples;
use super::traces::Traces;
use crate::base::progress;
use crate::draw::show::Show;

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
            let at_once = if self.is_followed() {
                ((ADAPTIVE_SLICE / step) as u64).max(1)
            } else {
                due
            };
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
        self.samples
            .take(&self.simulation, energy, self.stretch, computing);
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
        self.limit.expire();
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
        self.simulation
            .set_method(method, self.control_of(method, defaults))?;
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
        self.show.presentation = Arc::new(Presentation {
            viewpoint,
            ..Presentation::clone(presentation)
        });
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
