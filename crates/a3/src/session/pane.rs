//! One run of the session, and what is known of it.

use std::time::{Duration, Instant};

use a3_core::{Method, Simulation};

use super::limit::LimitWatch;
use super::samples::History;
use crate::progress;
use crate::show::Show;

/// What an adaptive method goes on by at once (s).
pub const PORTION: f64 = 1.0 / 240.0;

/// A run on the screen.
pub struct Pane {
    pub simulation: Simulation,
    pub show: Show,
    /// The solver asked for, also while a scene is shown that it cannot serve.
    pub wanted: &'static Method,
    /// Total energy (J), if the scene has any.
    pub energy: Option<f64>,
    /// The largest length over rest length, if the scene has springs.
    pub stretch: Option<f64>,
    /// How far its step is from the largest stable one.
    pub watch: LimitWatch,
    /// Root mean square distance of the particles from the reference (m), if there is one.
    pub error: Option<f64>,
    /// What it costs, once it is known.
    pub cost: Option<Cost>,
    /// What the plots show.
    pub history: History,
    /// Real time spent on steps.
    computing: Duration,
    /// Time (s), evaluations and computing when the cost was last taken.
    counted: (f64, f64, Duration),
}

/// Per simulated second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Linear algebra included.
    pub evaluations: f64,
    /// In ms.
    pub computing: f64,
}

impl Pane {
    pub fn new(simulation: Simulation, show: Show) -> Self {
        Self {
            wanted: simulation.method(),
            show,
            energy: None,
            watch: LimitWatch::default(),
            stretch: None,
            error: None,
            cost: None,
            history: History::default(),
            computing: Duration::ZERO,
            counted: (simulation.time(), simulation.work().total(), Duration::ZERO),
            simulation,
        }
    }

    /// Whether its run goes on.
    pub fn alive(&self) -> bool {
        self.simulation.blow_up().is_none()
    }

    /// Takes the steps that end by `time` (s). A blow-up is on the screen from then on.
    pub fn take_due_steps(&mut self, time: f64) {
        let begun = Instant::now();
        let adaptive = self.simulation.control().step().is_none();
        let step = self.pace();
        let due = ((time - self.simulation.time()) / step + 1e-9).floor() as u64;
        if !self.alive() {
        } else if adaptive {
            // Read off where it is wanted.
            let _ = self.simulation.advance_to(time);
        } else if due > 0 {
            let _ = self.simulation.take_steps(due);
        }
        self.computing += begun.elapsed();
    }

    /// The step (s); a run to a tolerance, which can be read off anywhere, is asked for no more at once than this.
    pub fn pace(&self) -> f64 {
        self.simulation.control().step().unwrap_or(PORTION)
    }

    /// Goes on to `time` (s) exactly, however long that takes. A blow-up is on the picture from then on.
    pub fn run_to(&mut self, time: f64) {
        let (begun, mut aside) = (Instant::now(), Duration::ZERO);
        let show = &mut self.show;
        let _ = progress::advance(&mut self.simulation, time, |simulation| {
            let begun = Instant::now();
            show.follow(simulation);
            aside += begun.elapsed();
        });
        self.computing += begun.elapsed().saturating_sub(aside);
        self.read_state();
        self.read_cost();
    }

    /// The trail goes on, unless the run is lost: it would lead to where the particle no longer is.
    pub fn follow(&mut self) {
        if self.alive() {
            self.show.follow(&self.simulation);
        }
    }

    /// Energy and stretch of the state as it is now.
    pub fn read_state(&mut self) {
        let energy = self.simulation.energy();
        self.energy = energy.map(|energy| energy.total());
        self.stretch = self.simulation.largest_stretch();
        let computing = self.computing.as_secs_f64();
        self.history
            .take(&self.simulation, energy, self.stretch, computing);
        self.watch.look(&self.simulation);
    }

    /// The cost since it was last taken, if any time was simulated.
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
            self.count();
        }
    }

    /// The cost is taken from here on: of another method, or of another step.
    pub fn count(&mut self) {
        self.watch.ask(self.simulation.method());
        let evaluations = self.simulation.work().total();
        self.counted = (self.simulation.time(), evaluations, self.computing);
    }

    /// The scene's forces are other ones.
    pub fn changed(&mut self) {
        self.watch.hurry();
        self.count();
    }

    /// Back to the beginning.
    pub fn reset(&mut self) {
        self.simulation.reset();
        self.show.clear_trail();
        self.error = None;
        self.count();
    }

    /// Goes on with another scene.
    pub fn set_simulation(&mut self, simulation: Simulation) {
        self.simulation = simulation;
        self.show.clear_trail();
        self.history.clear();
        self.show.springs_of = None;
        (self.error, self.cost) = (None, None);
        self.watch = LimitWatch::default();
        self.count();
    }
}
