//! Turning knobs by keys and typed numbers, with undo and redo.

use a3_core::contact::Shape;
use a3_core::{Control, Network, Path, Vector3};
use a3_scenes::MATERIALS;

use super::screen::{Screen, changed, dials, every_scene, opened, type_key};
use crate::session::panel::{KNOBS, numbers, row_of, rows, undo};
use crate::session::{PanelKey, PanelRequest, RunAction, Session, TextKey, Turn};
use crate::session::{action_beside, apply, compared, frames, is_typing};

#[test]
fn keys_reach_every_row_and_turn_only_that() {
    for mut session in every_scene() {
        let name = session.runs.first().scene().name.clone();
        let count = dials(&session).len();
        for (k, (row, value)) in dials(&session).into_iter().enumerate() {
            let before = dials(&session);
            type_key(&mut session, PanelKey::Right, false);
            let mut now = changed(&before, &session);
            if now.is_empty() {
                // The value was at the end of its scale.
                type_key(&mut session, PanelKey::Left, false);
                now = changed(&before, &session);
            }
            // Another solver may take a tolerance instead of a step.
            now.retain(|other| row != "solver" || *other != "step");
            // Another material is another scene.
            now.retain(|other| row != "material" || *other == "material");
            assert_eq!(now, [row], "row {k} of {name}");
            if row == "material" {
                undo(&mut session, false);
            }
            type_key(&mut session, PanelKey::Toggle, false);
            let back = dials(&session)[k].1;
            let own = rows(&session)[k].2.own;
            assert!(back == value || back == own, "{row} of {name}: {back}");
            type_key(&mut session, PanelKey::Down, false);
        }
        // The parts of the scene follow, then it goes round.
        let all = numbers(&session);
        assert_eq!(all.len(), count + session.tuning.parts.len(), "{name}");
        for row in all[count..].iter().chain(&all[..1]) {
            assert_eq!(session.panel.row, *row, "in {name}");
            type_key(&mut session, PanelKey::Down, false);
        }
        // Up from the first row, to the last of its page.
        for row in [all[0], all[count - 1]] {
            type_key(&mut session, PanelKey::Up, false);
            assert_eq!(session.panel.row, row, "in {name}");
        }
        // A closed panel ignores keys.
        session.act(RunAction::Panel, 0);
        assert_eq!(action_beside(&session, PanelKey::Up, false), None);
    }
}

/// A turned knob changes the forces; turned back, they are the same to the bit.
#[test]
fn a_turn_changes_forces_and_turning_back_restores_them() {
    let forces = |session: &Session| {
        let run = session.runs.first();
        let mut f = vec![0.0; run.state().len()];
        run.model().system().eval_f(run.time(), run.state(), &mut f);
        f
    };
    let mut session = opened(&["r", "0.005", "--scene", "mit-sphere", "--wind"]);
    session.tick(0.1);
    let turn = |session: &mut Session, name: &str, turn| {
        let k = KNOBS.iter().position(|knob| knob.name == name).unwrap();
        apply(session, PanelRequest::Turn(k, turn), 0);
    };
    let before = forces(&session);
    for (name, value) in [("stiffness", 3.0), ("drag", 0.15), ("gravity", 3.7), ("gusts", 2.5)] {
        turn(&mut session, name, Turn::To(value));
        assert_ne!(forces(&session), before, "{name}");
        // A reset keeps the tuning.
        session.act(RunAction::Reset, 0);
        let k = KNOBS.iter().find(|knob| knob.name == name).unwrap();
        assert_eq!((k.read)(&session, 0).unwrap().value, value);
        for _ in 0..6 {
            session.tick(1.0 / 60.0);
        }
        turn(&mut session, name, Turn::Own);
        session.act(RunAction::Reset, 0);
        session.tick(0.1);
        assert_eq!(forces(&session), before, "{name}");
    }
    let mut damped = opened(&["r", "0.005"]);
    damped.tick(0.1);
    let before = forces(&damped);
    turn(&mut damped, "damping", Turn::To(0.0));
    assert_ne!(forces(&damped), before);
    turn(&mut damped, "damping", Turn::Own);
    assert_eq!(forces(&damped), before);
    let network = |session: &Session| session.runs.first().model().network().unwrap().clone();
    turn(&mut damped, "strain limit", Turn::To(1.2));
    assert_eq!(network(&damped).strain_limits(), [(0..400, 1.2)]);
    turn(&mut damped, "strain limit", Turn::Own);
    assert!(network(&damped).strain_limits().is_empty());
    turn(&mut session, "sphere", Turn::To(0.75));
    let shapes = |session: &Session| {
        let network = network(session);
        let obstacles = network.obstacles().iter();
        obstacles.map(|o| (o.shape.clone(), o.path)).collect::<Vec<_>>()
    };
    let own = shapes(&session);
    assert_eq!(own[0].0, Shape::Sphere { radius: 0.75 });
    turn(&mut session, "floor", Turn::Toggle);
    assert_eq!(shapes(&session), own[..1]);
    turn(&mut session, "floor", Turn::Toggle);
    assert_eq!(shapes(&session), own);
    let floor = Path::Still(Vector3::new(0.0, -5.0, 0.0));
    assert_eq!(own[1], (Shape::Floor, floor));
    turn(&mut session, "pins", Turn::Toggle);
    assert_eq!(network(&session).pins().count(), 0);
    turn(&mut session, "springs of", Turn::To(7.0));
    assert_eq!(session.runs.panes[0].show.springs_of, Some(7));
}

#[test]
fn another_scene_is_not_tuned() {
    let mut session = opened(&["r", "0.005"]);
    for k in 2..=5 {
        apply(&mut session, PanelRequest::Turn(k, Turn::By { up: true, other: false }), 0);
    }
    session.act(RunAction::NextScene, 0);
    session.act(RunAction::NextScene, 0);
    for (_, knob, dial) in rows(&session).iter().skip(2) {
        assert_eq!(dial.value, dial.own, "{}", knob.name);
    }
}

#[test]
fn the_limit_follows_the_stiffness() {
    let mut session = opened(&["r", "0.005", "--scene", "mit", "--paused"]);
    session.read_state();
    let limit = |session: &Session| session.runs.panes[0].limit.limit.unwrap().step;
    let before = limit(&session);
    let k = KNOBS.iter().position(|k| k.name == "stiffness").unwrap();
    apply(&mut session, PanelRequest::Turn(k, Turn::To(4.0)), 0);
    session.read_state();
    let after = limit(&session);
    assert!((before / after - 2.0).abs() < 0.05, "{before} {after}");
}

#[test]
fn every_pane_and_the_reference_are_tuned_alike() {
    let mut session = compared(&["r:0.005", "v:0.005", "--scene", "pendulum"], 0.3);
    session.act(RunAction::Panel, 0);
    for (name, value) in [("stiffness", 2.0), ("gravity", 20.0), ("drag", 0.02)] {
        let k = KNOBS.iter().position(|k| k.name == name).unwrap();
        apply(&mut session, PanelRequest::Turn(k, Turn::To(value)), 0);
    }
    for _ in 0..60 {
        session.tick(1.0 / 60.0);
    }
    for pane in &session.runs.panes {
        let error = pane.error.unwrap();
        assert!(error < 1e-3, "{error}");
    }
    // The step belongs to one pane.
    session.panel.pane = 1;
    apply(&mut session, PanelRequest::Turn(1, Turn::To(0.002)), 0);
    assert_eq!(session.runs.first().control(), Control::Step(0.005));
    assert_eq!(session.runs.panes[1].simulation.control(), Control::Step(0.002));
}

#[test]
fn turning_goes_by_steps_within_the_scale() {
    let mut session = opened(&["r", "0.01", "--scene", "cloth"]);
    let value = |session: &Session, name: &str| {
        let all = dials(session);
        all.iter().find(|(n, _)| *n == name).unwrap().1
    };
    let mut go = |name: &str, key, shift, times: usize| {
        session.panel.row = KNOBS.iter().position(|k| k.name == name).unwrap();
        for _ in 0..times {
            type_key(&mut session, key, shift);
        }
        value(&session, name)
    };
    let (left, right) = (PanelKey::Left, PanelKey::Right);
    assert_eq!(go("step", right, false, 1), 0.0126);
    assert_eq!(go("step", left, false, 1), 0.01);
    assert_eq!(go("step", right, true, 1), 0.0102);
    assert_eq!(go("stiffness", right, false, 3), 2.0);
    assert_eq!(go("stiffness", right, false, 30), 10.0);
    assert_eq!(go("stiffness", left, false, 40), 0.1);
    assert_eq!(go("stiffness", right, false, 10), 1.0);
    assert_eq!(go("stiffness", right, true, 10), 1.26);
    assert_eq!(go("gravity", right, false, 1), 10.0);
    assert_eq!(go("gravity", left, true, 3), 9.85);
    assert_eq!(go("gravity", left, false, 50), 0.0);
    assert_eq!(go("damping", left, false, 9), 0.0);
    assert_eq!(go("springs of", right, true, 2), 19.0);
    assert_eq!(go("springs of", left, false, 1), 18.0);
}

#[test]
fn values_are_typed() {
    let mut session = opened(&["r", "0.005"]);
    let mut screen = Screen::new([1280.0, 720.0]);
    let mut type_value = |session: &mut Session, name: &str, words: &str| {
        let (value, _) = screen.place(session, name);
        screen.window.time += 1.0;
        screen.click(session, value, value);
        assert_eq!(session.panel.typed.as_deref(), Some(""));
        // Ctrl+A marks what was typed, and the next letter replaces it.
        for key in [TextKey::Type('7'), TextKey::Type('7'), TextKey::MarkAll] {
            apply(session, key, 0);
        }
        for letter in words.chars() {
            apply(session, TextKey::Type(letter), 0);
        }
        apply(session, TextKey::Accept, 0);
        let typing = is_typing(session);
        apply(session, TextKey::Cancel, 0);
        assert!(!is_typing(session));
        typing
    };
    assert!(type_value(&mut session, "gravity", "1.51.65"));
    let said = session.readings.message.take().unwrap();
    assert!(said.contains("Gravity: must be a number"), "{said}");
    assert!(!type_value(&mut session, "gravity", "3.21"));
    let gravity = session.runs.first().model().network().and_then(Network::gravity);
    assert_eq!(gravity.unwrap().y, -3.21);
    assert!(!type_value(&mut session, "step", "1/120"));
    assert_eq!(session.runs.first().control(), Control::Step(1.0 / 120.0));
    // Invalid values are refused, and can be corrected.
    for (words, why) in [
        ("1,5", "Stiffness: use a decimal point: 1.5."),
        ("much", "Stiffness: must be a number from 0.1 to 10."),
        ("11", "Stiffness: must be a number from 0.1 to 10."),
        ("", "Stiffness: must be a number from 0.1 to 10."),
        ("nan", "Stiffness: must be a number from 0.1 to 10."),
    ] {
        assert!(type_value(&mut session, "stiffness", words), "{words}");
        assert_eq!(session.readings.message.as_deref(), Some(why));
        assert_eq!(session.tuning.stiffness, 1.0);
    }
}

#[test]
fn turns_are_undone_and_redone() {
    for mut session in every_scene() {
        let name = session.runs.first().scene().name.clone();
        for (row, _, dial) in rows(&session) {
            // Another solver may take a tolerance instead of a step, and does not restore it.
            if ["solver", "step"].contains(&KNOBS[row].name) {
                continue;
            }
            let before = dials(&session);
            let there = |session: &Session| (KNOBS[row].read)(session, 0).map(|dial| dial.value);
            apply(&mut session, PanelRequest::Turn(row, Turn::By { up: true, other: false }), 0);
            let turned = there(&session);
            if turned == Some(dial.value) {
                continue;
            }
            undo(&mut session, false);
            assert_eq!(there(&session), Some(dial.value), "{} of {name}", KNOBS[row].name);
            let mut others = changed(&before, &session);
            // A step that was shortened for a material stays so.
            others.retain(|other| KNOBS[row].name != "material" || *other != "step");
            assert_eq!(others, [""; 0], "{name}");
            undo(&mut session, true);
            assert_eq!(there(&session), turned, "{} of {name}", KNOBS[row].name);
            undo(&mut session, false);
        }
    }
}

/// A liquid has a stiffness and a viscosity, but no springs to list.
#[test]
fn a_liquid_has_no_row_of_springs() {
    let names = |scene: &str| {
        let session = opened(&["--scene", scene]);
        rows(&session).iter().map(|row| row.1.name).collect::<Vec<_>>()
    };
    let [liquid, cloth] = ["dam-break", "cloth"].map(names);
    assert!(liquid.contains(&"stiffness") && !liquid.contains(&"springs of"));
    assert!(cloth.contains(&"springs of"));
}

/// Bodies become of a material while the motion goes on, and get their own keys back.
#[test]
fn a_material_is_chosen_and_undone() {
    let mut session = opened(&["t", "0.01", "--scene", "cloth"]);
    let own = session.scenes.shown.source.description.clone();
    frames(&mut session, 0.2);
    let time = session.runs.first().time();
    let row = row_of("material");
    let dial = |session: &Session| (KNOBS[row].read)(session, 0).unwrap();
    assert_eq!(dial(&session).words, "own");
    let denim = MATERIALS.iter().position(|it| it.name == "denim").unwrap();
    apply(&mut session, PanelRequest::Turn(row, Turn::Exactly(denim as f64)), 0);
    let said = session.readings.message.take().unwrap();
    assert!(
        said.starts_with("Denim: jeans of 11 oz. ") && said.contains("would not hold"),
        "{said}"
    );
    assert_eq!(dial(&session).words, "denim");
    let cloth = &session.scenes.shown.source.description.cloth[0];
    assert_eq!((cloth.density, cloth.stiffness[0]), (Some(0.324), 610.0));
    assert!(session.runs.first().time() >= time);
    frames(&mut session, 0.2);
    assert!(session.runs.any_alive());
    undo(&mut session, false);
    assert!(session.scenes.shown.source.description == own, "{:?}", session.readings.message);
    assert_eq!(dial(&session).words, "own");
}
