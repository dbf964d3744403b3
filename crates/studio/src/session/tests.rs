//! Sessions for tests, and tests of what a user does: surfaces that come apart, and panes that come
//! and go.

use a3_core::{Control, Simulation, integrators};

use super::action::RunAction;
use super::measuring::MethodSetting;
use super::{Session, acts, begin, panel, words};

/// Creates the session of a command line.
pub fn session(words: &[&str]) -> Session {
    let owned: Vec<_> = words.iter().map(|word| (*word).to_owned()).collect();
    begin::session(&words::read(&owned).unwrap()).unwrap()
}

/// Creates a comparison, advanced to a time (s) in frames of 60 Hz.
pub fn compared(words: &[&str], time: f64) -> Session {
    let mut session = session(&[&["compare"], words].concat());
    frames(&mut session, time);
    session
}

/// Advances a session by a time (s) in frames of 60 Hz.
pub fn frames(session: &mut Session, time: f64) {
    for _ in 0..(60.0 * time).round() as u32 {
        session.tick(1.0 / 60.0);
    }
}

/// Returns the simulated time of each run (s).
pub fn times(session: &Session) -> Vec<f64> {
    let times = session.runs.panes.iter().map(|pane| pane.simulation.time());
    times.collect()
}

/// Returns whether surfaces cross in any run.
fn crosses(session: &Session) -> bool {
    session.runs.all().any(acts::crosses)
}

/// Returns the places (m) of all particles of the first run.
fn places(session: &Session) -> Vec<f64> {
    let run = session.runs.first();
    run.state()[..3 * run.particles()].to_vec()
}

/// A file whose surfaces begin crossed opens all the same, and key x brings them apart, which
/// can be undone and done again.
#[test]
fn a_tangled_scene_opens_and_comes_apart() {
    let folder = tempfile::tempdir().unwrap();
    let tangled = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes/tangled.toml");
    let text = std::fs::read_to_string(tangled).unwrap();
    let text = text.replace("untangle = true\n", "");
    let path = folder.path().join("crossed.toml");
    std::fs::write(&path, &text).unwrap();
    let first = session(&["--scene", path.to_str().unwrap()]);
    let mut dropped = session(&["--scene", "flag"]);
    assert!(dropped.open(&path));
    for mut session in [Box::new(first), Box::new(dropped)] {
        session.readings.in_window = true;
        assert!(session.readings.offers_apart && !session.runs.first().touching());
        assert_eq!(session.tuning.defaults.duration, Some(1.0));
        assert!(session.readings.paused);
        session.act(RunAction::Pause, 0);
        frames(&mut session, 0.05);
        let before = places(&session);
        assert!(crosses(&session));
        session.act(RunAction::Touch, 0);
        let after = places(&session);
        assert!(session.runs.first().touching() && !crosses(&session));
        assert!(!session.readings.offers_apart);
        // A particle moves by half an edge at most, and velocities stay.
        let moved = after.iter().zip(&before).map(|(a, b)| (a - b).abs());
        let farthest = moved.fold(0.0, f64::max);
        assert!(farthest > 0.01 && farthest < 0.5, "{farthest} m");
        panel::undo(&mut session, false);
        assert_eq!(places(&session), before);
        assert!(!session.runs.first().touching());
        panel::undo(&mut session, true);
        assert_eq!(places(&session), after);
        frames(&mut session, 0.1);
        let run = session.runs.first();
        let lost = run.blow_up().map(|lost| lost.to_string());
        assert!(run.touching() && !crosses(&session), "{lost:?}");
    }
}

/// Surfaces that crossed while they did not touch are offered to come apart in every run.
#[test]
fn what_crossed_in_motion_comes_apart_in_every_run() {
    let mut session = compared(&["r", "v", "--scene", "mit"], 0.1);
    // An edge at a corner comes to stand in the middle of the cloth.
    let (n, mut moment) = (225, session.runs.first().moment());
    for (i, up) in [(n - 1, 0.3), (n - 2, -0.3)] {
        for (axis, by) in [-1.1, up, -1.2].into_iter().enumerate() {
            moment.run.y[axis * n + i] += by;
        }
    }
    session.return_to(&[Some(moment.clone()), Some(moment.clone()), Some(moment)]);
    assert!(crosses(&session));
    session.act(RunAction::Touch, 0);
    let said = session.readings.message.clone().unwrap();
    assert!(said.starts_with("Surfaces that cross cannot"), "{said}");
    session.act(RunAction::Touch, 0);
    let said = session.readings.message.clone().unwrap();
    assert!(!crosses(&session), "{said}");
    assert!(session.runs.all().all(Simulation::touching));
    // After a reset, the states are another run's: only self-collision is undone.
    session.act(RunAction::Reset, 0);
    panel::undo(&mut session, false);
    assert_eq!(session.runs.first().time(), 0.0);
    assert!(!session.runs.all().any(Simulation::touching));
}

fn setting(method: &str, step: f64) -> MethodSetting {
    (integrators::find(method).unwrap(), Control::Step(step))
}

/// The pane goes on from the same state as by a run from there, and errors are distances from
/// the truth.
#[test]
fn a_pane_goes_on_from_the_present_state() {
    let mut session = session(&["r", "0.01", "--scene", "simple"]);
    frames(&mut session, 1.0);
    session.add_pane(0, setting("euler", 0.05)).unwrap();
    let [rk4, euler] = [0, 1].map(|k| session.runs.panes[k].simulation.state().to_vec());
    assert_eq!(rk4, euler);
    let begun = session.runs.clock;
    frames(&mut session, 2.0);
    let run = &session.runs.panes[1].simulation;
    let steps = ((run.time() - begun) / 0.05).round();
    // A step of Euler's method on the circle lengthens the radius by sqrt(1 + h^2).
    let radius = run.position(0).norm();
    let expected = 1.0025_f64.powf(0.5 * steps);
    assert!((radius - expected).abs() < 1e-6, "{radius} {expected}");
    let error = session.runs.panes[1].error.unwrap();
    assert!(error > radius - 1.0 && error < 0.2, "{error}");
    assert!(session.runs.panes[0].error.unwrap() < 1e-6);
    let times = times(&session);
    assert!(times[0] > 2.9 && (times[0] - times[1]).abs() < 0.051);
}

#[test]
fn panes_come_up_to_four_and_go_down_to_one() {
    let mut session = session(&["t", "0.01", "--scene", "chain"]);
    frames(&mut session, 0.2);
    for step in [0.02, 0.005, 0.001] {
        session.add_pane(0, setting("rk4", step)).unwrap();
        frames(&mut session, 0.1);
    }
    assert!(session.add_pane(0, setting("rk4", 0.01)).is_err());
    session.panel.pane = 3;
    assert!(session.remove_pane(0));
    let steps = |session: &Session| -> Vec<f64> {
        let panes = session.runs.panes.iter();
        panes.map(|pane| pane.simulation.control().value()).collect()
    };
    assert_eq!(steps(&session), [0.02, 0.005, 0.001]);
    frames(&mut session, 0.1);
    session.act(RunAction::Scrub(-3), 0);
    session.act(RunAction::Pause, 0);
    for _ in 0..2 {
        assert!(session.remove_pane(1));
    }
    assert!(!session.remove_pane(0));
    assert_eq!(steps(&session), [0.02]);
    frames(&mut session, 0.1);
    assert!(session.runs.reference.is_none() && session.runs.panes[0].error.is_none());
    session.act(RunAction::Reset, 0);
    assert_eq!(session.runs.first().time(), 0.0);
}

#[test]
fn a_run_that_blew_up_or_an_unfit_method_is_not_continued() {
    let mut session = compared(&["e:0.05", "r:0.01", "--scene", "mit"], 2.0);
    assert!(session.add_pane(0, setting("rk4", 0.01)).is_err());
    let mut circle = crate::session::session(&["r", "0.01", "--scene", "simple"]);
    assert!(circle.add_pane(0, setting("verlet", 0.01)).is_err());
    assert_eq!(circle.runs.panes.len(), 1);
    circle.use_setting(0, setting("trapezoid", 0.03));
    let run = circle.runs.first();
    assert_eq!((run.method().name, run.control()), ("trapezoid", Control::Step(0.03)));
}
