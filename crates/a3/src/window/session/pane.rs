//! A pane: one run of the session, and what is known of it.

use std::sync::Arc;
use web_time::{Duration, Instant};

use a3_core::{Checkpoint, Error, Method, Simulation};
use a3_render::Topology;
use a3_scenes::{Defaults, Presentation};

use super::limit::LimitWatch;
use super::samples::Samples;
use crate::base::progress;
use crate::draw::show::Show;

/// Simulated time by which an adaptive method goes on at once (s).
pub const ADAPTIVE_SLICE: f64 = 1.0 / 240.0;

/// A run on the screen.
pub struct Pane {
    /// The run.
    pub simulation: Simulation,
    /// How the run is drawn.
    pub show: Show,
    /// The solver that was asked for, also while a scene is shown that it cannot serve.
    pub wanted: &'static Method,
    /// The step (s) that was asked for, while a scene is shown that it does not hold.
    pub wanted_step: Option<f64>,
    /// Total energy (J), if the scene has any.
    pub energy: Option<f64>,
    /// The largest length over rest length, if the scene has springs.
    pub stretch: Option<f64>,
    /// The largest stable step, as it changes.
    pub limit: LimitWatch,
    /// Root mean square distance of the particles from the reference (m), if there is one.
    pub error: Option<f64>,
    /// Cost of the run, once it is known.
    pub cost: Option<Cost>,
    /// Samples for the plots.
    pub samples: Samples,
    /// Real time spent on steps.
    computing: Duration,
    /// Simulated time (s), evaluations and computing time when the cost was last taken.
    counted: (f64, f64, Duration),
}

/// Cost of a simulated second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Evaluations, with linear algebra counted in evaluations.
    pub evaluations: f64,
    /// Computing time (ms).
    pub computing: f64,
}

impl Pane {
    /// A pane that begins with this run.
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
            computing: Duration::ZERO,
            counted: (simulation.time(), simulation.work().total(), Duration::ZERO),
            simulation,
        }
    }

    /// The triangles and wires of the surface.
    pub fn topology(&self) -> Topology {
        self.show.topology(&self.simulation)
    }

    /// Whether the run goes on: it is not lost.
    pub fn alive(&self) -> bool {
        self.simulation.blow_up().is_none()
    }

    /// Takes the steps that end by `time` (s). A blow-up is shown from then on.
    pub fn take_due_steps(&mut self, time: f64) {
        let begun = Instant::now();
        let adaptive = self.simulation.control().step().is_none();
        let step = self.slice();
        let due = ((time - self.simulation.time()) / step + 1e-9).floor() as u64;
        if !self.alive() {
        } else if adaptive && !self.show.has_trail() {
            // The state is read off between two steps.
            let _ = self.simulation.advance_to(time);
        } else if adaptive {
            while self.alive() && self.simulation.time() < time {
                let next = (self.simulation.time() + ADAPTIVE_SLICE).min(time);
                let _ = self.simulation.advance_to(next);
                self.follow();
            }
        } else if due > 0 {
            // A trail has a point for each step, or for as many as make a portion.
            let at_once = if self.show.has_trail() {
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

    /// Simulated time by which the run goes on at once (s): its step, or a portion for a run to a
    /// tolerance, whose state can be read off anywhere.
    pub fn slice(&self) -> f64 {
        self.simulation.control().step().unwrap_or(ADAPTIVE_SLICE)
    }

    /// Brings the run to `time` (s) exactly, however long that takes. A blow-up is shown from then
    /// on.
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

    /// Continues the trail, unless the run is lost: its state is then no longer that of the motion.
    pub fn follow(&mut self) {
        if self.alive() {
            self.show.follow(&self.simulation);
        }
    }

    /// Takes the ways to the particles from where the reference has them (m), n x 3; none where
    /// they are not known.
    pub fn set_errors(&mut self, errors: Vec<f64>) {
        let sum = errors.iter().map(|part| part * part).sum::<f64>();
        let mean = sum / self.simulation.particles() as f64;
        self.error = (!errors.is_empty()).then_some(mean.sqrt());
        self.show.colouring.errors = errors;
    }

    /// Takes energy, stretch, a sample and the stable step of the state as it is now.
    pub fn read_state(&mut self) {
        let energy = self.simulation.energy();
        self.energy = energy.map(|energy| energy.total());
        self.stretch = self.simulation.largest_stretch();
        let computing = self.computing.as_secs_f64();
        self.samples
            .take(&self.simulation, energy, self.stretch, computing);
        self.limit.update(&self.simulation);
    }

    /// Takes the cost since it was last taken, if any time was simulated.
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

    /// Counts the cost from here on: of another method, or of another step.
    pub fn restart_cost(&mut self) {
        self.limit.set_method(self.simulation.method());
        let evaluations = self.simulation.work().total();
        self.counted = (self.simulation.time(), evaluations, self.computing);
    }

    /// Notes that the forces of the scene have changed.
    pub fn forces_changed(&mut self) {
        self.limit.expire();
        self.restart_cost();
    }

    /// Goes on with another solver, with the same step or tolerance if it has one of that kind.
    /// Fails if the solver does not serve the scene.
    pub fn set_method(
        &mut self,
        method: &'static Method,
        defaults: &Defaults,
    ) -> Result<(), Error> {
        self.wanted_step = None;
        let run = &self.simulation;
        let control = if method.is_adaptive() == run.method().is_adaptive() {
            run.control()
        } else {
            defaults.control_of(method)
        };
        self.simulation.set_method(method, control)?;
        self.wanted = method;
        self.restart_cost();
        Ok(())
    }

    /// Goes on with another step (s) or tolerance. Fails if it is refused.
    pub fn set_step(&mut self, value: f64) -> Result<(), Error> {
        self.wanted_step = None;
        let control = self.simulation.control().with_value(value);
        self.simulation.set_control(control)?;
        self.restart_cost();
        Ok(())
    }

    /// Goes on where a run was kept in a checkpoint. A hand lets go. Fails if the checkpoint is not
    /// of such a run.
    pub fn restore(&mut self, checkpoint: &Checkpoint) -> Result<(), Error> {
        self.simulation.restore(checkpoint)?;
        self.simulation.release();
        self.simulation.release_obstacle();
        self.wanted = self.simulation.method();
        self.show.clear_trail();
        self.forces_changed();
        Ok(())
    }

    /// Goes back to the beginning.
    pub fn reset(&mut self) {
        self.simulation.reset();
        self.show.clear_trail();
        self.set_errors(vec![]);
        self.restart_cost();
    }

    /// Goes on with another scene.
    pub fn set_simulation(&mut self, simulation: Simulation, presentation: Arc<Presentation>) {
        self.simulation = simulation;
        self.show.set_presentation(presentation);
        self.samples.clear();
        self.set_errors(vec![]);
        self.cost = None;
        self.limit = LimitWatch::default();
        self.restart_cost();
    }
}
