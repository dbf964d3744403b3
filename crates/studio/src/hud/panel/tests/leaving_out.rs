//! Leaving parts out of a running scene, and bringing them back.

use a3_core::contact::Shape;
use a3_core::{Network, Vector3};
use egui::vec2;

use super::screen::{Screen, every_scene, opened, part, toggle, type_key};
use crate::session::panel::{is_in, part_row, row_of, rows, set_part, tuned, undo};
use crate::session::{PanelKey, PanelRequest, RunAction, Session, Turn, apply, compared, frames};

fn network(session: &Session) -> &Network {
    session.runs.first().model().network().unwrap()
}

/// Returns the forces of a run at a time (s) in a state.
fn forces(session: &Session, (t, y): &(f64, Vec<f64>)) -> Vec<f64> {
    let mut f = vec![0.0; y.len()];
    let system = session.runs.first().model().system();
    system.eval_f(*t, y, &mut f);
    f
}

/// Returns the time (s) and the state of the first run.
fn moment(session: &Session) -> (f64, Vec<f64>) {
    let run = session.runs.first();
    (run.time(), run.state().to_vec())
}

/// Leaves out each part of a scene, or brings it in, and back again, while the scene runs: the
/// state goes on, and the forces come back to the bit. Returns the number of parts, and the names
/// of those that changed the forces at once.
fn every_part_comes_and_goes(session: &mut Session) -> (usize, Vec<String>) {
    let scene = session.runs.first().scene().name.clone();
    let mut changing = vec![];
    frames(session, 0.1);
    let count = session.tuning.parts.len();
    for k in 0..count {
        let name = session.tuning.parts[k].name.clone();
        let (was_in, now) = (is_in(session, k), moment(session));
        let (steps, before) = (session.runs.first().steps(), forces(session, &now));
        if let Err(why) = set_part(session, k, !was_in) {
            assert_eq!(is_in(session, k), was_in, "{name} of {scene}: {why}");
            assert!(why.ends_with('.') || why.contains(':'), "{why}");
            continue;
        }
        assert_eq!(moment(session), now, "{name} of {scene}");
        assert_eq!(session.runs.first().steps(), steps);
        if forces(session, &now) != before {
            changing.push(name.clone());
        }
        frames(session, 0.05);
        let run = session.runs.first();
        assert!(run.state().iter().all(|y| y.is_finite()), "{name} of {scene}");
        if run.blow_up().is_some() {
            session.act(RunAction::Reset, 0);
        } else {
            assert!(run.time() > now.0 && run.steps() > steps, "{name} of {scene}");
        }
        let mut then = moment(session);
        // Surfaces that crossed meanwhile cannot begin to touch.
        if let Err(why) = set_part(session, k, was_in) {
            assert!(why.contains("cross"), "{name} of {scene}: {why}");
            session.act(RunAction::Reset, 0);
            set_part(session, k, was_in).unwrap();
            then = moment(session);
        }
        assert_eq!(moment(session), then, "{name} of {scene}");
        assert!(forces(session, &now) == before, "{name} of {scene}");
        frames(session, 0.05);
        assert!(session.runs.first().blow_up().is_none(), "{name} of {scene}");
    }
    (count, changing)
}

#[test]
fn every_part_of_every_scene_comes_and_goes() {
    let (mut count, mut changing) = (0, std::collections::BTreeSet::new());
    for mut session in every_scene() {
        let (parts, names) = every_part_comes_and_goes(&mut session);
        count += parts;
        changing.extend(names);
    }
    assert!(count > 60, "{count}");
    for name in ["gravity", "drag", "bend springs", "wind", "viscosity"] {
        assert!(changing.contains(name), "{name} is not in {changing:?}");
    }
}

/// Scenes of lists, meshes, solids, beads on wires, and several obstacles.
#[test]
fn parts_of_scene_files_come_and_go() {
    let docs = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes/");
    let mut count = 0;
    for file in ["funnel", "tear", "pile", "beads", "mobile", "turning", "drawn"] {
        let file = format!("{docs}{file}.toml");
        let mut session = opened(&["t", "0.001", "--scene", &file]);
        count += every_part_comes_and_goes(&mut session).0;
    }
    assert!(count > 25, "{count}");
}

/// The first of two spheres leaves: the second, which was pushed, keeps its path, and the radius to
/// which both are tuned comes back.
#[test]
fn obstacles_keep_their_paths_when_others_leave() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("two.toml");
    let text = a3_scenes::find("mit-sphere").unwrap().text;
    let second = "\n[[sphere]]\ncenter = [3, -2, 0]\nradius = 0.5\n";
    std::fs::write(&file, format!("{text}{second}")).unwrap();
    let mut session = opened(&["r", "0.005", "--scene", file.to_str().unwrap()]);
    apply(&mut session, PanelRequest::Turn(row_of("sphere"), Turn::To(0.8)), 0);
    let tuned_before = tuned(&session);
    let spheres = |session: &Session| {
        let network = network(session);
        let spheres = network.obstacles().iter().filter(|o| o.shape != Shape::Floor);
        let time = session.runs.first().time();
        spheres.map(|o| (o.shape.clone(), o.path.at(time).position)).collect::<Vec<_>>()
    };
    let place = Vector3::new(3.0, -2.0, 0.0);
    assert!(session.runs.grab_obstacle(1));
    session.runs.pull(place + Vector3::new(0.3, 0.0, 0.0));
    frames(&mut session, 0.5);
    session.release();
    let before = spheres(&session);
    assert!((before[1].1 - place).norm() > 0.1);
    toggle(&mut session, "sphere 1");
    assert_eq!(spheres(&session), before[1..]);
    toggle(&mut session, "sphere 1");
    assert_eq!(spheres(&session), before);
    assert_eq!(tuned(&session), tuned_before);
    // The push is undone after the parts, in their order.
    for _ in 0..3 {
        undo(&mut session, false);
    }
    assert!((spheres(&session)[1].1 - place).norm() < 1e-9);
}

/// Pins, a pulled particle and tuned values stay; a value of a part that is left out comes back
/// with it.
#[test]
fn pins_hands_and_tuning_stay() {
    let mut session = opened(&["r", "0.005", "--scene", "mit-sphere", "--wind"]);
    frames(&mut session, 0.2);
    session.pin_all(&[200], true);
    assert!(session.runs.grab(210));
    session.runs.pull(Vector3::new(0.5, 0.5, 0.5));
    for (name, value) in [("gravity", 5.0), ("stiffness", 2.0), ("gusts", 1.5)] {
        apply(&mut session, PanelRequest::Turn(row_of(name), Turn::To(value)), 0);
    }
    frames(&mut session, 0.1);
    let (now, before) = (moment(&session), tuned(&session));
    let forced = forces(&session, &now);
    toggle(&mut session, "gravity");
    assert_eq!(network(&session).gravity(), None);
    let run = session.runs.first();
    assert_eq!((run.grabbed(), run.windy()), (Some(210), true));
    assert!(network(&session).is_pinned(200));
    assert!(session.readings.left_out == ["gravity"]);
    // The knob of gravity stays in its row, and does nothing.
    let row = rows(&session).into_iter().find(|row| row.1.name == "gravity");
    assert_eq!(row.unwrap().2.words, "left out");
    apply(&mut session, PanelRequest::Turn(row_of("gravity"), Turn::To(9.0)), 0);
    assert_eq!(network(&session).gravity(), None);
    let said = session.readings.message.clone().unwrap();
    assert!(said.starts_with("Gravity is left out"), "{said}");
    toggle(&mut session, "gravity");
    assert_eq!(tuned(&session), before);
    assert!(forces(&session, &now) == forced);
    session.release();
    frames(&mut session, 0.1);
    assert!(session.runs.first().blow_up().is_none());
}

/// The switch of a part and the key of the same thing agree.
#[test]
fn switches_agree_with_keys_and_knobs() {
    let mut session = opened(&["r", "0.005", "--scene", "mit-sphere"]);
    for (name, action) in [("wind", RunAction::Wind), ("self-collision", RunAction::Touch)] {
        let k = part(&session, name);
        assert!(!is_in(&session, k), "{name}");
        session.act(action, 0);
        assert!(is_in(&session, k), "{name}");
        toggle(&mut session, name);
        let run = session.runs.first();
        let on = if name == "wind" { run.windy() } else { run.touching() };
        assert!(!on && !is_in(&session, k), "{name}");
    }
    toggle(&mut session, "floor");
    let floors = network(&session).obstacles().iter();
    assert_eq!(floors.filter(|o| o.shape == Shape::Floor).count(), 0);
    assert_eq!(tuned(&session), [("floor".to_owned(), 0.0)]);
}

#[test]
fn keys_and_mouse_leave_out_a_part_and_undo_brings_it_back() {
    let mut session = opened(&["r", "0.005", "--scene", "cloth"]);
    frames(&mut session, 0.1);
    let drag = part(&session, "drag");
    session.panel.row = part_row(drag);
    type_key(&mut session, PanelKey::Left, false);
    assert_eq!(session.tuning.left_out, [drag]);
    assert_eq!(network(&session).drag(), None);
    type_key(&mut session, PanelKey::Left, false);
    type_key(&mut session, PanelKey::Right, false);
    assert!(session.tuning.left_out.is_empty());
    let mut screen = Screen::new([1280.0, 720.0]);
    let place = |screen: &mut Screen, session: &Session, name: &str| {
        let texts = screen.read(session);
        let (_, rect) = texts.into_iter().find(|(words, _)| words == name).unwrap();
        rect
    };
    let at = place(&mut screen, &session, "shear springs").left_center();
    let switch = at - vec2(30.0, -7.0);
    screen.click(&mut session, switch, switch);
    assert_eq!(session.readings.left_out, ["shear springs"]);
    for (redo, left_out) in [(false, 0), (true, 1), (false, 0), (false, 1), (false, 0)] {
        undo(&mut session, redo);
        assert_eq!(session.tuning.left_out.len(), left_out);
    }
    // The titles change between the pages.
    let tuning = place(&mut screen, &session, "Tuning").center();
    screen.click(&mut session, tuning, tuning);
    assert_eq!(session.panel.row, 0);
    let parts = place(&mut screen, &session, "Parts").center();
    screen.click(&mut session, parts, parts);
    assert_eq!(session.panel.row, part_row(0));
}

/// All panes and the reference lose the part at the same time.
#[test]
fn a_part_leaves_every_pane() {
    let mut session = compared(&["r:0.013", "r:0.005", "--scene", "cloth"], 0.3);
    session.act(RunAction::Panel, 0);
    for name in ["gravity", "bend springs"] {
        toggle(&mut session, name);
        frames(&mut session, 0.3);
    }
    toggle(&mut session, "gravity");
    frames(&mut session, 0.3);
    for pane in &session.runs.panes {
        assert!(pane.simulation.blow_up().is_none());
        assert!(pane.error.unwrap() < 2e-3, "{:?}", pane.error);
    }
}

#[test]
fn a_run_that_blew_up_keeps_its_parts() {
    let mut session = opened(&["r", "0.05", "--scene", "mit"]);
    while session.runs.panes[0].alive() {
        session.tick(1.0 / 60.0);
    }
    toggle(&mut session, "gravity");
    let said = session.readings.message.clone().unwrap();
    assert!(said.starts_with("A run has blown up"), "{said}");
    assert!(session.tuning.left_out.is_empty());
}
