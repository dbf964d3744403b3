//! Drawing of the panel, and turning its rows with the mouse.

use egui::vec2;

use super::screen::{Screen, changed, dials, every_scene, opened};
use crate::hud::panel::PANE;
use crate::session::panel::{rows, undo};
use crate::session::{DialScale, RunAction};

const SIZES: [[f32; 2]; 2] = [[1280.0, 720.0], [800.0, 600.0]];

#[test]
fn the_mouse_turns_every_row_and_only_that() {
    for mut session in every_scene() {
        let name = session.runs.first().scene().name.clone();
        let mut screen = Screen::new(SIZES[0]);
        for (k, knob, dial) in rows(&session) {
            let before = dials(&session);
            let (value, [low, high]) = screen.place(&session, knob.name);
            match dial.scale {
                DialScale::Switch => screen.click(&mut session, low, low),
                DialScale::Choice(_) => screen.click(&mut session, value, value),
                _ => {
                    screen.click(&mut session, low, low + vec2(80.0, 0.0));
                    let now = (knob.read)(&session, 0).unwrap();
                    let share = now.scale.share(now.value);
                    let expected = f64::from(80.0 / (high.x - low.x));
                    // The drag starts at the middle of the thumb, and values are rounded.
                    assert!((share - expected).abs() < 0.3, "{} of {name}: {share}", knob.name);
                }
            }
            let mut now = changed(&before, &session);
            now.retain(|other| knob.name != "solver" || *other != "step");
            now.retain(|other| knob.name != "material" || *other == "material");
            assert_eq!(now, [knob.name], "of {name}");
            if knob.name == "material" {
                undo(&mut session, false);
            }
            assert_eq!(session.panel.row, k);
            // A double click on the value restores the scene's own.
            if !matches!(dial.scale, DialScale::Choice(_)) {
                screen.window.time += 1.0;
                screen.click(&mut session, value, value);
                screen.click(&mut session, value, value);
                let now = (knob.read)(&session, 0).unwrap();
                assert_eq!(now.value, now.own, "{} of {name}", knob.name);
            }
        }
    }
}

/// The panel has all its plots, beside one pane and beside four.
#[test]
fn nothing_is_cut_off_or_overlaps() {
    let compared = |scene| opened(&["compare", "e:0.0005", "x", "b", "n", "--scene", scene]);
    let several = ["mit-sphere", "simple"].map(compared);
    let mut screens = SIZES.map(Screen::new);
    for mut session in every_scene().chain(several) {
        let name = session.runs.first().scene().name.clone();
        for k in 1..=4 {
            session.run_to(0.1 * f64::from(k));
        }
        for screen in &mut screens {
            let size = screen.size;
            let texts = screen.read(&session);
            let edge = size[0] - PANE.taken(size)[0];
            for (k, (words, rect)) in texts.iter().enumerate() {
                let inside = rect.left() > edge + 4.0 && rect.right() < size[0] - 4.0;
                assert!(inside || rect.right() < edge, "{words} in {name}, {size:?}");
                for (others, other) in &texts[..k] {
                    let apart = !rect.shrink(1.0).intersects(other.shrink(1.0));
                    assert!(apart, "{words} over {others} in {name}, {size:?}");
                }
            }
            let said = |what: &str| texts.iter().any(|(words, _)| words == what);
            for (_, knob, dial) in rows(&session) {
                assert!(said(knob.name) && said(&dial.words), "{}", knob.name);
            }
            assert!(said("scene") && said("plots") && said("film") && said("last 5 s"));
            let plotted = name != "simple" && size[1] > 700.0;
            assert!(said("energy (J)") || !plotted, "{texts:?}");
        }
    }
}

/// The chosen row is visible in a low window.
#[test]
fn the_chosen_row_is_visible() {
    let mut session = opened(&["r", "0.005"]);
    let mut screen = Screen::new([500.0, 200.0]);
    for (k, knob, _) in rows(&session) {
        session.panel.row = k;
        let texts = screen.written(&session);
        assert!(
            texts.iter().any(|(words, rect, seen)| words == knob.name && seen.contains_rect(*rect)),
            "{}",
            knob.name
        );
    }
}

#[test]
fn the_help_hides_the_panel() {
    let mut session = opened(&["r", "0.005"]);
    assert!(session.shows(RunAction::Panel));
    assert_eq!(PANE.taken([1280.0, 720.0]), [304.0, 0.0]);
    session.act(RunAction::Help, 0);
    assert!(!session.shows(RunAction::Panel));
    assert!(!Screen::new(SIZES[0]).read(&session).iter().any(|(words, _)| words == "Tuning"));
}
