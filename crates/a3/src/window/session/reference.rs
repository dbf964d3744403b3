//! The reference: a hidden run from which the errors of the panes are taken.

use web_time::{Duration, Instant};

use a3_core::{Control, Method, Simulation, integrators};

use super::pane::{ADAPTIVE_SLICE, Pane};
use super::predictability::Predictability;
use crate::base::failure::Failure;
use crate::base::progress;

/// Frames in a row that the reference may be late before it is stopped.
const MAX_LATE_FRAMES: u32 = 30;

/// A run of the panes' scene that is much more exact than they are and gets the same hands.
pub struct ReferenceRun {
    simulation: Simulation,
    /// How long errors mean something in the scene as it starts.
    predictability: Predictability,
    /// Frames in a row that it did not keep up with the panes.
    late: u32,
    /// Reason why it was stopped, if it was.
    stopped: Option<&'static str>,
}

/// Method and tolerance of the reference: tight, and tighter still beside adaptive panes.
fn method_and_control(panes: &[Pane]) -> (&'static Method, Control) {
    let method = integrators::find("dop853").unwrap_or(&integrators::METHODS[0]);
    let tolerances = panes
        .iter()
        .filter_map(|pane| pane.simulation.control().tolerance());
    let tightest = tolerances.fold(1e-6, f64::min);
    (method, Control::Tolerance((1e-4 * tightest).max(1e-13)))
}

impl ReferenceRun {
    /// A reference for several panes at the beginning of their scene; `None` for a single one.
    pub fn new(panes: &[Pane]) -> Result<Option<Self>, Failure> {
        let [first, _, ..] = panes else {
            return Ok(None);
        };
        let (method, control) = method_and_control(panes);
        let run = &first.simulation;
        let mut scene = run.scene().clone();
        scene.limits.absolute = None;
        let predictability = Predictability::new(scene.clone());
        let mut simulation = Simulation::new(scene, method, control).map_err(Failure::run)?;
        simulation.set_wind(run.windy());
        simulation.set_swinging(run.swinging());
        simulation
            .set_touching(run.touching())
            .map_err(Failure::run)?;
        Ok(Some(Self {
            simulation,
            predictability,
            late: 0,
            stopped: None,
        }))
    }

    /// Fits the tolerance to panes that have other methods or steps.
    pub fn adapt(&mut self, panes: &[Pane]) {
        let (method, control) = method_and_control(panes);
        // The method serves every scene, so it is not refused.
        if self.simulation.control() != control {
            let _ = self.simulation.set_method(method, control);
        }
    }

    /// The run, unless it was stopped.
    pub fn run(&mut self) -> Option<&mut Simulation> {
        Some(&mut self.simulation).filter(|_| self.stopped.is_none())
    }

    /// The run to look at, stopped or not.
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// The run to change, stopped or not.
    pub fn simulation_mut(&mut self) -> &mut Simulation {
        &mut self.simulation
    }

    /// Reason why there are no errors, if there are none.
    pub fn stopped(&self) -> Option<&'static str> {
        self.stopped
    }

    /// The time past which errors say little (s), as far as it is known.
    pub fn predictable(&self) -> Option<f64> {
        self.predictability.until()
    }

    /// Goes back to the beginning, and goes on if it was stopped.
    pub fn reset(&mut self) {
        self.simulation.reset();
        (self.late, self.stopped) = (0, None);
    }

    /// Goes on to `time` (s) exactly, within `budget` of real time, and returns whether it got
    /// there.
    pub fn reach(&mut self, time: f64, budget: Duration) -> bool {
        let begun = Instant::now();
        let run = &mut self.simulation;
        let mut result = Ok(());
        while result.is_ok() && run.time() < time {
            if begun.elapsed() >= budget {
                return false;
            }
            result = run.advance_to((run.time() + ADAPTIVE_SLICE).min(time));
        }
        if result.is_err() {
            self.stop("the reference blew up");
        }
        self.stopped.is_none()
    }

    /// Stops the run: there are no errors from here on.
    pub fn stop(&mut self, why: &'static str) {
        self.stopped = Some(why);
    }

    /// Catches up with the panes one after the other within `budget` of real time, and takes their
    /// errors. What does not fit is left for the next frame; a reference that is late for too many
    /// frames is stopped.
    pub fn follow(&mut self, panes: &mut [Pane], budget: Duration) {
        if self.stopped.is_none() {
            let begun = Instant::now();
            let mut runs: Vec<_> = panes.iter_mut().filter(|pane| pane.alive()).collect();
            runs.sort_by(|a, b| a.simulation.time().total_cmp(&b.simulation.time()));
            let mut kept_up = true;
            for pane in runs {
                let time = pane.simulation.time();
                // A run with long steps may stand where the reference has been before: its error is
                // known.
                if time < self.simulation.time() - 1e-9 {
                    continue;
                }
                kept_up = self.reach(time, budget.saturating_sub(begun.elapsed()));
                if !kept_up {
                    break;
                }
                pane.set_errors(differences(&pane.simulation, &self.simulation));
            }
            self.late = if kept_up { 0 } else { self.late + 1 };
            if self.late > MAX_LATE_FRAMES {
                self.stop("the reference is too slow");
            }
        }
        for pane in panes.iter_mut() {
            if self.stopped.is_some() || !pane.alive() {
                pane.set_errors(vec![]);
            }
        }
        // Colours of one scale can be compared.
        let errors = panes.iter().map(|pane| pane.show.colouring.largest_error());
        let largest = errors.fold(0.0, f64::max);
        for pane in panes {
            pane.show.colouring.beside = largest;
        }
    }

    /// Goes on to `time` (s) exactly, however long that takes, and takes the errors of the panes at
    /// that time.
    pub fn run_to(&mut self, time: f64, panes: &mut [Pane]) {
        // A blow-up is found by `reach`, through `follow`.
        let _ = progress::advance(&mut self.simulation, time, |_| {});
        self.follow(panes, Duration::MAX);
        self.predictability.wait();
    }
}

/// The ways to the particles of one run from those of another (m), n x 3.
fn differences(a: &Simulation, b: &Simulation) -> Vec<f64> {
    let all = a.state().iter().zip(b.state());
    all.take(3 * a.particles()).map(|(a, b)| a - b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::show::{Manner, Show};

    #[test]
    fn one_that_never_keeps_up_is_stopped_until_the_next_reset() {
        let setup = a3_scenes::find("chain").unwrap().build(None).unwrap();
        let pane = |method: &str| {
            let method = integrators::find(method).unwrap();
            let simulation =
                Simulation::new(setup.scene.clone(), method, Control::Step(0.01)).unwrap();
            Pane::new(
                simulation,
                Show::new(setup.presentation.clone(), Manner::default()),
            )
        };
        assert!(ReferenceRun::new(&[pane("t")]).ok().unwrap().is_none());
        let go = |panes: &mut [Pane], time| {
            for pane in panes {
                pane.take_due_steps(time);
            }
        };
        let mut panes = [pane("t"), pane("r")];
        let mut reference = ReferenceRun::new(&panes).ok().flatten().unwrap();
        // A frame that is late is made up for.
        go(&mut panes, 0.5);
        reference.follow(&mut panes, Duration::ZERO);
        assert_eq!(panes[0].error, None);
        reference.follow(&mut panes, Duration::MAX);
        assert!(panes[0].error.unwrap() > panes[1].error.unwrap());
        for late in 1..=MAX_LATE_FRAMES + 1 {
            go(&mut panes, 0.5 + 0.01 * f64::from(late));
            assert_eq!(reference.stopped(), None);
            reference.follow(&mut panes, Duration::ZERO);
        }
        assert!(reference.stopped().unwrap().contains("too slow"));
        assert_eq!(panes[0].error, None);
        panes.iter_mut().for_each(Pane::reset);
        reference.reset();
        go(&mut panes, 0.5);
        reference.follow(&mut panes, Duration::MAX);
        assert!(panes[0].error.is_some() && reference.stopped().is_none());
    }
}
