//! A run that keeps up with real time, and what the keys do to it. Knows no window.

use std::time::{Duration, Instant};

use a3_core::{Method, SceneEntry, Simulation, integrators, scenes};
use a3_render::{Camera, Style};

use super::hud::Readings;
use super::keys::Action;
use crate::Failure;
use crate::cli;
use crate::show::{self, Show};

/// Real time a frame may spend on steps. What does not fit is not caught up: the run is slower than real time then.
const BUDGET: Duration = Duration::from_millis(12);
/// No frame owes more than this (s), however long it took: neither a slow one nor a laptop's sleep.
const MOST_OWED: f64 = 0.1;
/// An adaptive method is asked for no more at once (s).
const PORTION: f64 = 1.0 / 240.0;
/// How long a message stays.
const MESSAGE_TIME: Duration = Duration::from_secs(4);
/// Steps of the keys + and -, in each decade.
const LADDER: [f64; 10] = [1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0];

/// A run on the screen.
pub struct Session {
    pub simulation: Simulation,
    pub show: Show,
    pub camera: Camera,
    pub readings: Readings,
    /// The scene and grid asked for, to come back to.
    asked: cli::What,
    entry: &'static SceneEntry,
    /// The solver asked for, also while a scene is shown that it cannot serve.
    wanted: &'static Method,
    /// Real time not yet simulated (s).
    owed: f64,
    message_ends: Option<Instant>,
    /// At how many steps, and when, the state was last read.
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
    /// The session that the command line asks for.
    pub fn new(options: &cli::Window) -> Result<Self, Failure> {
        let simulation = options.what.simulation(options.solver, options.step)?;
        cli::check_particle(&simulation, options.springs_of)?;
        Ok(Self {
            camera: show::camera(&simulation),
            show: Show::new(options.wireframe, options.springs_of),
            readings: Readings {
                paused: options.paused,
                ..Readings::default()
            },
            asked: options.what.clone(),
            entry: options.what.scene,
            wanted: options.solver,
            owed: 0.0,
            message_ends: None,
            read: None,
            meter: Meter::new(),
            simulation,
        })
    }

    /// Whether the next frame will look different by itself.
    pub fn animated(&self) -> bool {
        !self.readings.paused && self.simulation.blow_up().is_none()
    }

    /// Goes on by `real` seconds of real time, in steps of exactly the size asked for.
    pub fn tick(&mut self, real: f64) {
        if !self.animated() {
            self.owed = 0.0;
            return;
        }
        if self.simulation.method().is_adaptive() {
            return self.tick_adaptive(real);
        }
        let step = self.simulation.setting();
        self.owed = (self.owed + real.min(MOST_OWED)).min(MOST_OWED.max(step));
        let mut left = (self.owed / step + 1e-9).floor() as u64;
        let begun = Instant::now();
        let mut portion = 1;
        while left > 0 && begun.elapsed() < BUDGET {
            let count = portion.min(left);
            // A blow-up is on the screen from now on.
            if self.simulation.take_steps(count).is_err() {
                break;
            }
            left -= count;
            self.owed -= count as f64 * step;
            self.meter.simulated += count as f64 * step;
            if begun.elapsed() < BUDGET / 16 {
                portion *= 2;
            }
        }
        if left > 0 {
            self.owed = 0.0;
        }
        self.meter.simulating += begun.elapsed();
        self.follow();
    }

    /// Goes on by `real` seconds: an adaptive method is read off where the frame wants it.
    fn tick_adaptive(&mut self, real: f64) {
        let begun = Instant::now();
        let start = self.simulation.time();
        let end = start + real.min(MOST_OWED);
        // In portions, of which the budget may cut off the last ones.
        while self.simulation.time() < end && begun.elapsed() < BUDGET {
            let next = (self.simulation.time() + PORTION).min(end);
            // A blow-up is on the screen from now on.
            if self.simulation.advance_to(next).is_err() {
                break;
            }
        }
        self.meter.simulated += (self.simulation.time() - start).max(0.0);
        self.meter.simulating += begun.elapsed();
        self.follow();
    }

    /// The trail goes on, unless the run is lost: it would lead to where the particle no longer is.
    fn follow(&mut self) {
        if self.simulation.blow_up().is_none() {
            self.show.follow(&self.simulation);
        }
    }

    /// Energy and stretch of the state as it is now: ten times a second while it moves, and when it stands still.
    pub fn read_state(&mut self) {
        let due = self.read.is_none_or(|(steps, when)| {
            steps != self.simulation.steps()
                && (!self.animated() || when.elapsed() > Duration::from_millis(100))
        });
        if due {
            self.read = Some((self.simulation.steps(), Instant::now()));
            self.readings.energy = self.simulation.energy().map(|energy| energy.total());
            self.readings.stretch = self.simulation.largest_stretch();
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
    }

    /// Owes nothing, and begins to measure anew: after a time in which nothing was simulated.
    pub fn stand(&mut self) {
        self.owed = 0.0;
        self.read = None;
        self.meter = Meter::new();
    }

    /// Says something for a few seconds.
    pub fn say(&mut self, message: impl Into<String>) {
        self.readings.message = Some(message.into());
        self.message_ends = Some(Instant::now() + MESSAGE_TIME);
    }

    /// Takes a message down whose time is over. Until when the one that is up stays.
    pub fn message_ends(&mut self) -> Option<Instant> {
        if self.message_ends.is_some_and(|end| end <= Instant::now()) {
            self.message_ends = None;
            self.readings.message = None;
        }
        self.message_ends
    }

    /// Does what a key asks for, except what needs the window. Whether the scene is another one now.
    pub fn act(&mut self, action: Action) -> bool {
        let simulation = &mut self.simulation;
        match action {
            Action::NextScene => {
                self.next_scene();
                return true;
            }
            Action::Reset => {
                simulation.reset();
                self.show.clear_trail();
                self.stand();
            }
            Action::Swing if simulation.scene().swing.is_none() => {
                self.say("There is nothing to swing here.");
            }
            Action::Swing => simulation.set_swinging(!simulation.swinging()),
            Action::Wind if simulation.scene().wind.is_none() => self.say("There is no wind here."),
            Action::Wind => simulation.set_wind(!simulation.windy()),
            Action::Wireframe => {
                self.show.style = match self.show.style {
                    Style::Shaded => Style::Wireframe,
                    Style::Wireframe => Style::Shaded,
                };
            }
            Action::Pause => {
                self.readings.paused = !self.readings.paused;
                self.stand();
            }
            Action::Step => {
                self.readings.paused = true;
                // A blow-up is on the screen from now on.
                let _ = self.simulation.take_steps(1);
                self.follow();
            }
            Action::Solver(i) => match integrators::METHODS.get(i) {
                Some(method) => self.set_method(method),
                None => self.say(format!("There are {} solvers.", integrators::METHODS.len())),
            },
            Action::LongerStep => self.set_step(true),
            Action::ShorterStep => self.set_step(false),
            Action::Camera => self.camera = show::camera(&self.simulation),
            Action::Help => self.readings.help = !self.readings.help,
            Action::Picture | Action::Quit => {}
        }
        false
    }

    fn set_method(&mut self, method: &'static Method) {
        let run = &self.simulation;
        let setting = if method.is_adaptive() == run.method().is_adaptive() {
            run.setting()
        } else {
            run.scene().default_setting(method)
        };
        match self.simulation.set_method(method, setting) {
            Ok(()) => self.wanted = method,
            Err(why) => self.say(why.to_string()),
        }
    }

    fn set_step(&mut self, longer: bool) {
        let range = cli::settings(self.simulation.method());
        let next = next_step(self.simulation.setting(), longer);
        let step = next.clamp(*range.start(), *range.end());
        if let Err(why) = self.simulation.set_setting(step) {
            self.say(why.to_string());
        }
    }

    /// The next scene of the table, with the same solver if it can be, and the same step.
    fn next_scene(&mut self) {
        let here = scenes::SCENES
            .iter()
            .position(|entry| std::ptr::eq(entry, self.entry))
            .unwrap_or(0);
        let entry = &scenes::SCENES[(here + 1) % scenes::SCENES.len()];
        let step = self.simulation.setting();
        let grid = self
            .asked
            .grid
            .filter(|_| std::ptr::eq(entry, self.asked.scene));
        let start = |method| Simulation::new(entry.build(grid)?, method, step);
        // Heun serves every scene.
        let simulation = start(self.wanted).or_else(|why| {
            self.say(format!("{why}: the explicit trapezoid steps in"));
            start(integrators::find("trapezoid").unwrap_or(self.wanted))
        });
        match simulation {
            Ok(simulation) => {
                self.camera = show::camera(&simulation);
                self.simulation = simulation;
                self.entry = entry;
                self.show.clear_trail();
                self.show.springs_of = None;
                self.stand();
            }
            Err(why) => self.say(why.to_string()),
        }
    }
}

/// The next longer or shorter step of the ladder (s).
fn next_step(step: f64, longer: bool) -> f64 {
    let decade = step.log10().floor() as i32;
    let rungs = (decade - 1..=decade + 1).flat_map(|d| {
        // Dividing by a power of ten is exact to the last digit where multiplying by its inverse is not.
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
    use crate::cli::{LARGEST_STEP, SMALLEST_STEP};
    use clap::Parser;

    fn session(words: &[&str]) -> Session {
        let words = ["a3"].iter().chain(words);
        match Session::new(&cli::Cli::try_parse_from(words).unwrap().window) {
            Ok(session) => session,
            Err(Failure::Usage(why) | Failure::Run(why) | Failure::Interrupted(why)) => {
                panic!("{why}")
            }
        }
    }

    #[test]
    fn time_keeps_up_whatever_the_frame_rate() {
        for rate in [17.0, 60.0, 144.0] {
            let mut session = session(&["t", "0.01", "--scene", "chain"]);
            for _ in 0..(3.0 * rate) as u32 {
                session.tick(1.0 / rate);
            }
            assert!(
                (session.simulation.time() - 3.0).abs() < 0.011,
                "{rate}: {}",
                session.simulation.time()
            );
        }
    }

    #[test]
    fn a_frame_of_minutes_is_no_huge_step() {
        let mut session = session(&["t", "0.01", "--scene", "chain"]);
        session.tick(300.0);
        assert!(session.simulation.time() <= MOST_OWED + 1e-9);
        assert!(session.simulation.steps() <= 10);
    }

    #[test]
    fn a_long_step_waits_until_it_is_due() {
        let mut session = session(&["r", "0.5", "--scene", "simple"]);
        for _ in 0..65 {
            session.tick(1.0 / 60.0);
        }
        assert_eq!(session.simulation.steps(), 2);
    }

    #[test]
    fn paused_it_stands_still() {
        let mut session = session(&["t", "0.01", "--paused"]);
        session.tick(0.05);
        assert_eq!(session.simulation.steps(), 0);
        session.act(Action::Step);
        assert_eq!(session.simulation.steps(), 1);
        session.act(Action::Pause);
        session.tick(0.05);
        assert_eq!(session.simulation.steps(), 6);
    }

    #[test]
    fn scenes_come_round_and_the_solver_comes_back() {
        let mut session = session(&["v", "0.005"]);
        let mut seen = vec![];
        for _ in 0..scenes::SCENES.len() {
            seen.push((
                session.simulation.scene().name,
                session.simulation.method().name,
            ));
            assert!(session.act(Action::NextScene));
        }
        let expected = ["cloth", "simple", "pendulum", "chain", "mit", "mit-sphere"];
        assert_eq!(
            seen.iter().map(|(scene, _)| *scene).collect::<Vec<_>>(),
            expected
        );
        // Verlet cannot serve the circle, and serves the others again.
        let solvers: Vec<_> = seen.iter().map(|(_, solver)| *solver).collect();
        assert_eq!(
            solvers,
            [
                "verlet",
                "trapezoid",
                "verlet",
                "verlet",
                "verlet",
                "verlet"
            ]
        );
        assert_eq!(session.simulation.scene().name, "cloth");
    }

    #[test]
    fn the_grid_asked_for_comes_back() {
        let mut session = session(&["t", "0.005", "--grid", "30x25"]);
        for _ in 0..scenes::SCENES.len() {
            session.act(Action::NextScene);
        }
        assert_eq!(session.simulation.particles(), 750);
    }

    #[test]
    fn a_lost_run_leaves_no_line_across_the_picture() {
        let mut session = session(&["e", "2", "--scene", "simple"]);
        while session.simulation.blow_up().is_none() {
            session.act(Action::Step);
        }
        let radius = |p: &[f32; 3]| p[0].hypot(p[1]);
        assert!(session.show.trail().all(|p| radius(p) <= 100.0));
        let last = session.show.trail().last().copied();
        session.act(Action::Step);
        assert_eq!(session.show.trail().last().copied(), last);
    }

    #[test]
    fn steps_climb_the_ladder() {
        assert_eq!(next_step(0.01, true), 0.012);
        assert_eq!(next_step(0.01, false), 0.008);
        assert_eq!(next_step(0.008, true), 0.01);
        assert_eq!(next_step(0.0123, false), 0.012);
        assert_eq!(next_step(8.0, true), 10.0);
        let ends = |solver, end: f64, longer| {
            let action = if longer {
                Action::LongerStep
            } else {
                Action::ShorterStep
            };
            let mut session = session(&[solver, &end.to_string(), "--scene", "chain"]);
            session.act(action);
            session.simulation.setting() == end
        };
        assert!(ends("r", LARGEST_STEP, true) && ends("r", SMALLEST_STEP, false));
        assert!(ends("a", 1.0, true) && ends("a", 1e-13, false));
    }
}
