//! Measuring the parts of a scene, and their rows.

use super::screen::{Screen, opened, part, toggle, type_key};
use crate::hud::panel::PANE;
use crate::session::panel::{measuring_row, numbers, part_row, row_of, set_part, update};
use crate::session::{Deviation, Effect, PanelKey, PanelRequest, RunAction, Session, Turn};
use crate::session::{apply, frames};

/// Waits until all parts are measured.
fn wait(session: &mut Session) {
    let begun = std::time::Instant::now();
    while session.effects.progress().is_some() {
        std::thread::sleep(std::time::Duration::from_millis(20));
        assert!(begun.elapsed().as_secs() < 300);
        update(session);
    }
}

#[test]
fn parts_are_measured_until_the_scene_changes() {
    let mut session = opened(&["r", "0.005", "--scene", "mit"]);
    frames(&mut session, 0.2);
    session.panel.row = measuring_row();
    type_key(&mut session, PanelKey::Toggle, false);
    assert!(session.effects.progress().is_some());
    wait(&mut session);
    let effect = |session: &Session, name: &str| session.effects.of(part(session, name)).unwrap();
    let [gravity, contact] = ["gravity", "self-collision"].map(|name| effect(&session, name));
    let change = gravity.change.unwrap();
    // In a time t of at most 2 s, without pins, g t2 / 2 would be 4.9 t2 m.
    assert!(change.distance > 0.05 && change.distance < 4.9 * change.time.powi(2));
    assert!(change.error < 0.01 * change.distance, "{change:?}");
    // Self-collision is off, and measured by turning it on.
    let cost = contact.cost.unwrap();
    assert!((0.05..0.95).contains(&cost), "{contact:?}");
    assert!(gravity.cost.unwrap().abs() < 0.3, "{gravity:?}");
    // The run goes on, and the values stay.
    frames(&mut session, 0.1);
    update(&mut session);
    assert!(session.effects.time().is_some());
    // They are measured again without a part, whose effect is the same from the same state.
    toggle(&mut session, "bend springs");
    assert!(session.effects.progress().is_some());
    wait(&mut session);
    let back = effect(&session, "bend springs");
    assert!(
        back.cost.is_some() && back.change.unwrap().distance > 0.01,
        "{back:?}"
    );
    apply(
        &mut session,
        PanelRequest::Turn(row_of("stiffness"), Turn::To(2.0)),
        0,
    );
    update(&mut session);
    assert_eq!(session.effects.time(), None);
    for action in [RunAction::Reset, RunAction::NextScene] {
        type_key(&mut session, PanelKey::Toggle, false);
        apply(
            &mut session,
            PanelRequest::Turn(measuring_row(), Turn::Toggle),
            0,
        );
        session.act(action, 0);
        update(&mut session);
        assert_eq!(session.effects.progress(), None);
        assert!(session.effects.of(0).is_none());
    }
}

/// The rows say what was measured, at any width of the panel, and nothing is cut off.
#[test]
fn rows_of_parts_fit() {
    let mut session = opened(&["r", "0.005", "--scene", "ball-on-cloth"]);
    session.panel.row = measuring_row();
    let worst = Effect {
        cost: Some(-0.87),
        change: Some(Deviation {
            distance: 0.123,
            error: 0.0,
            time: 0.15,
        }),
    };
    session
        .effects
        .show(&vec![worst; session.tuning.parts.len()]);
    for row in numbers(&session) {
        let all: Vec<_> = (0..session.tuning.parts.len()).collect();
        let k = row.checked_sub(part_row(0));
        if let Some(k) = k.filter(|k| all.contains(k)) {
            let _ = set_part(&mut session, k, false);
        }
    }
    for size in [
        [1280.0, 720.0],
        [800.0, 600.0],
        [2300.0, 1200.0],
        [500.0, 200.0],
    ] {
        let mut screen = Screen::new(size);
        let texts = screen.written(&session);
        let edge = size[0] - PANE.taken(size)[0];
        let panel = texts.iter().filter(|(_, rect, _)| rect.left() > edge);
        for (words, rect, seen) in panel.clone() {
            // In a low window, rows scroll.
            let across = seen.x_range();
            assert!(
                across.contains(rect.left()) && across.contains(rect.right()),
                "{words} in {size:?}"
            );
            assert!(rect.right() < size[0] - 8.0, "{words} in {size:?}");
        }
        let said = |what: &str| panel.clone().any(|(words, ..)| words.contains(what));
        assert!(
            said("measure") && said("of the work, 12 cm in 0.15 s"),
            "{size:?}"
        );
    }
}
