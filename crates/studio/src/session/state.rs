//! A session: its parts, their common advance in time, and the readings that the text over the
//! picture shows beside those of each run: the frame rate, the time per frame, and the speed of
//! the simulation.

use a3_core::{Checkpoint, Error, Simulation};
use a3_files::failure::Failure;
use a3_media::show::Show;
use a3_scenes::Setup;
use web_time::{Duration, Instant};

use super::action::RunAction;
use super::history::History;
use super::list::List;
use super::measuring::Measuring;
use super::origin::Origin;
use super::pane::Pane;
use super::reference::ReferenceRun;
use super::runs::{KEY_BUDGET, Runs};
use super::scenes::Scenes;
use super::timeline::{Timeline, TimelinePosition};
use super::tuning::{DEFAULT_FILM_SECONDS, PanelState, Tuning};
use super::view::View;
use super::words::Opening;

/// Computing time of the steps of a frame: the larger of a fixed time and a share of the frame's
/// real time, so that steps may take as long as a slow display. Steps beyond it are dropped, and
/// the runs are then slower than real time. It is longer in tests, which run in parallel and must
/// not depend on it.
const STEP_BUDGET: (Duration, f64) =
    (Duration::from_millis(if cfg!(test) { 400 } else { 12 }), 0.5);
/// Computing time of the reference in a frame: the larger of a fixed time and a share of the
/// frame's real time. It is longer in tests, which run in parallel and must not depend on it.
const REFERENCE_BUDGET: (Duration, f64) =
    (Duration::from_millis(if cfg!(test) { 400 } else { 4 }), 0.1);
/// Longest real time (s) that a frame simulates, even if the last one took longer.
const MAX_FRAME_TIME: f64 = 0.3;

/// Number of steps before a blow-up that are on the timeline, each as a moment.
const STEPS_BEFORE_BLOW_UP: f64 = 60.0;
/// Longest real time in which these steps are taken again to record them.
const MAX_TIME_AGAIN: Duration = Duration::from_secs(1);

/// One visible run, or several of one scene side by side.
pub struct Session {
    /// The runs and their time.
    pub runs: Runs,
    /// The camera.
    pub view: View,
    /// The scenes that can be shown.
    pub scenes: Scenes,
    /// The last seconds of all runs.
    pub timeline: Timeline,
    /// Changes for undo and redo.
    pub history: History,
    /// Changes that the panel made to the scene.
    pub tuning: Tuning,
    /// Questions about the scene, and their answers.
    pub measuring: Measuring,
    /// State of the panel.
    pub panel: PanelState,
    /// The open list, if there is one.
    pub list: Option<List>,
    /// Values for the text over the picture.
    pub readings: Readings,
    /// Frames and times since the last reading of rates.
    meter: Meter,
    /// Whether the user has ever pulled or pushed something.
    pub pulled: bool,
    /// Time (s) of the blow-up whose last steps were taken again.
    taken_again: Option<f64>,
}

impl Session {
    /// Creates a session on at least one run of the scene from `origin`, which was built as
    /// `setup`. Fails if there can be no reference.
    pub fn new(
        origin: Origin,
        setup: &Setup,
        simulations: Vec<Simulation>,
        opening: &Opening,
    ) -> Result<Self, Failure> {
        let show = || Show::new(setup.presentation.clone(), opening.manner);
        let panes = simulations.into_iter().map(|run| Pane::new(run, show()));
        let panes: Vec<_> = panes.collect();
        Ok(Self {
            view: View::new(panes[0].show.camera()),
            runs: Runs::new(panes)?,
            timeline: Timeline::default(),
            history: History::default(),
            tuning: Tuning::of(&origin, setup),
            scenes: Scenes::new(origin),
            measuring: Measuring::default(),
            panel: PanelState { film_seconds: DEFAULT_FILM_SECONDS, ..PanelState::default() },
            list: None,
            readings: Readings { paused: opening.paused, ..Readings::default() },
            meter: Meter::new(),
            pulled: false,
            taken_again: None,
        })
    }

    /// Returns whether this is visible beside the picture: it is open, and the help does not hide
    /// it.
    pub fn shows(&self, pane: RunAction) -> bool {
        self.panel.has(pane) && !self.readings.help
    }

    /// Returns whether the runs advance: the next frame will differ.
    pub fn animated(&self) -> bool {
        !self.readings.paused && self.runs.any_alive()
    }

    /// Advances the runs by `real` seconds of real time, in steps of exactly the chosen lengths.
    pub fn tick(&mut self, real: f64) {
        if self.animated() {
            let real = real.min(MAX_FRAME_TIME);
            let budget = |(least, share): (Duration, f64)| {
                let share = Duration::from_secs_f64(share * real);
                share.max(least)
            };
            let simulated = real * 0.5f64.powi(self.readings.slowness);
            let end = self.tuning.defaults.duration;
            let left = end.map(|end| end - self.runs.clock).filter(|left| *left > 0.0);
            let simulated = left.map_or(simulated, |left| simulated.min(left));
            self.advance(simulated, budget(STEP_BUDGET), budget(REFERENCE_BUDGET));
            self.pause_at_end(left.is_some());
        } else {
            self.runs.drop_due_steps();
        }
    }

    /// Pauses at the end of the scene, if it has one and the run was before it.
    fn pause_at_end(&mut self, was_before: bool) {
        let end = self.tuning.defaults.duration;
        let end = end.filter(|end| was_before && self.runs.clock >= *end);
        if let Some(end) = end {
            self.readings.paused = true;
            self.readings.say(format!("The scene ends at {end} s: Space goes on, r begins again."));
        }
    }

    /// Advances the runs by `simulated` (s), as far as the budgets of real time allow, and records
    /// their states on the timeline, as often in a slow window as in a quick one.
    pub(super) fn advance(&mut self, simulated: f64, budget: Duration, reference_budget: Duration) {
        self.record(false);
        let (begun, start) = (Instant::now(), self.runs.clock);
        let (end, alive) = (start + simulated, self.runs.count_alive());
        let left = |budget: Duration| budget.saturating_sub(begun.elapsed());
        loop {
            let due = self.timeline.due().filter(|due| *due > self.runs.clock);
            let due = due.filter(|_| self.readings.in_window);
            let next = due.map_or(end, |due| due.min(end));
            self.runs.advance(next, left(budget), left(reference_budget));
            if self.readings.in_window && self.runs.count_alive() < alive {
                self.record_blow_up();
                break;
            }
            self.record(false);
            // The budget is used up, or all runs have diverged.
            if next >= end || self.runs.clock < next {
                break;
            }
        }
        self.meter.count_steps(self.runs.clock - start, begun.elapsed());
        self.readings.read_reference(self.runs.reference.as_ref());
        self.record(false);
    }

    /// Goes back to before the last steps that ended in a blow-up, and takes them again one by one,
    /// so that each is on the timeline. If that takes too long, the runs continue on the way there.
    fn record_blow_up(&mut self) {
        let diverged = self.runs.panes.iter().filter(|pane| !pane.alive());
        let latest = diverged.max_by(|a, b| a.simulation.time().total_cmp(&b.simulation.time()));
        let Some((time, step)) = latest.map(|pane| (pane.simulation.time(), pane.slice())) else {
            return;
        };
        if self.taken_again.replace(time) == Some(time) {
            self.timeline.blew_up = true;
            return;
        }
        let (begun, alive) = (Instant::now(), self.runs.count_alive());
        let from = time - STEPS_BEFORE_BLOW_UP * step;
        self.return_to(&self.timeline.before(from));
        self.runs.advance(from, KEY_BUDGET, KEY_BUDGET);
        while self.runs.count_alive() > alive && begun.elapsed() < MAX_TIME_AGAIN {
            self.record(true);
            let next = self.runs.clock + step;
            self.runs.advance(next, KEY_BUDGET, KEY_BUDGET);
        }
        if self.runs.count_alive() == alive {
            self.timeline.blew_up = true;
        }
    }

    /// Records the states on the timeline if the last moment is old enough, or with `now` if it is
    /// older at all.
    fn record(&mut self, now: bool) {
        if self.readings.in_window && self.runs.any_alive() {
            let runs = &self.runs;
            self.timeline.record(runs.clock, now, runs.all());
        }
        self.readings.timeline = self.timeline.position();
    }

    /// Advances all runs to exactly `time` (s), however long that takes.
    pub fn run_to(&mut self, time: f64) {
        self.runs.run_to(time);
        self.readings.read_reference(self.runs.reference.as_ref());
    }

    /// Reads the states, if that is due.
    pub fn read_state(&mut self) {
        self.runs.read_state(self.animated());
    }

    /// Counts a frame that took `drawing` to draw, and updates the rates twice a second while a run
    /// advances.
    pub fn count_frame(&mut self, drawing: Duration) {
        if !self.animated() {
            let rates = &mut self.readings.rates;
            (rates.factor, rates.rate) = (0.0, 0.0);
            self.meter = Meter::new();
            return;
        }
        if let Some(rates) = self.meter.count_frame(drawing) {
            self.readings.rates = rates;
            self.runs.panes.iter_mut().for_each(Pane::read_cost);
        }
    }

    /// Restarts all measurements and drops due steps, after a time in which nothing was simulated.
    pub fn restart_measuring(&mut self) {
        self.runs.restart_measuring();
        self.meter = Meter::new();
    }

    /// Pauses and goes `by` moments forward on the timeline, or back if it is negative. The runs
    /// then continue from there.
    pub fn scrub(&mut self, by: isize) {
        self.pause_to_scrub();
        if self.timeline.go(by) {
            self.show_moment();
        } else if by < 0 {
            self.readings.say("There is nothing earlier to go back to.");
        }
    }

    /// Pauses and goes to a share of the timeline: 0 is the oldest moment, 1 the newest.
    pub fn scrub_to(&mut self, share: f32) {
        self.pause_to_scrub();
        if self.timeline.go_to(share) {
            self.show_moment();
        }
    }

    /// Pauses, and records the newest states so that the user can return to them.
    fn pause_to_scrub(&mut self) {
        self.readings.paused = true;
        self.taken_again = None;
        if !self.readings.rewound() {
            self.runs.drop_due_steps();
            self.record(true);
        }
    }

    /// Restores all runs to the chosen moment of the timeline.
    fn show_moment(&mut self) {
        self.timeline.show(self.runs.all_mut());
        self.continue_from_here();
    }

    /// Goes back to earlier states of the runs that have one, from which they then continue.
    pub fn return_to(&mut self, moments: &[Option<Checkpoint>]) {
        for (run, moment) in self.runs.all_mut().zip(moments) {
            // The state is of this run, so it fits.
            let _ = moment.as_ref().map(|moment| run.rewind(moment));
        }
        self.runs.drop_due_steps();
        self.timeline.forget_after(self.runs.clock);
        self.continue_from_here();
    }

    /// Restarts all measurements, because the states of the runs were replaced.
    fn continue_from_here(&mut self) {
        self.runs.states_changed();
        self.readings.timeline = self.timeline.position();
        self.runs.hide_hand();
        self.restart_measuring();
    }

    /// Restores the first run from a checkpoint, and releases the grabbed particle or sphere. Fails
    /// if the checkpoint is of another scene.
    pub fn restore(&mut self, checkpoint: &Checkpoint) -> Result<(), Error> {
        self.runs.panes[0].restore(checkpoint)?;
        self.runs.touched = true;
        self.begin_new_run();
        Ok(())
    }

    /// Clears the timeline and restarts all measurements, because a new run begins.
    pub(super) fn begin_new_run(&mut self) {
        self.timeline.clear();
        self.taken_again = None;
        self.history.begin_new_run();
        self.readings.timeline = None;
        self.runs.hide_hand();
        self.restart_measuring();
    }
}

/// Real time between two readings (s).
const READING_SECONDS: f32 = 0.5;

/// Frames and times since the last reading.
pub struct Meter {
    begun: Instant,
    frames: u32,
    /// Simulated time (s).
    simulated: f64,
    /// Computing time of steps.
    simulating: Duration,
    /// Time spent on drawing.
    drawing: Duration,
}

/// Means over the frames since the last reading.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rates {
    /// Frames per second.
    pub rate: f32,
    /// Simulated time over real time.
    pub factor: f32,
    /// Time a frame spends on steps (ms).
    pub simulating: f32,
    /// Time for drawing a frame, and waiting for the screen (ms).
    pub drawing: f32,
}

impl Meter {
    /// Creates a meter that starts now.
    pub fn new() -> Self {
        Self {
            begun: Instant::now(),
            frames: 0,
            simulated: 0.0,
            simulating: Duration::ZERO,
            drawing: Duration::ZERO,
        }
    }

    /// Counts steps that took `simulating` and advanced the runs by `simulated` (s).
    pub fn count_steps(&mut self, simulated: f64, simulating: Duration) {
        self.simulated += simulated;
        self.simulating += simulating;
    }

    /// Counts a frame, and returns a reading twice a second.
    pub fn count_frame(&mut self, drawing: Duration) -> Option<Rates> {
        self.frames += 1;
        self.drawing += drawing;
        let elapsed = self.begun.elapsed().as_secs_f32();
        if elapsed < READING_SECONDS {
            return None;
        }
        let done = std::mem::replace(self, Self::new());
        let frames = done.frames as f32;
        Some(Rates {
            rate: frames / elapsed,
            factor: done.simulated as f32 / elapsed,
            simulating: done.simulating.as_secs_f32() * 1e3 / frames,
            drawing: done.drawing.as_secs_f32() * 1e3 / frames,
        })
    }
}

/// Time for which a message is shown.
const MESSAGE_DURATION: Duration = Duration::from_secs(4);

/// Progress of a film that is being made.
#[derive(Clone, Debug)]
pub struct FilmProgress {
    /// Whether the film is live: it records until it is stopped.
    pub live: bool,
    /// The progress in words.
    pub said: String,
}

/// A box drawn with the mouse, whose particles will be pinned or freed.
#[derive(Clone, Copy, Debug)]
pub struct Selection {
    /// Opposite corners (points).
    pub corners: [[f32; 2]; 2],
    /// Number of particles in the box.
    pub count: usize,
    /// Whether the particles will be pinned.
    pub pinned: bool,
}

/// Values that the text shows.
#[derive(Clone, Debug, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each is shown by itself")]
pub struct Readings {
    /// Whether the runs are paused.
    pub paused: bool,
    /// Whether the help is shown.
    pub help: bool,
    /// Whether the window asks if it should close.
    pub asks_to_quit: bool,
    /// Rates of frames and of the simulation.
    pub rates: Rates,
    /// Message that is shown.
    pub message: Option<String>,
    /// Time when the message disappears; `None` if it stays.
    pub message_ends: Option<Instant>,
    /// Whether the message offers to bring surfaces apart.
    pub offers_apart: bool,
    /// The box that is being drawn.
    pub selection: Option<Selection>,
    /// Progress of the film, if one is being made.
    pub film: Option<FilmProgress>,
    /// Whether there is a window, with keys to press.
    pub in_window: bool,
    /// Whether fingers are used, for which buttons are larger.
    pub touch: bool,
    /// Reason why the errors of the panes are unknown, if they are.
    pub no_error: Option<&'static str>,
    /// Time past which the errors say little (s), if the scene is known to be chaotic.
    pub predictable: Option<f64>,
    /// Slow motion: simulated time advances at 1 / 2^slowness of real time.
    pub slowness: i32,
    /// Names of the parts that are left out of the scene.
    pub left_out: Vec<String>,
    /// Position on the timeline; `None` before there are two moments.
    pub timeline: Option<TimelinePosition>,
}

impl Readings {
    /// Shows a message, as a sentence, for a few seconds.
    pub fn say(&mut self, message: impl Into<String>) {
        self.warn(message);
        self.message_ends = Some(Instant::now() + MESSAGE_DURATION);
    }

    /// Shows a message, as a sentence, until the next one.
    pub fn warn(&mut self, message: impl Into<String>) {
        self.message = Some(sentence(message.into()));
        self.message_ends = None;
        self.offers_apart = false;
    }

    /// Shows a message that surfaces cross, until the next one, and offers to bring them apart.
    pub fn offer(&mut self, message: impl Into<String>) {
        self.warn(message);
        self.offers_apart = true;
    }

    /// Removes an expired message, and returns when the shown one expires.
    pub fn message_ends(&mut self) -> Option<Instant> {
        if self.message_ends.is_some_and(|end| end <= Instant::now()) {
            self.message_ends = None;
            self.message = None;
        }
        self.message_ends
    }

    /// Returns whether the runs are at an earlier moment of the timeline than the newest.
    pub fn rewound(&self) -> bool {
        self.timeline.is_some_and(|position| position.share < 1.0)
    }

    /// Updates the errors of the panes from the reference, if there is one.
    pub(super) fn read_reference(&mut self, reference: Option<&ReferenceRun>) {
        self.no_error = reference.and_then(|it| it.stopped);
        self.predictable = reference.and_then(ReferenceRun::predictable);
    }
}

/// Makes a sentence of a message: with a capital, unless it begins with a file or another name, and
/// with a full stop.
fn sentence(mut message: String) -> String {
    let first = message.split(' ').next().unwrap_or_default();
    let first = first.trim_end_matches([':', ',']);
    if !first.is_empty() && first.chars().all(|c| c.is_ascii_lowercase()) {
        message[..1].make_ascii_uppercase();
    }
    if !message.ends_with(['.', '!', '?']) {
        message.push('.');
    }
    message
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{RunAction, frames, session};

    #[test]
    fn time_keeps_up_at_any_frame_rate() {
        for rate in [17.0, 60.0, 144.0] {
            let mut session = session(&["t", "0.01", "--scene", "chain"]);
            for _ in 0..(3.0 * rate) as u32 {
                session.tick(1.0 / rate);
            }
            let time = session.runs.first().time();
            assert!((time - 3.0).abs() < 0.011, "{rate}: {time}");
        }
    }

    #[test]
    fn a_frame_of_minutes_advances_by_the_longest_frame_time() {
        let mut session = session(&["t", "0.01", "--scene", "chain"]);
        session.tick(300.0);
        assert!(session.runs.panes[0].simulation.time() <= MAX_FRAME_TIME + 1e-9);
        assert!(session.runs.panes[0].simulation.steps() <= 30);
    }

    #[test]
    fn a_scene_pauses_at_its_end_and_can_go_on() {
        let ellipse = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes/ellipse.toml");
        let mut session = session(&["v", "0.005", "--scene", ellipse]);
        frames(&mut session, 1.5);
        let time = |session: &Session| session.runs.first().time();
        assert!(session.readings.paused && (time(&session) - 0.8).abs() < 1e-9);
        session.act(RunAction::Pause, 0);
        frames(&mut session, 0.5);
        assert!(!session.readings.paused && time(&session) > 1.2);
    }

    #[test]
    fn a_long_step_waits_until_it_is_due() {
        let mut session = session(&["r", "0.5", "--scene", "simple"]);
        for _ in 0..65 {
            session.tick(1.0 / 60.0);
        }
        assert_eq!(session.runs.panes[0].simulation.steps(), 2);
    }

    #[test]
    fn paused_it_stands_still() {
        let mut session = session(&["t", "0.01", "--paused"]);
        session.tick(0.05);
        assert_eq!(session.runs.panes[0].simulation.steps(), 0);
        session.act(RunAction::Step, 0);
        assert_eq!(session.runs.panes[0].simulation.steps(), 1);
        session.act(RunAction::Pause, 0);
        session.tick(0.05);
        assert_eq!(session.runs.panes[0].simulation.steps(), 6);
    }

    #[test]
    fn slow_motion_is_slow_and_its_steps_are_the_same() {
        let mut session = session(&["t", "0.001", "--scene", "chain"]);
        for _ in 0..2 {
            session.act(RunAction::Slower, 0);
        }
        frames(&mut session, 2.0);
        let run = session.runs.first();
        assert!((run.time() - 0.5).abs() < 2e-3, "{}", run.time());
        assert!((run.time() - 1e-3 * run.steps() as f64).abs() < 1e-9);
        for _ in 0..9 {
            session.act(RunAction::Slower, 0);
        }
        assert_eq!(session.readings.slowness, 6);
        for _ in 0..9 {
            session.act(RunAction::Faster, 0);
        }
        frames(&mut session, 1.0);
        assert!((session.runs.first().time() - 1.5).abs() < 3e-3);
    }

    #[test]
    fn messages_are_sentences_and_names_stay_as_they_are() {
        for (message, said) in [
            ("wrote a3-cloth-1.png", "Wrote a3-cloth-1.png."),
            ("own.toml:3: no such key", "own.toml:3: no such key."),
            ("undone: 20 pins", "Undone: 20 pins."),
            ("dopri5 fits no rods", "dopri5 fits no rods."),
            ("There is no wind here.", "There is no wind here."),
            ("3 pins", "3 pins."),
        ] {
            let mut readings = Readings::default();
            readings.say(message);
            assert_eq!(readings.message.as_deref(), Some(said));
        }
    }
}
