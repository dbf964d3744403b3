//! Actions of the user on a session, by keys, mouse and lists.

use std::path::Path;

use a3_core::{Network, integrators};
use a3_scenes::Setup;

use super::actions::RunAction;
use super::apart;
use super::beside;
use super::history::Change;
use super::list::{List, TextKey, Topic, solvers};
use super::looks;
use super::panes;
use super::runs::KEY_BUDGET;
use super::save;
use super::state::Session;
use super::tuning::Tuning;
use crate::draw::show;

/// Largest slowness: motion at 1 / 2^6 of real time.
const MAX_SLOWNESS: i32 = 6;

impl Session {
    /// Performs an action, and returns whether it changed the scene. Solvers and scene files are
    /// those of pane `at`; all other actions apply to every pane.
    pub fn act(&mut self, action: RunAction, at: usize) -> bool {
        if let Some(why) = self.panel.hidden.refusal(action) {
            self.readings.say(why);
            return false;
        }
        match action {
            RunAction::NextScene | RunAction::PreviousScene => {
                let is_next = action == RunAction::NextScene;
                let number = self.scenes.neighbour(if is_next { 1 } else { -1 });
                self.show_scene(number);
                return true;
            }
            RunAction::Scenes => self.toggle_list(Topic::Scenes),
            RunAction::Solvers => self.toggle_list(Topic::Solvers { pane: at }),
            RunAction::Reset => self.reset(),
            RunAction::Swing if self.runs.first().scene().swing.is_none() => {
                self.readings.say("There is nothing to swing here.");
            }
            RunAction::Swing => {
                let on = !self.runs.first().swinging();
                self.runs.align();
                self.runs.all_mut().for_each(|run| run.set_swinging(on));
            }
            RunAction::Wind if self.runs.first().scene().wind.is_none() => {
                self.readings.say("There is no wind here.");
            }
            RunAction::Wind => {
                let on = !self.runs.first().windy();
                self.runs.align();
                self.runs.all_mut().for_each(|run| run.set_wind(on));
            }
            RunAction::Touch => apart::toggle_touch(self),
            RunAction::Wireframe => looks::next_style(&mut self.runs.panes),
            RunAction::Colour => self.readings.say(looks::next_colour(&mut self.runs.panes)),
            RunAction::Arrows => self.readings.say(looks::next_arrows(&mut self.runs.panes)),
            RunAction::Pause => {
                self.readings.paused = !self.readings.paused;
                self.restart_measuring();
            }
            RunAction::Step if self.readings.rewound() => self.scrub(1),
            RunAction::Scrub(by) => self.scrub(by),
            RunAction::Slower => {
                self.readings.slowness = (self.readings.slowness + 1).min(MAX_SLOWNESS);
            }
            RunAction::Faster => self.readings.slowness = (self.readings.slowness - 1).max(0),
            RunAction::Step => self.step(),
            RunAction::Solver(i) => match integrators::METHODS.get(i) {
                Some(method) => {
                    let done = self.runs.set_method(method, at, &self.tuning.defaults);
                    self.report(done);
                }
                None => self
                    .readings
                    .say(format!("There are {} solvers.", integrators::METHODS.len())),
            },
            RunAction::LongerStep | RunAction::ShorterStep => {
                let done = self.runs.set_steps(action == RunAction::LongerStep);
                self.report(done);
            }
            RunAction::Camera => {
                self.view.set_camera(self.runs.panes[0].show.camera());
                self.view.stop_following();
            }
            RunAction::FreeAll => {
                let all: Vec<_> = (0..self.runs.first().particles()).collect();
                self.pin_all(&all, false);
            }
            RunAction::Projection => self.readings.say(self.view.toggle_projection()),
            RunAction::SeeAll => self.view.see_all(&self.runs.panes),
            RunAction::NextView => self.readings.say(self.view.next_view()),
            RunAction::Panel | RunAction::Measure | RunAction::Lessons | RunAction::Plots => {
                beside::toggle(self, action);
            }
            RunAction::Edit if cfg!(target_arch = "wasm32") => {
                self.readings.say("Only the program edits scenes.");
            }
            RunAction::Edit if self.runs.first().model().network().is_none() => {
                let why = "Only scenes of masses can be edited.";
                self.readings.say(why);
            }
            RunAction::Edit => {
                self.panel.editor.toggle(&self.runs);
                self.readings.help = false;
                self.list = None;
            }
            RunAction::WriteScene => {
                let pane = &self.runs.panes[at.min(self.runs.panes.len() - 1)];
                let said = match save::write_scene(self, &pane.simulation) {
                    Ok(name) => format!("Wrote {name}."),
                    Err(why) => why,
                };
                self.readings.say(said);
            }
            RunAction::Help => self.readings.help = !self.readings.help,
        }
        false
    }

    /// Resets all runs to the initial state of their scene.
    fn reset(&mut self) {
        let touching = self.runs.first().touching();
        self.runs.reset();
        self.effects.forget();
        if touching && !self.runs.first().touching() {
            let why = "Surfaces cross in the initial state, so self-collision is off again";
            self.readings.offer(why);
        }
        self.readings.read_reference(self.runs.reference.as_ref());
        self.begin_new_run();
    }

    /// Pauses, and advances all runs by the longest step among them.
    fn step(&mut self) {
        self.readings.paused = true;
        self.runs.drop_due_steps();
        self.advance(self.runs.longest_step(), KEY_BUDGET, KEY_BUDGET);
    }

    /// Shows the error of a refused request.
    fn report(&mut self, done: Result<(), impl ToString>) {
        if let Err(why) = done {
            self.readings.say(why.to_string());
        }
    }

    /// Sets the step (s) or the tolerance of one pane, or shows why that is refused.
    pub fn set_step_of(&mut self, at: usize, value: f64) {
        let done = self.runs.set_step_of(at, value);
        self.report(done);
    }

    /// Changes the model of every run; a reset keeps the change. If self-collision is on and
    /// surfaces would cross, changes nothing and shows which would.
    pub fn adjust(&mut self, change: impl Fn(&mut Network)) {
        let done = self.runs.adjust(change);
        self.report(done);
    }

    /// Releases the grabbed particle or sphere.
    pub fn release(&mut self) {
        if let Some(push) = self.runs.release() {
            self.history.record(push);
        }
    }

    /// Pins particle i at its position in every run, or frees it if it is pinned in the first run.
    pub fn toggle_pin(&mut self, i: usize) {
        let pinned = !self.runs.is_pinned(i);
        if self.pin(&[i], pinned) > 0 {
            let now = if pinned { "pinned" } else { "free" };
            self.readings.say(format!("Particle {i} is {now} now."));
        }
    }

    /// Pins particles at their positions in every run, or frees them, and shows how many.
    pub fn pin_all(&mut self, particles: &[usize], pinned: bool) {
        let count = self.pin(particles, pinned);
        self.readings.say(match (count, pinned) {
            (0, true) => "There is nothing here that could be pinned.".into(),
            (0, false) => "There are no pins here.".into(),
            (1, true) => "1 particle is pinned now.".into(),
            (1, false) => "1 particle is free now.".into(),
            (n, true) => format!("{n} particles are pinned now."),
            (n, false) => format!("{n} particles are free now."),
        });
    }

    /// Pins or frees particles, records the change in the history, and returns how many particles
    /// changed in the first run.
    fn pin(&mut self, particles: &[usize], pinned: bool) -> usize {
        self.runs.align();
        let moments = self
            .runs
            .all()
            .map(|run| run.blow_up().is_none().then(|| run.moment()));
        let before = (!pinned).then(|| moments.collect());
        let particles = self.runs.pin(particles, pinned);
        let count = particles.len();
        if count > 0 {
            self.history.record(Change::Pins {
                particles,
                pinned,
                before,
            });
        }
        count
    }

    /// Opens a list, or closes the one that is open.
    pub fn toggle_list(&mut self, topic: Topic) {
        if self.list.take().is_some_and(|list| list.topic == topic) {
            return;
        }
        if let Some(why) = self.panel.hidden.refusal_of_list(topic) {
            return self.readings.say(why);
        }
        let panes = &self.runs.panes;
        let entries = match topic {
            Topic::Scenes => self.scenes.entries(),
            Topic::Solvers { pane } | Topic::Beside { pane } => {
                solvers(&panes[pane.min(panes.len() - 1)].simulation)
            }
        };
        self.readings.help = false;
        self.list = Some(List::new(topic, entries));
    }

    /// Passes a key to the open list, and returns whether that changed the scene.
    pub fn press_list(&mut self, key: TextKey) -> bool {
        let Some(list) = &mut self.list else {
            return false;
        };
        if key == TextKey::Cancel {
            self.list = None;
            return false;
        }
        list.press(key)
            .is_some_and(|number| self.take_entry(number))
    }

    /// Applies an entry by its number, closes the list, and returns whether that changed the scene.
    pub fn take_entry(&mut self, number: usize) -> bool {
        match self.list.take().map(|list| list.topic) {
            Some(Topic::Scenes) => {
                if let Some(file) = self.scenes.earlier_file(number) {
                    return self.open(&file);
                }
                self.show_scene(number);
                true
            }
            Some(Topic::Solvers { pane }) => self.act(RunAction::Solver(number), pane),
            Some(Topic::Beside { pane }) => {
                let method = &integrators::METHODS[number];
                let pane = pane.min(self.runs.panes.len() - 1);
                let control = self.runs.panes[pane].control_of(method, &self.tuning.defaults);
                let added = panes::add(self, pane, (method, control));
                let is_new = added.is_ok();
                self.report(added);
                is_new
            }
            None => false,
        }
    }

    /// Shows the scene of this number, or a message that says why it cannot be built.
    fn show_scene(&mut self, number: usize) {
        match self.scenes.show(number) {
            Ok(setup) => {
                self.reset_camera(&setup);
                self.set_scene(&setup);
            }
            Err(error) => self.readings.warn(error.to_string()),
        }
    }

    /// Shows the scene of a file, and keeps solvers and steps that can integrate it. If the file
    /// cannot be opened, shows why and returns false; the runs continue.
    pub fn open(&mut self, file: &Path) -> bool {
        if file.is_dir() {
            let folder = file.display();
            let why = format!("{folder} is a folder: drop the scene file or the mesh in it.");
            self.readings.warn(why);
            return false;
        }
        if self.scenes.leaves_out(file) {
            let why = "This page has its own scenes alone: o lists them.";
            self.readings.warn(why);
            return false;
        }
        match self.scenes.open(file) {
            Ok(setup) => {
                let source = &self.scenes.shown.source;
                let summary = source.description.summary.as_deref();
                let what = summary.map_or(String::new(), |what| format!(": {what}"));
                self.readings.say(format!("Opened {}{what}.", source.typed));
                self.reset_camera(&setup);
                self.set_scene(&setup);
                true
            }
            Err(error) => {
                self.readings.warn(error.to_string());
                false
            }
        }
    }

    /// Reloads the scene from its file. Camera, solvers and steps change only if the file's did. If
    /// the file cannot be loaded, shows why and returns false; the runs continue.
    pub fn reload(&mut self) -> bool {
        let reloaded = match self.scenes.reload() {
            Ok(Some(reloaded)) => reloaded,
            Ok(None) => return false,
            Err(error) => {
                self.readings.warn(error.to_string());
                return false;
            }
        };
        let setup = &reloaded.setup;
        if reloaded.camera {
            self.reset_camera(setup);
        }
        let typed = &self.scenes.shown.source.typed;
        self.readings.say(format!("Loaded {typed} again."));
        let before = self.runs.first();
        let (windy, swinging) = (before.windy(), before.swinging());
        let touching = before.touching();
        self.set_scene(setup);
        for run in self.runs.all_mut() {
            run.set_wind(windy);
            run.set_swinging(swinging);
            // If surfaces cross in the new file, its own setting of self-collision stays.
            let _ = run.set_touching(touching);
        }
        if let Some(method) = reloaded.method {
            let control = setup.defaults.control_of(method);
            for pane in &mut self.runs.panes {
                if let Err(why) = pane.simulation.set_method(method, control) {
                    self.readings.say(why.to_string());
                }
                pane.wanted = method;
            }
            self.runs.adapt_reference();
        }
        true
    }

    /// Moves the camera to its initial position in a scene.
    fn reset_camera(&mut self, setup: &Setup) {
        self.view.set_camera(show::camera(&setup.presentation));
    }

    /// Starts another scene, and keeps solvers and steps that can integrate it.
    pub(super) fn set_scene(&mut self, setup: &Setup) {
        let said = match self.runs.set_scene(setup) {
            Ok(said) => {
                self.tuning = Tuning::of(&self.scenes.shown, setup);
                self.effects.forget();
                self.measuring.forget();
                self.readings.left_out.clear();
                self.panel.editor.forget(&self.runs);
                self.view.stop_following();
                self.history.clear();
                self.readings.read_reference(self.runs.reference.as_ref());
                self.begin_new_run();
                said
            }
            Err(why) => Some(why.to_string()),
        };
        if let Some(said) = said {
            self.readings.say(said);
        }
        apart::offer_at_start(self);
    }
}
