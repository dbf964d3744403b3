//! Surfaces that cross, and so cannot touch, come apart if the user wants that.

use std::sync::Arc;

use a3_core::{Checkpoint, Simulation};

use super::history::Change;
use super::pane::Pane;
use super::save;
use super::state::Session;

/// If the surfaces of the scene begin crossed, pauses, says so, and offers to bring them apart.
pub fn offer_at_start(session: &mut Session) {
    if session.scenes.shown.crossed {
        let name = &session.runs.first().scene().name;
        session.readings.offer(format!(
            "The surfaces of the scene {name} begin crossed, so they do not touch yet: key x brings them apart, and \
             Space plays."
        ));
        session.readings.paused = true;
    }
}

/// Turns self-collision on or off. If surfaces cross, says which, and offers to bring them apart;
/// does so if that was offered.
pub fn toggle_touch(session: &mut Session) {
    let is_page = cfg!(target_arch = "wasm32");
    if session.readings.offers_apart && !is_page {
        return bring_apart(session);
    }
    let Err(why) = session.runs.toggle_touch() else {
        return;
    };
    let crosses = |run: &Simulation| {
        run.model().network().is_some_and(|network| {
            let (x, _) = network.halves(run.state());
            !network.crossed(run.time(), x).is_empty()
        })
    };
    if !is_page && session.runs.all().any(crosses) {
        session.readings.offer(why);
    } else {
        session.readings.say(why);
    }
}

/// Brings the surfaces of all runs apart and lets them touch, as one change that can be undone.
fn bring_apart(session: &mut Session) {
    if !session.runs.panes.iter().all(Pane::alive) {
        let why = "A run has blown up: reset it (key r) before its surfaces come apart.";
        return session.readings.say(why);
    }
    session.release();
    session.runs.align();
    let before: Arc<[_]> = session.runs.all().map(|run| Some(run.moment())).collect();
    let runs = session.runs.all();
    let after: Result<Arc<[_]>, String> = runs.map(|run| apart(session, run).map(Some)).collect();
    match after {
        Ok(after) => {
            go_to(session, &after);
            session.history.record(Change::Apart { before, after });
            let plays = if session.readings.paused {
                ", Space plays"
            } else {
                ""
            };
            session.readings.say(format!(
                "The surfaces are apart now, and touch: key z undoes that{plays}."
            ));
        }
        Err(why) => session.readings.warn(why),
    }
}

/// Goes to states in which surfaces touch, or to those before they came apart. If these are
/// forgotten, turns self-collision off alone.
pub fn go_to(session: &mut Session, moments: &[Option<Checkpoint>]) {
    session.return_to(moments);
    for run in session.runs.all_mut() {
        if moments.is_empty() {
            // Turning self-collision off does not fail.
            let _ = run.set_touching(false);
        } else {
            // The energy that comes from elsewhere is no gain of the solver, which fits the run.
            let _ = run.set_method(run.method(), run.control());
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::hud::panel;
    use crate::window::session::{RunAction, frames, session};

    /// Returns whether surfaces cross in any run.
    fn crosses(session: &Session) -> bool {
        let runs = session.runs.all();
        runs.map(|run| (run, run.model().network().unwrap()))
            .any(|(run, network)| {
                let (x, _) = network.halves(run.state());
                !network.crossed(run.time(), x).is_empty()
            })
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
        let tangled = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../docs/scenes/tangled.toml"
        );
        let text = std::fs::read_to_string(tangled).unwrap();
        let text = text.replace("untangle = true\n", "");
        let path = folder.path().join("crossed.toml");
        std::fs::write(&path, &text).unwrap();
        let first = session(&["--scene", path.to_str().unwrap()]);
        let mut dropped = session(&["--scene", "flag"]);
        assert!(dropped.open(&path));
        for mut session in [first, dropped] {
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
        let mut session = crate::window::session::compared(&["r", "v", "--scene", "mit"], 0.1);
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
}
