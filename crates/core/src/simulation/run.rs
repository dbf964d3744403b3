//! Run of a scene: how it advances, and what it has cost and gained.

use super::balance::Gain;
use super::checkpoint::Checkpoint;
use super::driver::Driver;
use super::pins::strayed;
use super::reach::STEP_END_TOLERANCE;
use super::state::RunState;
use super::step::{Pipeline, StepFailure};
use super::stepper::Stepper;
use crate::contact::{Guarded, Statistics};
use crate::control::Control;
use crate::error::{BlowUp, Cause, Error, Unmet};
use crate::integrators::{Method, Work};
use crate::network::{Network, is_conservative};
use crate::scene::{Model, Scene};

/// A run of a scene.
///
/// A network falls from where its spring has its rest length, and swings about the place where it
/// hangs at rest, 0.1 m below:
///
/// ```
/// # use a3_core::{Control, Network, Path, Scene, Simulation, integrators};
/// # use a3_core::{Spring, SpringKind, SpringLaw, Vector3};
/// # let mut network = Network::new(vec![1.0; 2])?;
/// # let law = SpringLaw::new(98.1, 1.0, 0.0)?;
/// # network.add_spring(Spring { kind: SpringKind::Structural, i: 0, j: 1, law })?;
/// # network.pin(0, Path::Still(Vector3::zeros()))?;
/// # network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
/// # let mut state = vec![0.0; 12];
/// # state[3] = -1.0;
/// # let scene = Scene::new("weight", network, state);
/// let verlet = integrators::find("verlet").unwrap();
/// let mut run = Simulation::new(scene, verlet, Control::Step(0.001))?;
/// let before = run.energy().unwrap().total();
/// let half_period = std::f64::consts::PI / 98.1_f64.sqrt();
/// run.advance_to(half_period)?;
/// assert!((run.position(1).y + 1.2).abs() < 1e-5);
/// assert!((run.energy().unwrap().total() - before).abs() < 1e-4);
/// # Ok::<(), a3_core::Error>(())
/// ```
pub struct Simulation {
    pub(super) scene: Scene,
    pub(super) model: Model,
    pub(super) state: RunState,
    pub(super) driver: Driver,
    /// The last sound state, to go back to when a step fails.
    good: Checkpoint,
    blow_up: Option<BlowUp>,
    /// Time at which a function last passed through 0 (s), if one did.
    passed: Option<f64>,
    /// Time at which the state was set where a function had passed through 0 (s): rounding decides
    /// on which side of 0 the function is there.
    leaves: Option<f64>,
}

/// Way in which a function passes through 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Passage {
    /// From below.
    Rising,
    /// From above.
    Falling,
    /// In either way.
    #[default]
    Either,
}

impl Passage {
    /// Returns whether a function that was `before` and is `now` has passed through 0 in this way.
    fn is_between(self, before: f64, now: f64) -> bool {
        let rises = before < 0.0 && now >= 0.0;
        let falls = before > 0.0 && now <= 0.0;
        match self {
            Self::Rising => rises,
            Self::Falling => falls,
            Self::Either => rises || falls,
        }
    }
}

/// Number of looks at a function in each step: one that passes through 0 and back between two of
/// them is missed.
const LOOKS: u32 = 4;

impl Simulation {
    /// Share of a step by which its end may miss a requested time, such as 1/60 s as 0.01666667.
    pub const STEP_END_TOLERANCE: f64 = STEP_END_TOLERANCE;

    /// Creates a run at the beginning of a scene, in fixed steps or, by an adaptive method, to a
    /// tolerance.
    ///
    /// # Errors
    /// The method does not support the scene or the control; or the scene's state and its model
    /// differ in length.
    pub fn new(scene: Scene, method: &'static Method, control: Control) -> Result<Self, Error> {
        let model = scene.model.clone();
        let stepper = Stepper::new(method, &scene, model.system(), control)?;
        let mut state = RunState::begin(&scene, method, control)?;
        let mut driver = Driver::new(Pipeline::new(stepper, &scene));
        driver.pipeline.watch.begin(&model, &mut state);
        Ok(Self {
            good: Checkpoint::of(&state, &model, &driver),
            scene,
            model,
            state,
            driver,
            blow_up: None,
            passed: None,
            leaves: None,
        })
    }

    /// Lets energy that the run gains end it no more: the energy of a mode may rise far and fall
    /// again, near the limit of a method, without growing in the end.
    pub(crate) fn tolerate_gains(mut self) -> Self {
        self.state.balance.tolerate(f64::INFINITY);
        self
    }

    /// Goes back to the beginning, and mends torn springs. Wind, swing, freed pins and contact of
    /// surfaces stay as they are, unless surfaces cross at the beginning. The hand lets go.
    pub fn reset(&mut self) {
        let disturbances = self.disturbances();
        let RunState { method, control, unpinned, .. } = self.state;
        self.model = self.scene.model.clone();
        self.state = RunState::new(method, control, self.scene.state.clone());
        self.driver.pipeline.phases.contact.forget_impulses();
        (self.blow_up, self.passed, self.leaves) = (None, None, None);
        // The first step is chosen as in a new run: one that was reset is the same run.
        if let Ok(stepper) = Stepper::new(method, &self.scene, self.model.system(), control) {
            self.driver.change_stepper(stepper);
        }
        if unpinned {
            self.set_pinned(false);
        }
        // If surfaces cross, contact stays as in the scene.
        let _ = self.set_disturbances(disturbances);
        let watch = &mut self.driver.pipeline.watch;
        watch.begin(&self.model, &mut self.state);
    }

    /// Makes fixed steps end at events, as adaptive ones do: where a prescribed motion begins or
    /// ends, a particle touches an obstacle, a slide ends, or a spring breaks. The rest of the step
    /// follows from there. This keeps the order of the method at any cost, and is meant for
    /// reference solutions.
    pub fn locate_events(&mut self) {
        self.driver.pipeline.locator.splits_fixed_steps = true;
    }

    /// Continues with another method, in fixed steps or to a tolerance.
    ///
    /// # Errors
    /// The method does not support the scene or the control; the run then continues as before.
    pub fn set_method(&mut self, method: &'static Method, control: Control) -> Result<(), Error> {
        let stepper = Stepper::new(method, &self.scene, self.model.system(), control)?;
        self.driver.change_stepper(stepper);
        self.state.set_time(self.time());
        (self.state.method, self.state.control) = (method, control);
        let watch = &mut self.driver.pipeline.watch;
        watch.start_over(&self.model, &mut self.state);
        Ok(())
    }

    /// Continues with another step or tolerance.
    ///
    /// # Errors
    /// The method does not support the control; the run then continues as before.
    pub fn set_control(&mut self, control: Control) -> Result<(), Error> {
        let (Control::Step(_), Control::Step(_)) = (self.state.control, control) else {
            return self.set_method(self.state.method, control);
        };
        self.state.method.check_control(control)?;
        self.stop();
        self.state.set_time(self.time());
        self.state.control = control;
        let watch = &mut self.driver.pipeline.watch;
        watch.start_over(&self.model, &mut self.state);
        Ok(())
    }

    /// Takes `count` steps. If the time shown is within a step, that step is finished first, and
    /// counts. When a step blows up, the run goes back to the last sound state at the beginning of
    /// such a call, and takes no more steps until [`reset`](Self::reset).
    ///
    /// # Errors
    /// The run blew up, now or earlier.
    pub fn take_steps(&mut self, count: u64) -> Result<(), Error> {
        self.save_if_sound()?;
        let taken = self.driver.take_steps(&mut self.model, &mut self.state, count);
        taken.map_err(|failure| self.fail(failure))
    }

    /// Advances to `time` (s), if it is not past it. No step is shortened for that: if none ends at
    /// that time, the state shown is interpolated within the step that contains it, so how often a
    /// run is shown does not change it. A step that blows up is treated as by
    /// [`take_steps`](Self::take_steps).
    ///
    /// # Errors
    /// The run blew up, now or earlier; or `time` is not finite.
    pub fn advance_to(&mut self, time: f64) -> Result<(), Error> {
        self.advance_in(time, u64::MAX - 1).map(drop)
    }

    /// Does what [`advance_to`](Self::advance_to) does, in at most `count` whole steps and one
    /// more. Returns whether it has arrived: if not, the run is at the end of a
    /// step.
    ///
    /// # Errors
    /// As [`advance_to`](Self::advance_to).
    pub fn advance_in(&mut self, time: f64, count: u64) -> Result<bool, Error> {
        if !time.is_finite() {
            return Err(Error::Invalid(format!(
                "the end must be a finite number of seconds, not {time}"
            )));
        }
        self.save_if_sound()?;
        let (model, state) = (&mut self.model, &mut self.state);
        let gone = self.driver.advance(model, state, (time, count));
        gone.map_err(|failure| self.fail(failure))
    }

    /// Advances to the first time at which a function of t and y passes through 0, or else to
    /// `until` (s). The time is found on the method's own polynomial, to rounding, and no step is
    /// shortened. Returns whether it was found; the state shown is then that just after it.
    ///
    /// A ball falls from 1 m, and loses half of its speed in each bounce:
    ///
    /// ```
    /// use a3_core::{Control, Ode, Passage, Scene, Simulation, integrators};
    ///
    /// let fall = Ode::new(2, |_t, y, dydt| (dydt[0], dydt[1]) = (y[1], -9.81))?;
    /// let dopri5 = integrators::find("dopri5").unwrap();
    /// let scene = Scene::new("ball", fall, vec![1.0, 0.0]);
    /// let mut run = Simulation::new(scene, dopri5, Control::Tolerance(1e-9))?;
    /// let mut bounces = vec![];
    /// while run.advance_until(1.0, Passage::Falling, |_t, y| Ok(y[0]))? {
    ///     bounces.push(run.time());
    ///     run.set_state(&[0.0, -0.5 * run.state()[1]], run.time())?;
    /// }
    /// let fallen = (2.0 / 9.81_f64).sqrt();
    /// assert!((bounces[0] - fallen).abs() < 1e-9 && (bounces[1] - 2.0 * fallen).abs() < 1e-9);
    /// # Ok::<(), a3_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// The run blew up, now or earlier; `until` is not finite; or the function failed, or returned
    /// NaN.
    pub fn advance_until(
        &mut self,
        until: f64,
        passage: Passage,
        mut function: impl FnMut(f64, &[f64]) -> Result<f64, String>,
    ) -> Result<bool, Error> {
        let mut value = |t: f64, y: &[f64]| match function(t, y) {
            Ok(value) if value.is_nan() => {
                let why = format!("the function that is to pass through 0 is NaN at t = {t} s");
                Err(Error::Invalid(why))
            }
            value => value.map_err(Error::Callback),
        };
        if !until.is_finite() {
            // This refuses it.
            self.advance_to(until)?;
        }
        let mut now = self.time();
        let mut before = None;
        if self.leaves != Some(now) {
            before = Some(value(now, &self.state.y)?);
        }
        while now < until {
            self.save_if_sound()?;
            let ahead = self.driver.look_ahead(&mut self.model, &mut self.state);
            let [begin, end] = ahead.map_err(|failure| self.fail(failure))?;
            let last = end.min(until);
            for look in 1..=LOOKS {
                let mut next = last;
                if look < LOOKS {
                    next = begin + (last - begin) * f64::from(look) / f64::from(LOOKS);
                }
                self.show(next);
                let after = value(next, &self.state.y)?;
                if before.is_some_and(|before| passage.is_between(before, after)) {
                    let rises = after > before.unwrap_or_default();
                    let mut ends = [now, next];
                    loop {
                        let middle = f64::midpoint(ends[0], ends[1]);
                        if middle <= ends[0] || middle >= ends[1] {
                            break;
                        }
                        self.show(middle);
                        let found = value(middle, &self.state.y)?;
                        let is_after = if rises { found >= 0.0 } else { found <= 0.0 };
                        ends[usize::from(is_after)] = middle;
                    }
                    self.show(ends[1]);
                    self.passed = Some(self.time());
                    return Ok(true);
                }
                (now, before) = (next, Some(after));
            }
            if last == until {
                // From there, the run arrives as it does without looks.
                self.show(begin);
            }
        }
        self.advance_to(until)?;
        Ok(false)
    }

    /// Shows the state at a time (s) within the step that the driver has looked ahead to.
    fn show(&mut self, time: f64) {
        self.driver.show(&mut self.model, &mut self.state, time);
    }

    /// Continues from another state of a system of one's own, at a time (s).
    ///
    /// # Errors
    /// The scene is a network, which hands change; the state has another length than before; or a
    /// number is not finite, or the time before 0. The run then continues as before.
    pub fn set_state(&mut self, y: &[f64], time: f64) -> Result<(), Error> {
        if self.model.network().is_some() {
            let why = "only the state of a system of one's own can be set: hands change others";
            return Err(Error::Invalid(why.into()));
        }
        let leaves = self.passed.filter(|passed| *passed == self.time());
        let mut there = self.moment();
        there.run.y = y.to_vec();
        there.run.set_time(time);
        there.check(self.state.y.len())?;
        self.stop();
        self.state.y.copy_from_slice(y);
        self.state.set_time(time);
        self.driver.forget();
        self.continue_from_here();
        self.leaves = leaves.map(|_| time);
        Ok(())
    }

    /// Checks the energy at the end of a run, which may have blown up since the last check.
    ///
    /// # Errors
    /// The run blew up, now or earlier.
    pub fn conclude(&mut self) -> Result<(), Error> {
        if let Some(blow_up) = self.blow_up {
            return Err(blow_up.into());
        }
        let concluded = self.driver.conclude(&self.model, &self.state);
        concluded.map_err(|failure| self.fail(failure))
    }

    /// Saves the state to go back to, if it is sound.
    ///
    /// # Errors
    /// The run blew up earlier.
    fn save_if_sound(&mut self) -> Result<(), Error> {
        if let Some(blow_up) = self.blow_up {
            return Err(blow_up.into());
        }
        let watch = &mut self.driver.pipeline.watch;
        watch.forgive(&self.model, &mut self.state);
        let Pipeline { bounds, .. } = &self.driver.pipeline;
        if self.state.balance.is_sound() && bounds.hold_closely(&self.model, &self.state.y) {
            self.good.record(&self.state, &self.model, &self.driver);
        }
        Ok(())
    }

    /// Goes back to the last sound state. A run that has blown up ends there; after another error,
    /// such as that of a callback, it may go on.
    fn fail(&mut self, failure: StepFailure) -> Error {
        let own = self.model.system().take_failure();
        let failure = own.map_or(failure, StepFailure::Error);
        let (cause, time) = match failure {
            StepFailure::BlowUp { cause, time } => (cause, time),
            StepFailure::Error(error) => return self.go_back().err().unwrap_or(error),
        };
        let mut blow_up = self.state.blow_up(cause, time);
        if let Err(error) = self.go_back() {
            return error;
        }
        // Constraints that contradict one another cause blow-ups of many kinds.
        let bounds = &self.driver.pipeline.bounds;
        if let Some(unmet) = bounds.contradiction(&self.model, &self.state.y, time) {
            blow_up.cause = Cause::Contradiction(unmet);
        }
        self.blow_up = Some(blow_up);
        blow_up.into()
    }

    /// Goes back to the last sound state.
    fn go_back(&mut self) -> Result<(), Error> {
        let (model, state) = (&mut self.model, &mut self.state);
        self.good.put_back(&self.scene, model, state, &mut self.driver)
    }

    /// Returns the run as it is now, with the last step of an adaptive method: some 20 arrays of
    /// the size of the state.
    #[must_use]
    pub fn checkpoint(&self) -> Checkpoint {
        let mut whole = self.moment();
        whole.run.copy_from(&self.state);
        whole.progress = self.driver.progress(true);
        whole
    }

    /// Returns the run as it is now, without the last step of an adaptive method: a run that
    /// continues from it begins a new step.
    #[must_use]
    pub fn moment(&self) -> Checkpoint {
        Checkpoint::of(&self.state, &self.model, &self.driver)
    }

    /// Overwrites a [moment](Self::moment) with a new one, and reuses its memory.
    pub fn record(&self, moment: &mut Checkpoint) {
        moment.record(&self.state, &self.model, &self.driver);
    }

    /// Restores all of a checkpoint: the run continues bit for bit as the original one, also after
    /// a blow-up.
    ///
    /// # Errors
    /// The checkpoint is of another scene, its method does not support this one, or a number is not
    /// finite. The run then continues as before.
    pub fn restore(&mut self, checkpoint: &Checkpoint) -> Result<(), Error> {
        let dim = self.state.y.len();
        checkpoint.check(dim)?;
        let run = &checkpoint.run;
        let model = checkpoint.model(&self.scene)?;
        let stepper = Stepper::new(run.method, &self.scene, model.system(), run.control)?;
        let progress = &checkpoint.progress;
        let mut watched = progress.watched.iter();
        watched.try_for_each(|watched| watched.check(&model))?;
        self.driver.resume(stepper, progress, dim)?;
        self.model = model;
        self.state.copy_from(run);
        self.driver.watch_again(&self.model, &self.state, progress);
        self.continue_from_here();
        Ok(())
    }

    /// Goes back to the state of a moment, also after a blow-up, and continues with the current
    /// settings: method, control, work, wind, swing and the choice of pinned particles stay, and
    /// hands let go. Surfaces touch if they did at that moment. Pins whose paths do not pass
    /// through that state stay where they are in it, or swing from there.
    ///
    /// # Errors
    /// The moment is of another scene, or a number is not finite.
    pub fn rewind(&mut self, moment: &Checkpoint) -> Result<(), Error> {
        moment.check(self.state.y.len())?;
        self.release();
        self.release_obstacle();
        let (model, state) = (&mut self.model, &mut self.state);
        moment.put_back(&self.scene, model, state, &mut self.driver)?;
        self.continue_from_here();
        let (y, radius) = (&self.state.y, self.extent().1);
        let strayed = |network| strayed(network, y, self.time(), radius);
        for i in self.model.network().map_or(vec![], strayed) {
            self.leave_pin(i);
        }
        Ok(())
    }

    /// Continues from a sound state, also after a blow-up.
    fn continue_from_here(&mut self) {
        (self.blow_up, self.passed, self.leaves) = (None, None, None);
        self.good.record(&self.state, &self.model, &self.driver);
    }

    /// Returns the scene as it was built.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Returns the method.
    #[must_use]
    pub fn method(&self) -> &'static Method {
        self.state.method
    }

    /// Returns the step or the tolerance.
    #[must_use]
    pub fn control(&self) -> Control {
        self.state.control
    }

    /// Returns the step (s): the fixed one, or the last one under a tolerance, if there was one.
    #[must_use]
    pub fn step_size(&self) -> Option<f64> {
        let stepper = &self.driver.pipeline.stepper;
        stepper.step_size(self.state.control)
    }

    /// Returns the simulated time (s).
    #[must_use]
    pub fn time(&self) -> f64 {
        self.state.time()
    }

    /// Returns the number of steps taken since the beginning.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.state.steps
    }

    /// Returns the cost of these steps.
    #[must_use]
    pub fn work(&self) -> Work {
        self.state.work
    }

    /// Returns the statistics of contact during the last step.
    #[must_use]
    pub fn contact(&self) -> Statistics {
        self.driver.pipeline.phases.contact.last()
    }

    /// Returns the actions of the collision safeguard since the beginning.
    #[must_use]
    pub fn guarded(&self) -> Guarded {
        self.state.guarded
    }

    /// Returns the blow-up that ended the run, if there was one.
    #[must_use]
    pub fn blow_up(&self) -> Option<BlowUp> {
        self.blow_up
    }

    /// Returns the energy that the method added, if it is notable against the energy of the scene:
    /// then the step is too long.
    #[must_use]
    pub fn gained(&self) -> Option<Gain> {
        self.driver.balance(&self.model, &self.state).notable_gain()
    }

    /// Returns the energy gained or, below 0, lost since the beginning, over the kinetic, elastic
    /// and gravitational energy of the motion. `None` if forces do not conserve energy, if contact,
    /// tears or hands may have changed it, or if nothing moves.
    #[must_use]
    pub fn energy_change(&self) -> Option<f64> {
        let conserves = |network: &&Network| is_conservative(network);
        self.model.network().filter(conserves)?;
        self.driver.balance(&self.model, &self.state).change()
    }

    /// Returns the constraint with the largest error at the end of any step, and that error.
    #[must_use]
    pub fn worst_constraint(&self) -> Option<Unmet> {
        let network = self.model.network()?;
        self.state.balance.worst_constraint(network)
    }

    /// Returns whether constraints were so nearly singular that bounded forces could not hold them
    /// exactly, as a chain that is stretched straight between two pins.
    #[must_use]
    pub fn was_nearly_singular(&self) -> bool {
        self.driver.balance(&self.model, &self.state).was_singular()
    }
}
