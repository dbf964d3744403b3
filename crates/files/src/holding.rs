//! Search for a step or a tolerance that holds, before a run begins with one that does not, or
//! after it blew up.

use std::iter::successors;
use std::ops::RangeInclusive;
use std::time::Duration;

use a3_core::stability::{Budget, Mode, largest_step, spectrum};
use a3_core::{BlowUp, Cause, Control, Error, Rounded, Simulation, StepLength};

use crate::bounds::{LARGEST_STEP, SMALLEST_STEP};
use crate::processor;

/// Least simulated time (s) for which a step has to hold before the window recommends it.
pub const MIN_HOLD_TIME: f64 = 10.0;

/// Processor time of the trials while a window waits.
const WINDOW_BUDGET: Duration = Duration::from_millis(300);

/// Work of the trial of a step before a run begins, and of the search for another one: about 0.3 s
/// of processor time each. It is counted, so that a run begins with the same step on every machine.
const BEGINNING_WORK: f64 = 1e7;

/// Share of a step that held only as far as it was tried, with which a run begins in its place.
const UNTRIED_SHARE: f64 = 0.5;

/// Largest angle (rad) by which the fastest vibration of rigid bodies that rest on one another
/// turns in a step. Contact is stiffer the deeper they sink: twice as deep, as in an impact, it is
/// twice the angle, which most methods just bear.
const RESTING_ANGLE: f64 = 1.0;

/// Simulated time (s) of a trial after which bodies that began close to one another have parted.
const FIRST_IMPACTS: f64 = 1.0;

/// Number of steps of a trial between two looks at the time.
const STEPS_PER_LOOK: u64 = 4;

/// Ratio of two tolerances that are tried one after the other.
const TOLERANCE_RATIO: f64 = 10.0;

/// Smallest and largest tolerance that is tried.
const TOLERANCES: RangeInclusive<f64> = 1e-12..=0.1;

/// Result of a search for a step, or a tolerance, that holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sought {
    /// This one holds.
    Holds(Control),
    /// This one held up to a time (s), when the search ended.
    HeldUntil(Control, f64),
    /// All were tried, down or up to this one, and failed.
    Failed(Control),
    /// Steps that the program takes are beyond this limit of stability (s).
    Beyond(f64),
    /// None was tried.
    Untried,
}

impl Sought {
    /// Returns a clause about the result of a search until a time (s), without a full stop.
    pub fn clause(&self, until: f64) -> String {
        match *self {
            Self::Holds(control) => format!("{} would have held", named(control)),
            Self::HeldUntil(control, time) => format!(
                "{} held {} s of {} s, as far as it was tried",
                named(control),
                Rounded(time),
                Rounded(until)
            ),
            Self::Failed(control @ Control::Step(_)) => {
                format!("no shorter step holds, down to {}", named(control))
            }
            Self::Failed(control) => {
                format!("no tolerance that was tried holds, the last was {}", named(control))
            }
            Self::Beyond(limit) => format!("only steps below {} s hold", Rounded(limit)),
            Self::Untried => "no other one was tried".into(),
        }
    }
}

/// Returns the words for a step or a tolerance.
fn named(control: Control) -> String {
    match control {
        Control::Step(step) => format!("a step of {}", StepLength(step)),
        Control::Tolerance(tolerance) => format!("a tolerance of {tolerance:e}"),
    }
}

/// Result of a trial.
enum Tried {
    Holds,
    Fails,
    /// The search ended at that simulated time (s).
    Unended(f64),
}

/// Trial runs with other steps or tolerances.
struct Trials<'a> {
    run: &'a Simulation,
    /// Begins a trial: at the start of the scene, or where the run is.
    begin: fn(&Simulation, Control) -> Result<Simulation, Error>,
    /// Simulated time for which a step has to hold (s).
    until: f64,
    /// Processor time of the program at which the search ends.
    end: Duration,
    /// Work of all trials.
    budget: Budget,
    /// Returns whether trials may continue.
    may_continue: &'a dyn Fn() -> bool,
}

/// Seeks a step that holds until the time `until` (s) on the scene of a run with fixed steps: the
/// longest of the trials that is shorter than its own. For a run to a tolerance that blew up, it
/// seeks a smaller tolerance or, if the run found no step to meet it, a larger one. Trials take the
/// processor time `budget` at most, and go on as long as `may_continue` says.
pub fn seek(
    run: &Simulation,
    until: f64,
    budget: Duration,
    may_continue: &dyn Fn() -> bool,
) -> Sought {
    let end = processor::time() + budget;
    let trials = Trials { end, may_continue, ..Trials::of_window(run, until) };
    let modes = match run.control() {
        Control::Step(_) => spectrum(run.model().system(), 0.0, &run.scene().state),
        Control::Tolerance(_) => vec![],
    };
    trials.seek(&modes)
}

/// Shortens the step of a run that would not hold for its next ten seconds with its own, and
/// returns the step that it had (s). Trial runs show that and, where they end early, its limit in
/// its present state. A step stays if no shorter one is found. One that was not tried to the end
/// leaves room for what comes later.
pub fn shorten(run: &mut Simulation) -> Option<f64> {
    let step = run.control().step()?;
    let modes = spectrum(run.model().system(), run.time(), run.state());
    let is_past = || limit(run, &modes).is_some_and(|limit| step > limit);
    let fails = match Trials::of_beginning(run).hold(run.control()) {
        Tried::Holds => false,
        Tried::Unended(_) => is_past(),
        Tried::Fails => true,
    };
    let sought = fails.then(|| Trials::of_beginning(run).seek(&modes))?;
    let shorter = sought.step().map(|shorter| match sought {
        Sought::HeldUntil(..) => rounded(UNTRIED_SHARE * shorter),
        _ => shorter,
    });
    let shorter = shorter.filter(|shorter| *shorter < step)?;
    run.set_control(Control::Step(shorter)).ok()?;
    Some(step)
}

/// Returns the limit of stability (s) of a run with these modes, if one is known. Surfaces that
/// touch have none: they are far stiffer at the start than the impacts by which they part.
fn limit(run: &Simulation, modes: &[Mode]) -> Option<f64> {
    let network = run.model().network();
    let touches = network.is_some_and(|network| network.contact_layer().is_some());
    // Never fails for a method in METHODS.
    let limit = largest_step(run.method(), modes).ok().flatten();
    limit.filter(|_| !touches).map(|limit| limit.step)
}

/// Seeks a step, as [`seek`] does, that holds until the time `until` (s), at least for ten seconds.
/// Trials start just below the stability limit of these modes, those at the start of the scene, so
/// that the result depends neither on the state in which the run diverged nor, except for being
/// shorter, on its step.
pub fn would_hold(run: &Simulation, until: f64, modes: &[Mode]) -> Sought {
    Trials::of_window(run, until.max(MIN_HOLD_TIME)).seek(modes)
}

impl Sought {
    /// Returns the step or the tolerance that holds, as far as it was tried.
    pub fn control(self) -> Option<Control> {
        match self {
            Self::Holds(control) | Self::HeldUntil(control, _) => Some(control),
            Self::Failed(_) | Self::Beyond(_) | Self::Untried => None,
        }
    }

    /// Returns the step (s) that holds, as far as it was tried.
    fn step(self) -> Option<f64> {
        self.control()?.step()
    }
}

impl<'a> Trials<'a> {
    /// Creates trials while a window waits.
    fn of_window(run: &'a Simulation, until: f64) -> Self {
        Self {
            run,
            begin: |run, control| run.anew(run.method(), control),
            until,
            end: processor::time() + WINDOW_BUDGET,
            budget: Budget::unlimited(),
            may_continue: &|| true,
        }
    }

    /// Creates trials before a run begins or goes on.
    fn of_beginning(run: &'a Simulation) -> Self {
        Self {
            begin: |run, control| {
                let mut again = run.anew(run.method(), control)?;
                again.rewind(&run.moment())?;
                Ok(again)
            },
            end: Duration::MAX,
            budget: Budget::new(BEGINNING_WORK),
            ..Self::of_window(run, MIN_HOLD_TIME)
        }
    }

    /// Seeks a step, in a scene of these modes, or a tolerance, in place of the run's own.
    fn seek(&self, modes: &[Mode]) -> Sought {
        let own = match self.run.control() {
            Control::Step(own) => own,
            Control::Tolerance(own) => {
                let missed = |lost: BlowUp| matches!(lost.cause, Cause::StepTooSmall { .. });
                let is_larger = self.run.blow_up().is_some_and(missed);
                let ratio = [TOLERANCE_RATIO.recip(), TOLERANCE_RATIO][usize::from(is_larger)];
                let all = successors(Some(own * ratio), |last| Some(last * ratio));
                let all = all.take_while(|it| TOLERANCES.contains(it));
                // Printing and reading removes the rounding error.
                let read = |it: f64| format!("{it:.3e}").parse().unwrap_or(it);
                return self.first(all.map(|it| Control::Tolerance(read(it))));
            }
        };
        let most = limit(self.run, modes).unwrap_or(own).min(LARGEST_STEP);
        if 0.9 * most < SMALLEST_STEP {
            return Sought::Beyond(most);
        }
        let all = successors(Some(rounded(0.9 * most)), |last| Some(rounded(0.6 * last)));
        let all = all.take_while(|step| *step >= SMALLEST_STEP);
        self.first(all.filter(|step| *step < own).map(Control::Step))
    }

    /// Seeks the first that holds.
    fn first(&self, all: impl Iterator<Item = Control>) -> Sought {
        let mut sought = Sought::Untried;
        for control in all {
            sought = match self.hold(control) {
                Tried::Holds => return Sought::Holds(control),
                Tried::Fails => Sought::Failed(control),
                Tried::Unended(time) if time > 0.0 => return Sought::HeldUntil(control, time),
                Tried::Unended(_) => return sought,
            };
        }
        sought
    }

    /// Finds out whether a run does not diverge, gains no energy and meets its constraints, and
    /// whether rigid bodies can rest where it leaves them.
    fn hold(&self, control: Control) -> Tried {
        let again = match self.reach(control) {
            Ok(again) => again,
            Err(tried) => return tried,
        };
        let broken = again.worst_constraint().is_some_and(|c| c.is_visible());
        if again.gained().is_none() && !broken { Tried::Holds } else { Tried::Fails }
    }

    /// Runs to the end of the trial, unless the run diverges.
    fn reach(&self, control: Control) -> Result<Simulation, Tried> {
        let mut again = (self.begin)(self.run, control).map_err(|_| Tried::Fails)?;
        let begun = again.time();
        while again.time() - begun < self.until {
            match self.budget.take(&mut again, STEPS_PER_LOOK) {
                Some(false) => return Err(Tried::Fails),
                Some(true) if processor::time() <= self.end && (self.may_continue)() => {}
                _ => {
                    let tried = (again.time() - begun).min(self.until);
                    let is_fit = tried < FIRST_IMPACTS || lets_rest(&again);
                    return Err(if is_fit { Tried::Unended(tried) } else { Tried::Fails });
                }
            }
        }
        match again.conclude() {
            Ok(()) if lets_rest(&again) => Ok(again),
            _ => Err(Tried::Fails),
        }
    }
}

/// Returns whether the step of a run is short enough for rigid bodies that rest on one another or
/// on obstacles, as it leaves them. A pile on which a step is too long trembles and falls apart by
/// and by, and gains little energy at any time.
fn lets_rest(run: &Simulation) -> bool {
    let network = run.model().network();
    let touching = network.filter(|it| it.contact_layer().is_some() && !it.bodies().is_empty());
    let (Some(step), Some(_)) = (run.control().step(), touching) else {
        return true;
    };
    let modes = spectrum(run.model().system(), run.time(), run.state());
    let is_bounded =
        matches!(largest_step(run.method(), &modes), Ok(Some(limit)) if limit.step.is_finite());
    let fastest = modes.iter().map(Mode::frequency).fold(0.0, f64::max);
    !is_bounded || step * fastest <= RESTING_ANGLE
}

/// Rounds a number down to one digit.
fn rounded(most: f64) -> f64 {
    let unit = 10f64.powi(most.log10().floor() as i32);
    // Printing and reading removes the rounding error.
    let digits = (most / unit + 1e-9).floor() * unit;
    format!("{digits:.0e}").parse().unwrap_or(digits)
}

#[cfg(test)]
mod tests {
    use a3_core::integrators;
    use a3_scenes::Description;

    use super::*;

    /// Scenes of one's own, with bodies, contact and solids, begin with a step that holds.
    #[test]
    fn a_default_step_that_would_blow_up_is_shortened() {
        let hammock = "[[cloth]]\ngrid = [12, 24]\nwidth = 2.3\ndensity = 0.4\nstiffness = [900, 300, 10]\n\
            damping_ratio = 0.2\nat = [0, 1.5, -0.5]\ndown = [0, 0, 1]\npin = [{ at = ['left', 'right'] }]\n\
            [[body]]\nparts = [{ ball = 0.15 }]\nmass = 1.5\nat = [0.1, 2, 0]\n";
        let cube = "[[box]]\ncenter = [0.5, 0.1, 0]\nsize = [1, 0.2, 1]\n[[jelly]]\ngrid = [5, 5, 5]\n\
            size = [0.4, 0.4, 0.4]\ndensity = 300\nstiffness = [1500, 800, 400]\nat = [0, 0.8, 0]\n";
        let solid = "[[solid]]\ngrid = [5, 5, 5]\nsize = [0.4, 0.4, 0.4]\ndensity = 1000\nyoung = 1e5\n\
            poisson = 0.4\nmodel = 'neo-hookean'\ndamping = 0.005\nat = [0.25, 0.8, 0]\n";
        let soft = "[[cloth]]\ngrid = [8, 8]\nwidth = 1\ndensity = 0.3\nstiffness = [20, 10, 1]\n\
            damping_ratio = 0.2\nat = [0, 1, 0]\npin = [{ at = ['top'] }]\n";
        // Two boxes that begin within the range of their stiff contact: impacts part them, and then
        // the upper one trembles on the lower one in long steps.
        let tower = "[[body]]\nparts = [{ box = [0.3, 0.3, 0.3] }]\nmass = 10\nat = [0, 0.151, 0]\n\
            friction = 0.5\n[[body]]\nparts = [{ box = [0.3, 0.3, 0.3] }]\nmass = 10\nat = [0, 0.453, 0]\n\
            friction = 0.5\n";
        for (own, holds) in
            [(hammock, false), (cube, false), (solid, false), (soft, true), (tower, false)]
        {
            let text = format!("gravity = [0, -9.81, 0]\nfloor = 0\n{own}");
            let begun = || {
                let scene = Description::parse(&text).unwrap();
                let scene = scene.build(None, &mut |_| unreachable!()).unwrap().scene;
                let method = integrators::find("trapezoid").unwrap();
                let mut run = Simulation::new(scene, method, Control::Step(0.005)).unwrap();
                (shorten(&mut run), run)
            };
            let (asked, mut run) = begun();
            assert_eq!(asked, (!holds).then_some(0.005), "{own}");
            // A machine's speed has no part in it.
            assert_eq!(begun().1.control(), run.control());
            if own == tower {
                assert_eq!(run.control(), Control::Step(1e-3));
            }
            run.advance_to(2.0).unwrap();
        }
    }

    #[test]
    fn steps_are_rounded_down_to_a_digit() {
        for (most, expected) in [(0.013, 0.01), (0.031, 0.03), (0.000_35, 0.000_3), (0.09, 0.09)] {
            assert_eq!(rounded(most), expected);
        }
    }
}
