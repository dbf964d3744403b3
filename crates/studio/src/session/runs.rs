//! The runs of a session and their common time: the panes and the reference, and the steps and
//! tolerances that the keys + and - choose.

use a3_core::{Control, Error, Method, Path, Simulation, StepLength, integrators};
use a3_files::bounds;
use a3_files::failure::Failure;
use a3_files::holding::shorten;
use a3_media::show::Quantity;
use a3_scenes::{Defaults, Setup};
use web_time::{Duration, Instant};

use super::pane::Pane;
use super::reference::ReferenceRun;

/// Longest real time of the steps that a key causes.
pub(super) const KEY_BUDGET: Duration = Duration::from_millis(200);
/// Real time between two readings of the states while they move.
const READING_INTERVAL: Duration = Duration::from_millis(100);

/// The runs of one scene: the panes and the reference.
pub struct Runs {
    /// The visible runs, at least one.
    pub panes: Vec<Pane>,
    /// The run from which errors are measured, if there are several panes.
    pub(super) reference: Option<ReferenceRun>,
    /// Simulated time of the panes (s): each is less than a step behind.
    pub clock: f64,
    /// Number of steps and real time when the states were last read; `None` if they must be read
    /// again.
    pub(super) read: Option<(u64, Instant)>,
    /// Whether a hand has changed the motion since the beginning: a pull, a push or a pin.
    pub touched: bool,
    /// Index of the obstacle that is being pushed, and its path before the push.
    pub(super) pushed: Option<(usize, Path)>,
}

impl Runs {
    /// Creates the runs from panes in their initial state. Fails if there can be no reference.
    pub fn new(panes: Vec<Pane>) -> Result<Self, Failure> {
        Ok(Self {
            reference: ReferenceRun::new(&panes)?,
            panes,
            clock: 0.0,
            read: None,
            touched: false,
            pushed: None,
        })
    }

    /// Returns the first run, for what all of them share.
    pub fn first(&self) -> &Simulation {
        &self.panes[0].simulation
    }

    /// Returns the number of panes that have not diverged.
    pub(super) fn count_alive(&self) -> usize {
        self.panes.iter().filter(|pane| pane.alive()).count()
    }

    /// Returns whether any pane has not diverged.
    pub fn any_alive(&self) -> bool {
        self.panes.iter().any(Pane::alive)
    }

    /// Returns all runs, the reference last.
    pub fn all(&self) -> impl Iterator<Item = &Simulation> {
        let panes = self.panes.iter().map(|pane| &pane.simulation);
        panes.chain(self.reference.iter().map(|it| &it.simulation))
    }

    /// Returns all runs for a change, including diverged and stopped ones, the reference last.
    pub(super) fn all_mut(&mut self) -> impl Iterator<Item = &mut Simulation> {
        let panes = self.panes.iter_mut().map(|pane| &mut pane.simulation);
        panes.chain(self.reference.iter_mut().map(|it| &mut it.simulation))
    }

    /// Advances all panes to a simulated time (s) in short slices, so that none is ahead of the
    /// others if the budget of real time runs out.
    pub(super) fn advance(&mut self, until: f64, budget: Duration, reference_budget: Duration) {
        let begun = Instant::now();
        let steps = self.panes.iter().map(Pane::slice);
        let mut slice = steps.fold(f64::INFINITY, f64::min);
        while self.clock < until && begun.elapsed() < budget && self.any_alive() {
            self.clock = (self.clock + slice).min(until);
            for pane in &mut self.panes {
                pane.take_due_steps(self.clock);
            }
            if begun.elapsed() < budget / 16 {
                slice *= 2.0;
            }
        }
        if let Some(reference) = &mut self.reference {
            reference.follow(&mut self.panes, reference_budget);
        }
        for pane in &mut self.panes {
            pane.follow();
        }
    }

    /// Advances all runs to exactly `time` (s), however long that takes.
    pub(super) fn run_to(&mut self, time: f64) {
        for pane in &mut self.panes {
            pane.run_to(time);
        }
        if let Some(reference) = &mut self.reference {
            reference.run_to(time, &mut self.panes);
        }
        self.drop_due_steps();
    }

    /// Sets the clock back to the latest time of a pane, so that no steps are due.
    pub(super) fn drop_due_steps(&mut self) {
        let alive = self.panes.iter().filter(|pane| pane.alive());
        let times = alive.map(|pane| pane.simulation.time());
        self.clock = times.reduce(f64::max).unwrap_or(self.clock);
    }

    /// Drops due steps and reads the states again, after a time in which nothing was simulated.
    pub(super) fn restart_measuring(&mut self) {
        self.drop_due_steps();
        self.read = None;
    }

    /// Reads the states, ten times a second while they move, and once after they have stopped.
    pub(super) fn read_state(&mut self, moving: bool) {
        let steps = self.panes.iter().map(|pane| pane.simulation.steps()).sum();
        let due = self.read.is_none_or(|(before, when)| {
            before != steps && (!moving || when.elapsed() > READING_INTERVAL)
        });
        if due {
            self.read = Some((steps, Instant::now()));
            self.panes.iter_mut().for_each(Pane::read_state);
        }
    }

    /// Starts another scene, and keeps solvers and steps that can integrate it. Returns a message
    /// if a solver or step had to be replaced. Fails, and changes nothing, if no solver can.
    pub(super) fn set_scene(&mut self, setup: &Setup) -> Result<Option<String>, Error> {
        let mut said = vec![];
        let mut start = |pane: &Pane| {
            let own = pane.simulation.control();
            let control = pane.wanted_step.map_or(own, Control::Step);
            let start = |method| Simulation::new(setup.scene.clone(), method, control);
            // The explicit trapezoid can integrate every scene.
            start(pane.wanted).or_else(|why| {
                said.push(format!("{why}: the explicit trapezoid steps in"));
                start(integrators::find("trapezoid").unwrap_or(pane.wanted))
            })
        };
        let simulations: Result<Vec<_>, Error> = self.panes.iter().map(&mut start).collect();
        for (pane, mut simulation) in self.panes.iter_mut().zip(simulations?) {
            let (asked, why) = shortened(&mut simulation).unzip();
            pane.wanted_step = asked;
            said.extend(why);
            pane.set_simulation(simulation, setup.presentation.clone());
        }
        self.touched = false;
        // The reference does not fail where the panes did not.
        self.reference = ReferenceRun::new(&self.panes).ok().flatten();
        Ok(joined(said))
    }

    /// Shortens steps that would not hold at the start of the scene. Returns a message if one was
    /// shortened.
    pub fn fit_steps(&mut self) -> Option<String> {
        let mut said = vec![];
        for pane in &mut self.panes {
            if let Some((asked, why)) = shortened(&mut pane.simulation) {
                pane.wanted_step = Some(asked);
                pane.restart_cost();
                said.push(why);
            }
        }
        joined(said)
    }

    /// Resets the runs to the initial state of their scene.
    pub(super) fn reset(&mut self) {
        self.panes.iter_mut().for_each(Pane::reset);
        self.touched = false;
        if let Some(reference) = &mut self.reference {
            reference.reset();
        }
    }

    /// Restarts the measurement of errors and costs, after the states of the runs were replaced.
    pub(super) fn states_changed(&mut self) {
        for pane in &mut self.panes {
            pane.set_errors(vec![]);
            pane.restart_cost();
        }
        if let Some(reference) = &mut self.reference {
            reference.follow(&mut self.panes, Duration::ZERO);
        }
    }

    /// Sets the solver of pane `at`. Fails if it cannot integrate the scene.
    pub(super) fn set_method(
        &mut self,
        method: &'static Method,
        at: usize,
        defaults: &Defaults,
    ) -> Result<(), Error> {
        let at = at.min(self.panes.len() - 1);
        let set = self.panes[at].set_method(method, defaults);
        self.adapt_reference();
        set
    }

    /// Sets the next longer or shorter step, or tolerance, in every pane. Fails with the error of
    /// the last pane that refuses it.
    pub(super) fn set_steps(&mut self, longer: bool) -> Result<(), Error> {
        let mut all = Ok(());
        for pane in &mut self.panes {
            let control = pane.simulation.control();
            let range = bounds::of(control);
            let next = next_step(control.value(), longer).clamp(*range.start(), *range.end());
            all = pane.set_step(next).and(all);
        }
        self.adapt_reference();
        all
    }

    /// Sets the step (s) or the tolerance of one pane. Fails if it is out of range.
    pub(super) fn set_step_of(&mut self, at: usize, value: f64) -> Result<(), Error> {
        let set = self.panes[at].set_step(value);
        self.adapt_reference();
        set
    }

    /// Adds a pane, whose run is in the same state as another one's. If there was a single pane, a
    /// reference begins in that state. Fails, and changes nothing, if there can be no reference.
    pub(super) fn add_pane(&mut self, pane: Pane) -> Result<(), Failure> {
        self.panes.push(pane);
        if self.reference.is_some() {
            self.adapt_reference();
        } else {
            let begun = ReferenceRun::new(&self.panes).and_then(|mut reference| {
                if let Some(reference) = &mut reference {
                    reference.continue_from(&self.panes[0].simulation)?;
                }
                Ok(reference)
            });
            self.reference = begun.inspect_err(|_| {
                self.panes.pop();
            })?;
        }
        self.drop_due_steps();
        Ok(())
    }

    /// Removes a pane, and the reference with the last but one.
    pub(super) fn remove_pane(&mut self, at: usize) {
        self.panes.remove(at);
        if let [pane] = &mut *self.panes {
            self.reference = None;
            pane.set_errors(vec![]);
            if pane.show.colouring.quantity == Some(Quantity::Error) {
                pane.show.colouring.set_quantity(None);
            }
        }
        self.adapt_reference();
        self.drop_due_steps();
    }

    /// Adapts the reference to the solvers and steps of the panes.
    pub(super) fn adapt_reference(&mut self) {
        if let Some(reference) = &mut self.reference {
            reference.adapt(&self.panes);
        }
    }
}

/// Joins what is said of several panes, the same only once.
fn joined(mut said: Vec<String>) -> Option<String> {
    said.dedup();
    (!said.is_empty()).then(|| said.join("; "))
}

/// Gives a run a shorter step if its own would not hold. Returns the step that it had (s), and why.
fn shortened(run: &mut Simulation) -> Option<(f64, String)> {
    let asked = shorten(run)?;
    let [shorter, wanted] = [run.control().value(), asked].map(StepLength);
    let solver = run.method().title;
    let why = format!("{solver}: the step is {shorter} here, since {wanted} would not hold");
    Some((asked, why))
}

/// Steps (s) and tolerances, over the power of ten below them.
const LADDER: [f64; 10] = [1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0];

/// Returns the next larger or smaller step or tolerance of the ladder.
pub fn next_step(step: f64, longer: bool) -> f64 {
    let decade = step.log10().floor() as i32;
    let rungs = (decade - 1..=decade + 1).flat_map(|d| {
        // Dividing by 10^n rounds correctly; multiplying by 10^-n, which is not exact, does not.
        LADDER.iter().map(
            move |rung| {
                if d < 0 { rung / 10f64.powi(-d) } else { rung * 10f64.powi(d) }
            },
        )
    });
    let next = if longer {
        rungs.filter(|rung| *rung > step * (1.0 + 1e-9)).reduce(f64::min)
    } else {
        rungs.filter(|rung| *rung < step * (1.0 - 1e-9)).reduce(f64::max)
    };
    next.unwrap_or(step)
}

#[cfg(test)]
mod tests {
    use a3_core::Vector3;
    use a3_files::bounds::{LARGEST_STEP, SMALLEST_STEP};

    use super::*;
    use crate::session::{RunAction, compared, session, times};

    #[test]
    fn a_digit_is_for_one_pane_and_plus_for_all() {
        let mut session = compared(&["e:0.05", "r:0.01", "--scene", "chain"], 0.1);
        session.act(RunAction::Solver(1), 1);
        session.act(RunAction::LongerStep, 1);
        let methods: Vec<_> = session
            .runs
            .panes
            .iter()
            .map(|pane| (pane.simulation.method().name, pane.simulation.control()))
            .collect();
        assert_eq!(methods, [("euler", Control::Step(0.06)), ("trapezoid", Control::Step(0.012))]);
        // One step of the pane with the longest one.
        session.act(RunAction::Reset, 0);
        session.act(RunAction::Step, 0);
        let steps: Vec<_> = session.runs.panes.iter().map(|p| p.simulation.steps()).collect();
        assert_eq!(steps, [1, 5]);
    }

    #[test]
    fn each_solver_whose_step_is_shortened_is_named() {
        let mut session = compared(&["t:0.05", "r:0.05", "--scene", "pendulum"], 0.1);
        let both = |panes: &[Pane]| panes.iter().all(|pane| pane.wanted_step.is_some());
        let mut scenes = 0..a3_scenes::SCENES.len();
        assert!(scenes.any(|_| {
            session.act(RunAction::NextScene, 0);
            both(&session.runs.panes)
        }));
        let said = session.readings.message.unwrap().to_lowercase();
        for run in session.runs.panes.iter().map(|pane| &pane.simulation) {
            let title = run.method().title.to_lowercase();
            assert!(said.contains(&title), "{said}");
        }
    }

    #[test]
    fn panes_keep_the_same_time() {
        let session = compared(&["t:0.03", "r:0.07", "v", "--scene", "chain"], 2.0);
        for pane in &session.runs.panes {
            let (run, step) = (&pane.simulation, pane.slice());
            assert!(
                run.time() < session.runs.clock + 1e-9
                    && run.time() > session.runs.clock - step - 1e-9,
                "{}",
                run.time()
            );
            assert!(
                session.runs.clock > 1.5 && (run.time() - step * run.steps() as f64).abs() < 1e-9
            );
        }
    }

    #[test]
    fn the_error_is_the_distance_from_the_truth() {
        let session = compared(&["e:0.05", "r:0.07", "--scene", "simple"], 5.0);
        for (pane, bound) in session.runs.panes.iter().zip([0.2, 1e-5]) {
            let (run, error) = (&pane.simulation, pane.error.unwrap());
            let (sin, cos) = run.time().sin_cos();
            let truth = (run.position(0) - Vector3::new(cos, sin, 0.0)).norm();
            assert!(error < bound && (error - truth).abs() < 0.02 * truth, "{error} {truth}");
        }
    }

    #[test]
    fn without_a_window_all_end_at_the_same_time() {
        let mut session = session(&["compare", "e:0.03", "r:0.07", "--scene", "simple"]);
        session.run_to(1.0);
        assert_eq!(times(&session), [1.0, 1.0]);
        let errors: Vec<_> = session.runs.panes.iter().map(|p| p.error.unwrap()).collect();
        assert!(errors[0] > 0.01 && errors[1] < 1e-5, "{errors:?}");
        let cost = session.runs.panes[0].cost.unwrap();
        assert_eq!(cost.evaluations, 34.0);
        assert!(cost.computing > 0.0);
    }

    #[test]
    fn a_slow_pane_slows_all_others() {
        let mut session = session(&["compare", "e:0.0000001", "r:0.0001"]);
        for _ in 0..4 {
            session.tick(0.1);
        }
        let times = times(&session);
        assert!(times[0] > 0.0 && times[0] < 0.2, "{times:?}");
        assert!(times[1] <= times[0] + 1e-9 && times[0] - times[1] < 1.1e-4, "{times:?}");
    }

    #[test]
    fn steps_climb_the_ladder() {
        assert_eq!(next_step(0.01, true), 0.012);
        assert_eq!(next_step(0.01, false), 0.008);
        assert_eq!(next_step(0.008, true), 0.01);
        assert_eq!(next_step(0.0123, false), 0.012);
        assert_eq!(next_step(8.0, true), 10.0);
        let ends = |solver, end: f64, longer| {
            let mut session = session(&[solver, &end.to_string(), "--scene", "chain"]);
            let action = if longer { RunAction::LongerStep } else { RunAction::ShorterStep };
            session.act(action, 0);
            session.runs.first().control().value() == end
        };
        assert!(ends("r", LARGEST_STEP, true) && ends("r", SMALLEST_STEP, false));
        assert!(ends("a", 1.0, true) && ends("a", 1e-13, false));
    }
}
