//! Runs that keep up with real time. Knows no window.

use std::time::{Duration, Instant};

use a3_core::{Grid, Network, Simulation, Vector3};
use a3_render::Camera;

use super::pane::Pane;
use super::readings::Readings;
use super::reference::Reference;
use super::timeline::History;
use super::tuning::{PanelState, Tuning};
use crate::failure::Failure;
use crate::scene_file::Source;
use crate::show::{self, Show};

/// Real time a frame may spend on steps. What does not fit is not caught up: all runs are slower than real time then.
/// Tests, which run several at a time, are not to depend on it.
const BUDGET: Duration = Duration::from_millis(if cfg!(test) { 400 } else { 12 });
/// Real time a frame may spend on the reference, at least, and as a share of the time it stands for.
/// Tests, which run several at a time, are not to hang on it.
const REFERENCE_BUDGET: (Duration, f64) =
    (Duration::from_millis(if cfg!(test) { 400 } else { 4 }), 0.1);
/// Real time that a key may take, other than a frame.
pub(super) const KEY_BUDGET: Duration = Duration::from_millis(200);
/// No frame owes more than this (s), however long it took: neither a slow one nor a laptop's sleep.
const MOST_OWED: f64 = 0.1;
/// How long a message stays.
const MESSAGE_TIME: Duration = Duration::from_secs(4);

/// How a session begins.
#[derive(Clone, Copy, Default)]
pub struct Beginning {
    /// Whether wires are drawn instead of the surface.
    pub wireframe: bool,
    /// Whether the runs are paused.
    pub paused: bool,
    /// The particle whose springs are highlighted.
    pub springs_of: Option<usize>,
}

/// One run on the screen, or several of one scene side by side.
pub struct Session {
    /// At least one.
    pub panes: Vec<Pane>,
    pub camera: Camera,
    pub readings: Readings,
    pub panel: PanelState,
    pub tuning: Tuning,
    /// The scene and grid asked for, to come back to.
    pub(super) asked: (Source, Option<Grid>),
    /// The scene shown, and the grid that it was built with if not its own.
    pub(super) shown: (Source, Option<Grid>),
    /// Which of the scenes is shown: that of the user, if it is a file, and those of the table.
    pub(super) at: usize,
    /// Where there are several panes.
    pub(super) reference: Option<Reference>,
    /// Simulated time that the panes have been brought to (s): each is less than a step behind.
    pub(super) clock: f64,
    history: History,
    message_ends: Option<Instant>,
    /// At how many steps, and when, the states were last read.
    read: Option<(u64, Instant)>,
    meter: Meter,
}

/// What happened since the readings were last taken.
struct Meter {
    begun: Instant,
    frames: u32,
    simulated: f64,
    simulating: Duration,
    drawing: Duration,
}

impl Meter {
    fn new() -> Self {
        Self {
            begun: Instant::now(),
            frames: 0,
            simulated: 0.0,
            simulating: Duration::ZERO,
            drawing: Duration::ZERO,
        }
    }
}

impl Session {
    /// These runs of one scene, at least one, which was built from `shown`.
    pub fn new(
        (source, grid): (&Source, Option<Grid>),
        simulations: Vec<Simulation>,
        beginning: &Beginning,
    ) -> Result<Self, Failure> {
        let panes: Vec<_> = simulations
            .into_iter()
            .map(|run| Pane::new(run, Show::new(beginning.wireframe, beginning.springs_of)))
            .collect();
        Ok(Self {
            camera: show::camera(&panes[0].simulation),
            readings: Readings {
                paused: beginning.paused,
                ..Readings::default()
            },
            panel: PanelState::default(),
            tuning: Tuning::of(panes[0].simulation.scene()),
            asked: (source.clone(), grid),
            shown: (source.clone(), grid),
            at: a3_scenes::SCENES
                .iter()
                .position(|entry| entry.name == source.typed)
                .unwrap_or(0),
            reference: Reference::new(&panes)?,
            clock: 0.0,
            history: History::default(),
            message_ends: None,
            read: None,
            meter: Meter::new(),
            panes,
        })
    }

    /// The first run: what is the same in all of them is asked of it.
    pub fn first(&self) -> &Simulation {
        &self.panes[0].simulation
    }

    /// Where the scene shown is from.
    pub fn shown(&self) -> &Source {
        &self.shown.0
    }

    /// Whether the next frame will look different by itself.
    pub fn animated(&self) -> bool {
        !self.readings.paused && self.panes.iter().any(Pane::alive)
    }

    /// Goes on by `real` seconds of real time, in steps of exactly the sizes asked for.
    pub fn tick(&mut self, real: f64) {
        if self.animated() {
            let real = real.min(MOST_OWED);
            let (least, share) = REFERENCE_BUDGET;
            let reference_budget = least.max(Duration::from_secs_f64(share * real));
            let simulated = real * 0.5f64.powi(self.readings.slowness);
            self.advance(self.clock + simulated, BUDGET, reference_budget);
        } else {
            self.settle();
        }
    }

    /// Brings all panes to a simulated time (s), together: in slices, so that none runs ahead when the budget of real
    /// time is over before.
    pub(super) fn advance(&mut self, until: f64, budget: Duration, reference_budget: Duration) {
        self.keep(false);
        let (begun, start) = (Instant::now(), self.clock);
        let steps = self.panes.iter().map(Pane::pace);
        let mut slice = steps.fold(f64::INFINITY, f64::min);
        while self.clock < until && begun.elapsed() < budget && self.panes.iter().any(Pane::alive) {
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
            self.readings.no_error = reference.stopped();
        }
        self.meter.simulated += self.clock - start;
        self.meter.simulating += begun.elapsed();
        for pane in &mut self.panes {
            pane.follow();
        }
        self.keep(false);
    }

    /// Keeps the states as they are, to come back to; `now`, also if others were kept just before.
    fn keep(&mut self, now: bool) {
        if self.readings.in_window {
            let panes = self.panes.iter().map(|pane| &pane.simulation);
            let reference = self.reference.as_ref().map(Reference::any);
            self.history.keep(self.clock, now, panes.chain(reference));
        }
        self.readings.place = self.history.place();
    }

    /// Goes so many kept moments on or back, and pauses. What is done next, goes on from there.
    pub fn scrub(&mut self, by: isize) {
        self.pause_to_scrub();
        if self.history.go(by) {
            self.show_moment();
        } else if by < 0 {
            self.say("Nothing older is kept.");
        }
    }

    /// Goes to a place in the kept time: from 0, the oldest moment, to 1, the newest.
    pub fn scrub_to(&mut self, share: f32) {
        self.pause_to_scrub();
        if self.history.go_to(share) {
            self.show_moment();
        }
    }

    fn pause_to_scrub(&mut self) {
        self.readings.paused = true;
        if self.readings.place.is_none() {
            self.settle();
            self.keep(true);
        }
    }

    fn show_moment(&mut self) {
        let panes = self.panes.iter_mut().map(|pane| &mut pane.simulation);
        let reference = self.reference.as_mut().map(Reference::any_run);
        self.history.show(panes.chain(reference));
        for pane in &mut self.panes {
            pane.error = None;
            pane.count();
        }
        if let Some(reference) = &mut self.reference {
            reference.follow(&mut self.panes, Duration::ZERO);
        }
        self.readings.place = self.history.place();
        self.hand_off();
        self.stand();
    }

    /// Owes nothing: the time is that of the pane that is farthest.
    pub(super) fn settle(&mut self) {
        let alive = self.panes.iter().filter(|pane| pane.alive());
        let times = alive.map(|pane| pane.simulation.time());
        self.clock = times.reduce(f64::max).unwrap_or(self.clock);
    }

    /// Goes on to `time` (s) exactly, however long that takes: without a window.
    pub fn run_to(&mut self, time: f64) {
        for pane in &mut self.panes {
            pane.run_to(time);
        }
        if let Some(reference) = &mut self.reference {
            reference.run_to(time, &mut self.panes);
            self.readings.no_error = reference.stopped();
        }
        self.settle();
    }

    /// Every run that goes on, the reference's too.
    fn runs(&mut self) -> impl Iterator<Item = &mut Simulation> {
        let alive = self.panes.iter_mut().filter(|pane| pane.alive());
        let reference = self.reference.as_mut().and_then(Reference::run);
        alive.map(|pane| &mut pane.simulation).chain(reference)
    }

    /// In every run, one that is lost too: what is on stays on when it starts again.
    pub(super) fn do_to_all(&mut self, mut hand: impl FnMut(&mut Simulation)) {
        for pane in &mut self.panes {
            hand(&mut pane.simulation);
        }
        if let Some(reference) = &mut self.reference {
            hand(reference.any_run());
        }
    }

    /// Changes something in every run, at the same time.
    pub fn change_all(&mut self, change: impl FnMut(&mut Simulation)) {
        self.align();
        self.do_to_all(change);
        for pane in &mut self.panes {
            pane.changed();
        }
        self.read = None;
    }

    /// Changes the model of every run: a reset keeps that.
    pub fn adjust(&mut self, change: impl Fn(&mut Network)) {
        self.change_all(|run| run.adjust(&change));
    }

    /// Brings several panes to the same time exactly, by a shorter step where need be: what a hand does from then on, it
    /// does to all of them at once.
    pub(super) fn align(&mut self) {
        if self.panes.len() < 2 {
            return;
        }
        self.settle();
        let clock = self.clock;
        if let Some(reference) = &mut self.reference
            && reference.run().is_some()
            && !reference.reach(clock, KEY_BUDGET)
        {
            reference.stop("the reference is too slow");
        }
        for run in self.runs() {
            // A blow-up is on the screen from now on.
            let _ = run.advance_to(clock);
        }
    }

    /// Takes hold of particle i in every run. Whether there is something to hold.
    pub fn grab(&mut self, i: usize) -> bool {
        self.align();
        self.runs()
            .fold(false, |held, run| held | run.grab(i).is_ok())
    }

    /// Takes hold of sphere k in every run. Whether there is something to hold.
    pub fn grab_sphere(&mut self, k: usize) -> bool {
        self.align();
        self.runs()
            .fold(false, |held, run| held | run.grab_sphere(k).is_ok())
    }

    /// Pulls what is held to the same place (m) in every run.
    pub fn pull(&mut self, target: Vector3<f64>) {
        self.runs().for_each(|run| {
            run.pull(target);
            run.pull_sphere(target);
        });
        for pane in &mut self.panes {
            pane.show.hand = Some(target);
        }
    }

    /// Lets go of it.
    pub fn release(&mut self) {
        let held = |run: &Simulation| run.grabbed().is_some() || run.grabbed_sphere().is_some();
        if self.runs().any(|run| held(run)) {
            self.align();
        }
        self.do_to_all(|run| {
            run.release();
            run.release_sphere();
        });
        self.hand_off();
    }

    fn hand_off(&mut self) {
        for pane in &mut self.panes {
            pane.show.hand = None;
        }
    }

    /// Pins particle i where it is in every run, or lets it go.
    pub fn toggle_pin(&mut self, i: usize) {
        self.align();
        // All alike, those too that were pinned in one of them only.
        let pinned = self
            .first()
            .model()
            .network()
            .is_some_and(|n| n.is_pinned(i));
        self.do_to_all(|run| {
            if run.model().network().is_some_and(|n| n.is_pinned(i)) == pinned {
                // It was picked: it is there.
                let _ = run.toggle_pin(i);
            }
        });
        let now = if pinned { "free" } else { "pinned" };
        self.say(format!("particle {i} is {now} now"));
    }

    /// Highlights and lists the springs of a particle, or of none.
    pub fn show_springs_of(&mut self, particle: Option<usize>) {
        for pane in &mut self.panes {
            pane.show.springs_of = particle;
        }
    }

    /// The states as they are now: ten times a second while they move, and when they stand still.
    pub fn read_state(&mut self) {
        let steps = self.panes.iter().map(|pane| pane.simulation.steps()).sum();
        let due = self.read.is_none_or(|(before, when)| {
            before != steps && (!self.animated() || when.elapsed() > Duration::from_millis(100))
        });
        if due {
            self.read = Some((steps, Instant::now()));
            self.panes.iter_mut().for_each(Pane::read_state);
        }
    }

    /// A frame was drawn, in this time. Twice a second the readings are taken, unless all stands still.
    pub fn drawn(&mut self, drawing: Duration) {
        if !self.animated() {
            self.readings.factor = 0.0;
            self.meter = Meter::new();
            return;
        }
        self.meter.frames += 1;
        self.meter.drawing += drawing;
        let elapsed = self.meter.begun.elapsed().as_secs_f32();
        if elapsed < 0.5 {
            return;
        }
        let meter = std::mem::replace(&mut self.meter, Meter::new());
        let frames = meter.frames as f32;
        self.readings.rate = frames / elapsed;
        self.readings.factor = meter.simulated as f32 / elapsed;
        self.readings.simulating = meter.simulating.as_secs_f32() * 1e3 / frames;
        self.readings.drawing = meter.drawing.as_secs_f32() * 1e3 / frames;
        self.panes.iter_mut().for_each(Pane::read_cost);
    }

    /// Owes nothing, and begins to measure anew: after a time in which nothing was simulated.
    pub fn stand(&mut self) {
        self.settle();
        self.read = None;
        self.meter = Meter::new();
    }

    /// Forgets what was: it is of another run.
    pub(super) fn forget(&mut self) {
        self.history.clear();
        self.readings.place = None;
        self.hand_off();
    }

    /// Says something for a few seconds.
    pub fn say(&mut self, message: impl Into<String>) {
        self.readings.message = Some(message.into());
        self.message_ends = Some(Instant::now() + MESSAGE_TIME);
    }

    /// Says something until something else is said.
    pub fn warn(&mut self, message: impl Into<String>) {
        self.readings.message = Some(message.into());
        self.message_ends = None;
    }

    /// Takes a message down whose time is over. Until when the one that is up stays.
    pub fn message_ends(&mut self) -> Option<Instant> {
        if self.message_ends.is_some_and(|end| end <= Instant::now()) {
            self.message_ends = None;
            self.readings.message = None;
        }
        self.message_ends
    }
}

#[cfg(test)]
pub mod tests {
    use super::super::keys::Action;
    use super::*;
    use crate::{cli, setup};
    use clap::Parser;

    pub fn session(words: &[&str]) -> Session {
        let words = ["a3"].iter().chain(words);
        let options = cli::Cli::try_parse_from(words).unwrap();
        let session = match options.command {
            Some(cli::Command::Compare(options)) => setup::comparison(&options),
            _ => setup::window(&options.window),
        };
        session.map_err(Failure::message).unwrap()
    }

    #[test]
    fn time_keeps_up_whatever_the_frame_rate() {
        for rate in [17.0, 60.0, 144.0] {
            let mut session = session(&["t", "0.01", "--scene", "chain"]);
            for _ in 0..(3.0 * rate) as u32 {
                session.tick(1.0 / rate);
            }
            assert!(
                (session.panes[0].simulation.time() - 3.0).abs() < 0.011,
                "{rate}: {}",
                session.panes[0].simulation.time()
            );
        }
    }

    #[test]
    fn a_frame_of_minutes_is_no_huge_step() {
        let mut session = session(&["t", "0.01", "--scene", "chain"]);
        session.tick(300.0);
        assert!(session.panes[0].simulation.time() <= MOST_OWED + 1e-9);
        assert!(session.panes[0].simulation.steps() <= 10);
    }

    #[test]
    fn a_long_step_waits_until_it_is_due() {
        let mut session = session(&["r", "0.5", "--scene", "simple"]);
        for _ in 0..65 {
            session.tick(1.0 / 60.0);
        }
        assert_eq!(session.panes[0].simulation.steps(), 2);
    }

    #[test]
    fn paused_it_stands_still() {
        let mut session = session(&["t", "0.01", "--paused"]);
        session.tick(0.05);
        assert_eq!(session.panes[0].simulation.steps(), 0);
        session.act(Action::Step, 0);
        assert_eq!(session.panes[0].simulation.steps(), 1);
        session.act(Action::Pause, 0);
        session.tick(0.05);
        assert_eq!(session.panes[0].simulation.steps(), 6);
    }

    #[test]
    fn a_lost_run_leaves_no_line_across_the_picture() {
        let mut session = session(&["e", "2", "--scene", "simple"]);
        while session.panes[0].simulation.blow_up().is_none() {
            session.act(Action::Step, 0);
        }
        let radius = |p: &[f32; 3]| p[0].hypot(p[1]);
        assert!(session.panes[0].show.trail().all(|p| radius(p) <= 100.0));
        let last = session.panes[0].show.trail().last().copied();
        session.act(Action::Step, 0);
        assert_eq!(session.panes[0].show.trail().last().copied(), last);
    }

    /// Several panes, brought to a time in frames of 60 Hz.
    pub fn compared(words: &[&str], time: f64) -> Session {
        let mut session = session(&[&["compare"], words].concat());
        frames(&mut session, time);
        session
    }

    fn frames(session: &mut Session, time: f64) {
        for _ in 0..(60.0 * time).round() as u32 {
            session.tick(1.0 / 60.0);
        }
    }

    fn times(session: &Session) -> Vec<f64> {
        let times = session.panes.iter().map(|pane| pane.simulation.time());
        times.collect()
    }

    #[test]
    fn slow_motion_is_slow_and_its_steps_are_the_same() {
        let mut session = session(&["t", "0.001", "--scene", "chain"]);
        for _ in 0..2 {
            session.act(Action::Slower, 0);
        }
        frames(&mut session, 2.0);
        let run = session.first();
        assert!((run.time() - 0.5).abs() < 2e-3, "{}", run.time());
        assert!((run.time() - 1e-3 * run.steps() as f64).abs() < 1e-9);
        for _ in 0..9 {
            session.act(Action::Slower, 0);
        }
        assert_eq!(session.readings.slowness, 6);
        for _ in 0..9 {
            session.act(Action::Faster, 0);
        }
        frames(&mut session, 1.0);
        assert!((session.first().time() - 1.5).abs() < 3e-3);
    }

    /// Back, on again to where it was, and from the middle a second time: the same to the bit.
    #[test]
    fn what_was_comes_back_to_the_bit_and_goes_on_from_there() {
        let mut session = session(&["t", "0.01", "--scene", "cloth"]);
        session.readings.in_window = true;
        frames(&mut session, 1.0);
        let newest = (session.first().time(), session.first().state().to_vec());
        session.act(Action::Scrub(-10), 0);
        let place = session.readings.place.unwrap();
        assert!(
            session.readings.paused && (place.back - 1.0 / 6.0).abs() < 0.02,
            "{place:?}"
        );
        let (time, steps) = (session.first().time(), session.first().steps());
        assert!(time < newest.0 && (time - 0.01 * steps as f64).abs() < 1e-9);
        let then = session.first().state().to_vec();
        // Nothing goes on by itself.
        session.tick(0.1);
        assert_eq!(session.first().state(), then);
        session.act(Action::Step, 0);
        session.act(Action::Scrub(10), 0);
        assert_eq!(session.readings.place, None);
        assert_eq!(
            (session.first().time(), session.first().state()),
            (newest.0, &newest.1[..])
        );
        session.act(Action::Scrub(-10), 0);
        assert_eq!(session.first().state(), then);
        session.act(Action::Pause, 0);
        while session.first().time() < newest.0 - 1e-9 {
            session.tick(0.01);
        }
        assert_eq!(
            (session.first().state(), session.readings.place),
            (&newest.1[..], None)
        );
        session.act(Action::Reset, 0);
        session.act(Action::Scrub(-1), 0);
        assert_eq!(
            (session.first().time(), session.readings.place),
            (0.0, None)
        );
    }

    #[test]
    fn going_back_undoes_a_blow_up() {
        let mut session = session(&["r", "0.05", "--scene", "mit"]);
        session.readings.in_window = true;
        while session.panes[0].alive() {
            session.tick(1.0 / 60.0);
        }
        session.act(Action::Scrub(-10), 0);
        assert!(session.panes[0].alive() && session.readings.place.is_some());
    }

    #[test]
    fn a_sphere_is_let_go_of_where_it_was_pushed() {
        let mut session = session(&["r", "0.005", "--scene", "mit-sphere"]);
        let place = |session: &Session| {
            let run = session.first();
            let sphere = run.model().network().unwrap().spheres()[0];
            sphere.path.at(run.time()).position
        };
        let before = place(&session);
        assert!(session.grab_sphere(0));
        session.pull(before + Vector3::new(0.2, 0.0, 0.0));
        frames(&mut session, 1.0);
        session.release();
        assert_eq!(session.first().grabbed_sphere(), None);
        let pushed = place(&session);
        assert!((pushed - before).norm() > 0.1);
        session.pull(before);
        frames(&mut session, 1.0);
        assert_eq!(place(&session), pushed);
    }

    #[test]
    fn a_pin_is_set_in_every_run_at_the_same_time() {
        let mut session = compared(&["r:0.013", "r:0.005", "--scene", "cloth"], 0.3);
        session.toggle_pin(210);
        let times = times(&session);
        assert_eq!(times[0], times[1]);
        let pinned = |session: &Session| {
            let networks = session
                .panes
                .iter()
                .map(|p| p.simulation.model().network().unwrap());
            networks.map(|n| n.is_pinned(210)).collect::<Vec<_>>()
        };
        assert_eq!(pinned(&session), [true, true]);
        frames(&mut session, 0.3);
        assert!(session.panes.iter().all(|pane| pane.error.unwrap() < 2e-3));
        session.toggle_pin(210);
        assert_eq!(pinned(&session), [false, false]);
    }

    #[test]
    fn panes_keep_the_same_time() {
        let session = compared(&["t:0.03", "r:0.07", "v", "--scene", "chain"], 2.0);
        for pane in &session.panes {
            let (run, step) = (&pane.simulation, pane.pace());
            assert!(
                run.time() < session.clock + 1e-9 && run.time() > session.clock - step - 1e-9,
                "{}",
                run.time()
            );
            assert!(session.clock > 1.5 && (run.time() - step * run.steps() as f64).abs() < 1e-9);
        }
    }

    #[test]
    fn when_one_is_slow_all_are() {
        let mut session = session(&["compare", "e:0.0000001", "r:0.0001"]);
        for _ in 0..4 {
            session.tick(0.1);
        }
        let times = times(&session);
        assert!(times[0] > 0.0 && times[0] < 0.2, "{times:?}");
        assert!(
            times[1] <= times[0] + 1e-9 && times[0] - times[1] < 1.1e-4,
            "{times:?}"
        );
    }

    #[test]
    fn the_error_is_the_distance_from_the_truth() {
        let session = compared(&["e:0.05", "r:0.07", "--scene", "simple"], 5.0);
        for (pane, bound) in session.panes.iter().zip([0.2, 1e-5]) {
            let (run, error) = (&pane.simulation, pane.error.unwrap());
            let (sin, cos) = run.time().sin_cos();
            let truth = (run.position(0) - Vector3::new(cos, sin, 0.0)).norm();
            assert!(
                error < bound && (error - truth).abs() < 0.02 * truth,
                "{error} {truth}"
            );
        }
    }

    /// All that a hand does to the panes, it does to the reference, at the same time.
    #[test]
    fn the_reference_gets_the_same_hands() {
        let mut session = compared(&["r:0.013", "r:0.005", "--scene", "cloth"], 0.5);
        let small = |session: &Session, what: &str| {
            let errors: Vec<_> = session.panes.iter().map(|pane| pane.error).collect();
            assert!(
                errors.iter().all(|e| e.is_some_and(|e| e < 2e-3)),
                "{what}: {errors:?}"
            );
        };
        small(&session, "still");
        session.act(Action::Swing, 0);
        let aligned = times(&session);
        assert_eq!(aligned[0], aligned[1]);
        frames(&mut session, 0.5);
        small(&session, "swinging");
        session.act(Action::Wind, 0);
        frames(&mut session, 0.5);
        small(&session, "in the wind");
        assert!(session.grab(399));
        for _ in 0..20 {
            session.pull(Vector3::new(1.0, 1.0, 1.5));
            frames(&mut session, 1.0 / 60.0);
        }
        let places = session
            .panes
            .iter()
            .map(|pane| pane.simulation.position(399));
        assert!(
            places
                .clone()
                .all(|p| (p - Vector3::new(1.0, 1.0, 1.5)).norm() < 0.1)
        );
        session.release();
        frames(&mut session, 0.2);
        // Each was pulled from its own place in its own time.
        assert!(session.panes.iter().all(|pane| pane.error.unwrap() < 0.1));
        session.act(Action::Reset, 0);
        assert_eq!(times(&session), [0.0, 0.0]);
        frames(&mut session, 0.5);
        small(&session, "again");
    }

    #[test]
    fn one_that_is_lost_leaves_the_others_alone() {
        let mut session = compared(&["e:0.05", "r:0.01", "--scene", "mit"], 2.0);
        assert!(!session.panes[0].alive() && session.panes[0].error.is_none());
        assert!(session.animated() && session.panes[1].error.unwrap() < 1e-3);
        assert!((times(&session)[1] - session.clock).abs() < 0.011);
        session.act(Action::Reset, 0);
        assert!(session.panes[0].alive());
    }

    #[test]
    fn without_a_window_all_end_at_the_same_time() {
        let mut session = session(&["compare", "e:0.03", "r:0.07", "--scene", "simple"]);
        session.run_to(1.0);
        assert_eq!(times(&session), [1.0, 1.0]);
        let errors: Vec<_> = session.panes.iter().map(|p| p.error.unwrap()).collect();
        assert!(errors[0] > 0.01 && errors[1] < 1e-5, "{errors:?}");
        let cost = session.panes[0].cost.unwrap();
        assert_eq!(cost.evaluations, 34.0);
        assert!(cost.computing > 0.0);
    }
}
