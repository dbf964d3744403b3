//! The actions of keys on a session.

use a3_core::{Method, integrators};

use super::clock::KEY_BUDGET;
use super::keys::Action;
use super::list::Topic;
use super::pane::{PORTION, Pane};
use super::state::Session;
use crate::bounds;

/// The slowest motion is 1 / 2^6 of real time.
const SLOWEST: i32 = 6;

/// Steps and tolerances of the keys + and -, in each decade.
const LADDER: [f64; 10] = [1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0];

impl Session {
    /// Does an action, except those that need the window, and returns whether another scene is
    /// shown. A solver is for the pane `at`, all else for every pane.
    pub fn act(&mut self, action: Action, at: usize) -> bool {
        match action {
            Action::NextScene | Action::PreviousScene => {
                self.go_to_scene(if action == Action::NextScene { 1 } else { -1 });
                return true;
            }
            Action::Scenes => self.toggle_list(Topic::Scenes),
            Action::Solvers => self.toggle_list(Topic::Solvers { pane: at }),
            Action::Reset => {
                let touching = self.first().touching();
                self.panes.iter_mut().for_each(Pane::reset);
                if touching && !self.first().touching() {
                    self.say(
                        "Surfaces cross at the beginning, so they pass through one another again.",
                    );
                }
                self.clear_timeline();
                if let Some(reference) = &mut self.reference {
                    reference.reset();
                    self.readings.no_error = None;
                }
                self.start_anew();
            }
            Action::Swing if self.first().scene().swing.is_none() => {
                self.say("There is nothing to swing here.");
            }
            Action::Swing => {
                let on = !self.first().swinging();
                self.align();
                self.do_to_all(|run| run.set_swinging(on));
            }
            Action::Wind if self.first().scene().wind.is_none() => {
                self.say("There is no wind here.");
            }
            Action::Wind => {
                let on = !self.first().windy();
                self.align();
                self.do_to_all(|run| run.set_wind(on));
            }
            Action::Touch => self.toggle_touch(),
            Action::Wireframe => self.next_style(),
            Action::Colour => self.next_colour(),
            Action::Arrows => self.next_arrows(),
            Action::Pause => {
                self.readings.paused = !self.readings.paused;
                self.start_anew();
            }
            Action::Step if self.readings.rewound.is_some() => self.scrub(1),
            Action::Scrub(by) => self.scrub(by),
            Action::Slower => self.readings.slowness = (self.readings.slowness + 1).min(SLOWEST),
            Action::Faster => self.readings.slowness = (self.readings.slowness - 1).max(0),
            Action::Step => {
                self.readings.paused = true;
                self.settle();
                // The longest step, and as many of the shorter ones as fit.
                let alive = self.panes.iter().filter(|pane| pane.alive());
                let step = alive.map(|pane| pane.simulation.step_size().unwrap_or(PORTION));
                let step = step.fold(0.0, f64::max);
                self.advance(self.clock + step, KEY_BUDGET, KEY_BUDGET);
            }
            Action::Solver(i) => match integrators::METHODS.get(i) {
                Some(method) => self.set_method(method, at),
                None => self.say(format!("There are {} solvers.", integrators::METHODS.len())),
            },
            Action::LongerStep => self.set_steps(true),
            Action::ShorterStep => self.set_steps(false),
            Action::Camera => {
                let parallel = self.camera.is_parallel();
                self.camera = self.panes[0].show.camera();
                self.camera.set_parallel(parallel);
                self.followed = None;
            }
            Action::FreeAll => self.free_all(),
            Action::Projection => self.toggle_projection(),
            Action::SeeAll => self.see_all(),
            Action::NextView => self.next_view(),
            Action::Panel => self.panel.open = !self.panel.open,
            Action::WriteScene => match self.write_scene(at) {
                Ok(name) => self.say(format!("wrote {name}")),
                Err(why) => self.say(why),
            },
            Action::Help => self.readings.help = !self.readings.help,
            Action::Picture
            | Action::CommandLine
            | Action::Follow
            | Action::Undo
            | Action::Redo
            | Action::FullScreen
            | Action::WritePlots
            | Action::Record
            | Action::FilmLast
            | Action::Keep
            | Action::TakeUp
            | Action::Lessons
            | Action::Quit => {}
        }
        false
    }

    fn set_method(&mut self, method: &'static Method, at: usize) {
        let at = at.min(self.panes.len() - 1);
        let pane = &mut self.panes[at];
        pane.wanted_step = None;
        let run = &pane.simulation;
        let control = if method.is_adaptive() == run.method().is_adaptive() {
            run.control()
        } else {
            self.defaults.control_of(method)
        };
        match pane.simulation.set_method(method, control) {
            Ok(()) => {
                pane.wanted = method;
                pane.restart_cost();
            }
            Err(why) => self.say(why.to_string()),
        }
        self.adapt();
    }

    fn set_steps(&mut self, longer: bool) {
        for k in 0..self.panes.len() {
            let pane = &mut self.panes[k];
            pane.wanted_step = None;
            let control = pane.simulation.control();
            let range = bounds::of(control);
            let next = next_step(control.value(), longer).clamp(*range.start(), *range.end());
            if let Err(why) = pane.simulation.set_control(control.with_value(next)) {
                self.say(why.to_string());
            } else {
                pane.restart_cost();
            }
        }
        self.adapt();
    }

    /// Sets the step (s) or the tolerance of one pane.
    pub fn set_step_of(&mut self, at: usize, value: f64) {
        self.panes[at].wanted_step = None;
        let run = &mut self.panes[at].simulation;
        match run.set_control(run.control().with_value(value)) {
            Ok(()) => self.panes[at].restart_cost(),
            Err(why) => self.say(why.to_string()),
        }
        self.adapt();
    }

    pub(super) fn adapt(&mut self) {
        if let Some(reference) = &mut self.reference {
            reference.adapt(&self.panes);
        }
    }
}

/// The next larger or smaller step or tolerance of the ladder.
fn next_step(step: f64, longer: bool) -> f64 {
    let decade = step.log10().floor() as i32;
    let rungs = (decade - 1..=decade + 1).flat_map(|d| {
        // Dividing by a power of ten is exact to the last digit where multiplying by its inverse is
        // not.
        LADDER.iter().map(move |rung| {
            if d < 0 {
                rung / 10f64.powi(-d)
            } else {
                rung * 10f64.powi(d)
            }
        })
    });
    let next = if longer {
        rungs
            .filter(|rung| *rung > step * (1.0 + 1e-9))
            .reduce(f64::min)
    } else {
        rungs
            .filter(|rung| *rung < step * (1.0 - 1e-9))
            .reduce(f64::max)
    };
    next.unwrap_or(step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::{LARGEST_STEP, SMALLEST_STEP};
    use crate::session::{compared, session};
    use a3_core::Control;

    #[test]
    fn scenes_come_round_and_the_solver_comes_back() {
        let mut session = session(&["v", "0.005"]);
        let mut seen = vec![];
        for _ in 0..a3_scenes::SCENES.len() {
            seen.push((
                session.panes[0].simulation.scene().name.clone(),
                session.panes[0].simulation.method().name,
            ));
            assert!(session.act(Action::NextScene, 0));
        }
        let expected: Vec<_> = a3_scenes::SCENES.iter().map(|entry| entry.name).collect();
        assert_eq!(
            seen.iter()
                .map(|(scene, _)| scene.as_str())
                .collect::<Vec<_>>(),
            expected
        );
        // Verlet cannot serve the circle, and serves the others again.
        let solvers: Vec<_> = seen.iter().map(|(_, solver)| *solver).collect();
        for (scene, solver) in expected.iter().zip(solvers) {
            assert_eq!(
                solver,
                if *scene == "simple" {
                    "trapezoid"
                } else {
                    "verlet"
                }
            );
        }
        assert_eq!(session.panes[0].simulation.scene().name, "cloth");
    }

    #[test]
    fn the_grid_asked_for_comes_back() {
        let mut session = session(&["t", "0.005", "--grid", "30x25"]);
        for _ in 0..a3_scenes::SCENES.len() {
            session.act(Action::NextScene, 0);
        }
        assert_eq!(session.panes[0].simulation.particles(), 750);
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
            let action = if longer {
                Action::LongerStep
            } else {
                Action::ShorterStep
            };
            session.act(action, 0);
            session.first().control().value() == end
        };
        assert!(ends("r", LARGEST_STEP, true) && ends("r", SMALLEST_STEP, false));
        assert!(ends("a", 1.0, true) && ends("a", 1e-13, false));
    }

    #[test]
    fn a_digit_is_for_one_pane_and_plus_for_all() {
        let mut session = compared(&["e:0.05", "r:0.01", "--scene", "chain"], 0.1);
        session.act(Action::Solver(1), 1);
        session.act(Action::LongerStep, 1);
        let methods: Vec<_> = session
            .panes
            .iter()
            .map(|pane| (pane.simulation.method().name, pane.simulation.control()))
            .collect();
        assert_eq!(
            methods,
            [
                ("euler", Control::Step(0.06)),
                ("trapezoid", Control::Step(0.012))
            ]
        );
        // One step of the longest.
        session.act(Action::Reset, 0);
        session.act(Action::Step, 0);
        let steps: Vec<_> = session.panes.iter().map(|p| p.simulation.steps()).collect();
        assert_eq!(steps, [1, 5]);
    }
}
