//! The door of a session: what a user asks for by keys, mouse and lists. What opens beside the
//! picture, one sheet at a time; panes that come and go while the motion goes on; lessons, which
//! put another session in its place; and surfaces that cross, which come apart on request.

use std::path::Path;
use std::sync::Arc;

use a3_core::{Checkpoint, Error, Network, Simulation, integrators};
use a3_files::holding::Sought;
use a3_media::show;
use a3_scenes::{Description, Setup};

use super::action::{Action, MeasureRequest, PanelKey, RunAction};
use super::history::Change;
use super::list::{List, TextKey, Topic, solvers};
use super::measuring::MethodSetting;
use super::origin::Origin;
use super::pane::{ADAPTIVE_SLICE, Pane};
use super::reference::continue_from;
use super::runs::KEY_BUDGET;
use super::state::Session;
use super::traces::PlotRequest;
use super::tuning::Tuning;
use super::view::SEEN_TIME;
use super::{asking, begin, looks, panel, plotting, save};

/// Carries out an action, and returns whether it changed the scene. Those on a solver are for the
/// run of pane `at`; those of the window do nothing here.
pub fn apply(session: &mut Session, action: impl Into<Action>, at: usize) -> bool {
    let own = &mut session.panel;
    match action.into() {
        Action::Run(action) => return session.act(action, at),
        Action::Window(_) => {}
        Action::Panel(request) => return panel::apply(session, request),
        Action::Measure(request) => return asking::apply(session, request, panel::pane(session)),
        Action::Learn(request) => {
            return own.lessons.apply(request, &mut own.all_marked) && session.begin_step();
        }
        Action::Plot(request) => {
            if let Some(said) = plotting::apply(&mut own.plotting, &mut session.runs.panes, request)
            {
                session.readings.say(said);
            }
            session.recall_plots();
        }
        Action::Type(key) if own.has(RunAction::Lessons) => {
            own.lessons.type_key(key, &mut own.all_marked);
        }
        Action::Type(key) => panel::type_key(session, key),
    }
    false
}

/// Returns the action of a key in what is open beside the picture. With `other`, a knob turns by
/// the other step of its scale.
pub fn action_beside(session: &Session, key: PanelKey, other: bool) -> Option<Action> {
    let by = match key {
        PanelKey::Left => Some(-1),
        PanelKey::Right => Some(1),
        _ => None,
    };
    match session.panel.beside.filter(|_| !session.readings.help)? {
        RunAction::Panel => Some(panel::request(session, key, other).into()),
        RunAction::Lessons => session.panel.lessons.request(key).map(Action::Learn),
        RunAction::Measure => match (by, key) {
            (Some(by), _) => {
                let next = session.measuring.question.neighbour(by);
                Some(MeasureRequest::Ask(next).into())
            }
            (None, PanelKey::Toggle) => Some(MeasureRequest::Toggle.into()),
            _ => None,
        },
        _ => Some(PlotRequest::Mode(session.panel.plotting.mode.neighbour(by?)).into()),
    }
}

/// Returns whether keys type something: the value of a knob, or the answer to a question.
pub fn is_typing(session: &Session) -> bool {
    session.shows(RunAction::Lessons) && session.panel.lessons.typing
        || session.shows(RunAction::Panel) && session.panel.typed.is_some()
}

/// Largest slowness: motion at 1 / 2^6 of real time.
const MAX_SLOWNESS: i32 = 6;

/// Largest number of panes.
pub const MAX_PANES: usize = 4;

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
            RunAction::Touch => self.toggle_touch(),
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
                None => {
                    self.readings.say(format!("There are {} solvers.", integrators::METHODS.len()));
                }
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
                self.toggle(action);
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
        if touching && !self.runs.first().touching() {
            let why = "Surfaces cross in the initial state, so self-collision is off again";
            self.readings.offer(why);
        }
        self.readings.read_reference(self.runs.reference.as_ref());
        self.history.begin_again();
        self.begin_new_run();
    }

    /// Resets all runs, and gives that of a pane, which blew up, what would have held.
    pub fn run_again(&mut self, at: usize) {
        let sought = self.runs.panes[at].limit.sought;
        if let Some(control) = sought.and_then(Sought::control) {
            self.set_step_of(at, control.value());
            self.reset();
            self.readings.paused = false;
        }
    }

    /// Pauses, and advances all runs by the longest step among them.
    fn step(&mut self) {
        self.readings.paused = true;
        self.runs.drop_due_steps();
        let alive = self.runs.panes.iter().filter(|pane| pane.alive());
        let steps = alive.map(|pane| pane.simulation.step_size().unwrap_or(ADAPTIVE_SLICE));
        let longest = steps.fold(0.0, f64::max);
        self.advance(longest, KEY_BUDGET, KEY_BUDGET);
    }

    /// Shows the error of a refused request. Returns whether there is none.
    pub fn report(&mut self, done: Result<(), impl ToString>) -> bool {
        done.map_err(|why| self.readings.say(why.to_string())).is_ok()
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
            self.history.record(push, None);
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
        let before = (!pinned).then(|| self.runs.moments());
        let particles = self.runs.pin(particles, pinned);
        let count = particles.len();
        if count > 0 {
            let change = Change::Pins { particles, pinned };
            self.history.record(change, before);
        }
        count
    }

    /// Opens a list, or closes the one that is open.
    pub fn toggle_list(&mut self, topic: Topic) {
        if self.list.take().is_some_and(|list| list.topic == topic) {
            return;
        }
        let refusal = self.panel.hidden.refusal(RunAction::Solvers);
        if let Some(why) = refusal.filter(|_| topic != Topic::Scenes) {
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
        list.press(key).is_some_and(|number| self.take_entry(number))
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
                let added = self.add_pane(pane, (method, control));
                self.report(added)
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
                self.see_motion();
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
                self.see_motion();
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
        let disturbances = self.runs.first().disturbances();
        self.set_scene(setup);
        for run in self.runs.all_mut() {
            // If surfaces cross in the new file, its own setting of self-collision stays.
            let _ = run.set_disturbances(disturbances);
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

    /// Moves the camera so that the motion that begins fills most of the picture, in a scene that
    /// names no camera.
    pub(super) fn see_motion(&mut self) {
        let first = self.runs.first();
        let is_named = self.scenes.shown.source.description.camera.is_some();
        if !is_named && let Ok(run) = first.anew(first.method(), first.control()) {
            let until = self.tuning.defaults.duration.unwrap_or(SEEN_TIME);
            self.view.see_motion(&mut self.runs.panes, run, until.min(SEEN_TIME));
        }
    }

    /// Starts another scene, and keeps solvers and steps that can integrate it.
    pub(super) fn set_scene(&mut self, setup: &Setup) {
        let said = match self.runs.set_scene(setup) {
            Ok(said) => {
                self.tuning = Tuning::of(&self.scenes.shown, setup);
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
        self.offer_at_start();
    }

    /// If the surfaces of the scene begin crossed, pauses, says so, and offers to bring them apart.
    pub fn offer_at_start(&mut self) {
        if self.scenes.shown.crossed {
            let name = &self.runs.first().scene().name;
            self.readings.offer(format!(
                "The surfaces of the scene {name} begin crossed, so they do not touch yet: key x brings them apart, and \
                 Space plays."
            ));
            self.readings.paused = true;
        }
    }

    /// Turns self-collision on or off. If surfaces cross, says which, and offers to bring them
    /// apart; does so if that was offered.
    pub fn toggle_touch(&mut self) {
        if self.readings.offers_apart {
            return self.bring_apart();
        }
        let Err(why) = self.runs.toggle_touch() else {
            return;
        };
        if self.runs.all().any(crosses) {
            self.readings.offer(why);
        } else {
            self.readings.say(why);
        }
    }

    /// Brings the surfaces of all runs apart, and says so.
    fn bring_apart(&mut self) {
        match self.come_apart() {
            Ok(()) => {
                let plays = if self.readings.paused { ", Space plays" } else { "" };
                self.readings.say(format!(
                    "The surfaces are apart now, and touch: key z undoes that{plays}."
                ));
            }
            Err(why) => self.readings.warn(why),
        }
    }

    /// Brings the surfaces of all runs apart and lets them touch, as one change that can be undone.
    /// Fails, and changes nothing, if a run has blown up or its surfaces do not come apart.
    pub fn come_apart(&mut self) -> Result<(), String> {
        if !self.runs.panes.iter().all(Pane::alive) {
            let why = "A run has blown up: reset it (key r) before its surfaces come apart.";
            return Err(why.into());
        }
        self.release();
        self.runs.align();
        let before = self.runs.moments();
        let runs = self.runs.all();
        let after: Result<Arc<[_]>, String> = runs.map(|run| apart(self, run).map(Some)).collect();
        self.go_to(&after?);
        self.history.record(Change::Apart, Some(before));
        Ok(())
    }

    /// Goes to states in which surfaces touch, or to those before they came apart. If these are
    /// forgotten, turns self-collision off alone.
    pub fn go_to(&mut self, moments: &[Option<Checkpoint>]) {
        self.return_to(moments);
        for run in self.runs.all_mut() {
            if moments.is_empty() {
                // Turning self-collision off does not fail.
                let _ = run.set_touching(false);
            } else {
                // The energy that comes from elsewhere is no gain of the solver, which fits.
                let _ = run.set_method(run.method(), run.control());
            }
        }
    }

    /// Opens the panel, the measurements, the lessons or the plots beside the picture, or closes
    /// it; the others are closed then.
    pub fn toggle(&mut self, action: RunAction) {
        if action == RunAction::Measure && self.measuring.answerer.is_none() {
            let why = "Only the program measures: key y copies the command line for it.";
            return self.readings.say(why);
        }
        let panel = &mut self.panel;
        (panel.typed, panel.all_marked, panel.lessons.typing) = (None, false, false);
        panel.beside = Some(action).filter(|pane| !panel.has(*pane));
        if panel.has(RunAction::Plots) {
            plotting::pick_first(&mut self.runs.panes);
            self.recall_plots();
        }
        if action != RunAction::Panel {
            self.readings.help = false;
            self.list = None;
        }
    }

    /// Adds a pane that continues the run of pane `at` by another method. Errors count from now on,
    /// if there were none before. The timeline begins again.
    ///
    /// # Errors
    /// There is no room for another pane, the run has blown up, or the method does not support it.
    pub fn add_pane(&mut self, at: usize, (method, control): MethodSetting) -> Result<(), String> {
        if self.runs.panes.len() >= MAX_PANES {
            return Err(format!("There are {MAX_PANES} panes already: close one."));
        }
        self.release();
        self.runs.align();
        let beside = &self.runs.panes[at];
        if !beside.alive() {
            return Err("This run has blown up: reset it (key r).".into());
        }
        let run = &beside.simulation;
        let continued = || -> Result<Simulation, Error> {
            let mut next = Simulation::new(run.scene().clone(), method, control)?;
            continue_from(&mut next, run)?;
            Ok(next)
        };
        let simulation = continued().map_err(|why| why.to_string())?;
        let mut show = beside.show.clone();
        show.clear_trail();
        show.hovered = None;
        let mut next = Pane::new(simulation, show);
        next.traces = beside.traces.without_values();
        let added = self.runs.add_pane(next);
        added.map_err(|failure| failure.to_string())?;
        self.readings.read_reference(self.runs.reference.as_ref());
        self.begin_new_run();
        self.readings.say(format!("{} runs beside.", method.title));
        Ok(())
    }

    /// Removes a pane, unless it is the only one. Undone changes of knobs of panes are forgotten,
    /// and the timeline begins again.
    pub fn remove_pane(&mut self, at: usize) -> bool {
        if self.runs.panes.len() < 2 || at >= self.runs.panes.len() {
            return false;
        }
        self.release();
        self.runs.remove_pane(at);
        self.panel.pane = 0;
        self.history.clear();
        self.view.stop_following();
        self.list.take_if(|list| list.topic != Topic::Scenes);
        self.readings.read_reference(self.runs.reference.as_ref());
        self.begin_new_run();
        true
    }

    /// Sets the method of pane `at` and its step or tolerance, or says why that is impossible.
    pub fn use_setting(&mut self, at: usize, (method, control): MethodSetting) {
        let defaults = self.tuning.defaults;
        let set = self.runs.set_method(method, at, &defaults);
        let set = set.and_then(|()| self.runs.set_step_of(at, control.value()));
        self.readings.say(match set {
            Ok(()) => format!("{} is in use.", method.title),
            Err(why) => why.to_string(),
        });
    }

    /// Begins the run of the step of a lesson that is shown, and returns whether that was possible.
    fn begin_step(&mut self) -> bool {
        let Some((_, step)) = self.panel.lessons.shown() else {
            return false;
        };
        match begin::step(step) {
            Ok(next) => self.replace(next),
            Err(why) => {
                self.readings.warn(why.to_string());
                return false;
            }
        }
        true
    }

    /// Shows another session in place of the present one, with the settings of the window.
    fn replace(&mut self, next: Self) {
        let former = std::mem::replace(self, next);
        let dark = former.runs.panes[0].show.dark;
        looks::each(&mut self.runs.panes, |show| show.dark = dark);
        self.panel = former.panel;
        (self.panel.pane, self.panel.typed) = (0, None);
        self.panel.editor.forget(&self.runs);
        self.pulled = former.pulled;
        self.measuring.answerer = former.measuring.answerer;
        self.scenes.adopt(former.scenes);
        self.readings.in_window = former.readings.in_window;
        self.readings.touch = former.readings.touch;
        self.readings.film = former.readings.film;
    }

    /// Shows the present scene as it was edited, or without edits, unless it is shown so already.
    /// Fails if such a scene cannot be built.
    pub fn show_edited(&mut self, edited: Option<&Description>) -> Result<(), String> {
        let own = self.scenes.unedited();
        let next = match edited {
            Some(description) => Origin {
                source: own.source.described(description.clone()),
                grid: None,
                edited: true,
                ..own
            },
            None => own,
        };
        let shown = &self.scenes.shown;
        if next.source.description == shown.source.description && next.edited == shown.edited {
            return Ok(());
        }
        let setup = next.build().map_err(|error| error.to_string())?;
        self.scenes.shown = next;
        self.set_scene(&setup);
        Ok(())
    }

    /// Gives what has just been chosen for plots its values in the last seconds.
    fn recall_plots(&mut self) {
        for (k, pane) in self.runs.panes.iter_mut().enumerate() {
            pane.traces.recall(&pane.simulation, self.timeline.past(k));
        }
    }

    /// Removes the ruler of the former scene and, if the plots are open, plots what moves alone.
    pub fn begin_plots(&mut self) {
        self.panel.plotting.ruler = None;
        if self.panel.has(RunAction::Plots) {
            plotting::pick_first(&mut self.runs.panes);
        }
    }
}

/// Returns whether surfaces of a run cross.
pub(super) fn crosses(run: &Simulation) -> bool {
    run.model().network().is_some_and(|network| {
        let (x, _) = network.halves(run.state());
        !network.crossed(run.time(), x).is_empty()
    })
}

/// Returns the state of a run with its surfaces apart, in which they touch.
fn apart(session: &Session, run: &Simulation) -> Result<Checkpoint, String> {
    let mut description = save::description(session, run);
    (description.self_collision, description.untangle) = (true, true);
    let source = session.scenes.shown.source.described(description);
    let setup = source.build(None).map_err(|error| error.to_string())?;
    let mut moment = run.moment();
    let (time, state) = (moment.time(), &mut moment.run);
    (state.since, state.taken, state.shown) = (time, 0, None);
    state.y = setup.scene.state;
    moment.touching = true;
    Ok(moment)
}
