use egui::{Context, Event, PointerButton, Pos2, RawInput, Rect, Shape, pos2, vec2};

use a3_core::Control;

use super::knobs::{KNOBS, Scale, Turn};
use super::request::{PanelKey, Request, apply, press, rows};
use super::view::{MARGIN, WIDTH, inset, leaves, show, width};
use crate::hud;
use crate::session::fixtures::{compared, session};
use crate::session::{Action, Session};

const SIZES: [[f32; 2]; 2] = [[1280.0, 720.0], [800.0, 600.0]];

fn opened(words: &[&str]) -> Session {
    let mut session = session(words);
    session.act(Action::Panel, 0);
    session
}

/// Every scene of the table, in a window with its panel.
fn every_scene() -> impl Iterator<Item = Session> {
    let names = a3_scenes::SCENES.iter().map(|entry| entry.name);
    names.map(|name| opened(&["r", "0.005", "--scene", name]))
}

fn type_key(session: &mut Session, key: PanelKey, shift: bool) {
    assert!(press(session, key, shift), "{key:?}");
}

/// What all rows say.
fn dials(session: &Session) -> Vec<(&'static str, f64)> {
    let rows = rows(session).into_iter();
    rows.map(|(_, knob, dial)| (knob.name, dial.value))
        .collect()
}

/// Those that differ.
fn changed(before: &[(&'static str, f64)], session: &Session) -> Vec<&'static str> {
    let after = dials(session);
    assert_eq!(before.len(), after.len());
    let pairs = before.iter().zip(after);
    pairs.filter(|(a, b)| **a != *b).map(|(a, _)| a.0).collect()
}

/// A window, as egui sees it.
struct Screen {
    ctx: Context,
    size: [f32; 2],
    time: f64,
}

impl Screen {
    fn new(size: [f32; 2]) -> Self {
        Self {
            ctx: Context::default(),
            size,
            time: 0.0,
        }
    }

    /// A frame: what was drawn, and what the hand in the panel wants.
    fn frame(
        &mut self,
        session: &Session,
        events: Vec<Event>,
    ) -> (egui::FullOutput, Option<Request>) {
        self.time += 0.05;
        let px = self.size.map(|side| side as u32);
        let right = inset(session, px.into(), 1.0);
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, self.size.into())),
            safe_area_insets: Some(egui::SafeAreaInsets(egui::epaint::MarginF32 {
                right,
                ..Default::default()
            })),
            time: Some(self.time),
            events,
            ..Default::default()
        };
        let mut request = None;
        let mut output = self.ctx.run_ui(input, |ui| {
            hud::show(ui.ctx(), &session.panes, &session.readings);
            request = show(ui.ctx(), session).or(request);
        });
        output.textures_delta.set.clear();
        output.textures_delta.free.clear();
        (output, request)
    }

    /// All that is written, where, and what is seen of it.
    fn written(&mut self, session: &Session) -> Vec<(String, Rect, Rect)> {
        self.frame(session, vec![]);
        self.time += 10.0;
        let (output, _) = self.frame(session, vec![]);
        let screen = Rect::from_min_size(Pos2::ZERO, self.size.into());
        let text = |clipped: &egui::epaint::ClippedShape| match &clipped.shape {
            Shape::Text(text) => Some((
                text.galley.text().to_owned(),
                text.visual_bounding_rect(),
                clipped.clip_rect.intersect(screen).expand(1.0),
            )),
            _ => None,
        };
        output.shapes.iter().filter_map(text).collect()
    }

    /// All that is written, and where. Nothing may be cut off.
    fn read(&mut self, session: &Session) -> Vec<(String, Rect)> {
        let all = self.written(session).into_iter();
        all.map(|(words, rect, seen)| {
            assert!(seen.contains_rect(rect), "{words} is cut off at {rect:?}");
            (words, rect)
        })
        .collect()
    }

    /// Presses and lets go of the left button at one place, or from one to another: what that does to the session.
    fn click(&mut self, session: &mut Session, from: Pos2, to: Pos2) {
        let button = |pos, pressed| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::default(),
        };
        for event in [
            vec![Event::PointerMoved(from)],
            vec![button(from, true)],
            vec![Event::PointerMoved(to)],
            vec![button(to, false)],
            vec![],
        ] {
            if let (_, Some(request)) = self.frame(session, event) {
                apply(session, request);
            }
        }
    }

    /// Where a row's value is, and its slider's ends.
    fn place(&mut self, session: &Session, name: &str) -> (Pos2, [Pos2; 2]) {
        let texts = self.read(session);
        let left = self.size[0] - width(self.size[0]);
        let (_, row) = texts
            .iter()
            .find(|(words, rect)| words == name && rect.left() > left)
            .unwrap();
        let y = row.center().y;
        let at = |x: f32| pos2(left + MARGIN + x, y);
        (at(WIDTH - 2.0 * MARGIN - 10.0), [at(82.0), at(190.0)])
    }
}

#[test]
fn keys_reach_every_row_and_turn_that_only() {
    for mut session in every_scene() {
        let name = session.first().scene().name.clone();
        let count = dials(&session).len();
        for (k, (row, value)) in dials(&session).into_iter().enumerate() {
            let before = dials(&session);
            type_key(&mut session, PanelKey::Right, false);
            let mut now = changed(&before, &session);
            if now.is_empty() {
                // It was at its end.
                type_key(&mut session, PanelKey::Left, false);
                now = changed(&before, &session);
            }
            // Another solver may take a tolerance.
            now.retain(|other| row != "solver" || *other != "step");
            assert_eq!(now, [row], "row {k} of {name}");
            type_key(&mut session, PanelKey::Toggle, false);
            let back = dials(&session)[k].1;
            let own = rows(&session)[k].2.own;
            assert!(back == value || back == own, "{row} of {name}: {back}");
            type_key(&mut session, PanelKey::Down, false);
        }
        assert_eq!(
            rows(&session)[0].0,
            session.panel.row,
            "it goes round, after {count}"
        );
        type_key(&mut session, PanelKey::Up, false);
        assert_eq!(rows(&session)[count - 1].0, session.panel.row);
        // A closed panel takes no keys.
        session.act(Action::Panel, 0);
        assert!(!press(&mut session, PanelKey::Up, false));
    }
}

#[test]
fn the_mouse_turns_every_row_and_that_only() {
    for mut session in every_scene() {
        let name = session.first().scene().name.clone();
        let mut screen = Screen::new(SIZES[0]);
        for (k, knob, dial) in rows(&session) {
            let before = dials(&session);
            let (value, [low, high]) = screen.place(&session, knob.name);
            match dial.scale {
                Scale::Switch => screen.click(&mut session, low, low),
                Scale::Choice(_) => screen.click(&mut session, value, value),
                _ => {
                    screen.click(&mut session, low, low + vec2(80.0, 0.0));
                    let now = (knob.read)(&session, 0).unwrap();
                    let share = now.scale.share(now.value);
                    let expected = f64::from(80.0 / (high.x - low.x));
                    // From the middle of the thumb, and to a whole number.
                    assert!(
                        (share - expected).abs() < 0.3,
                        "{} of {name}: {share}",
                        knob.name
                    );
                }
            }
            let mut now = changed(&before, &session);
            now.retain(|other| knob.name != "solver" || *other != "step");
            assert_eq!(now, [knob.name], "of {name}");
            assert_eq!(session.panel.row, k);
            // Twice on the value brings the scene's own back.
            if !matches!(dial.scale, Scale::Choice(_)) {
                screen.time += 1.0;
                screen.click(&mut session, value, value);
                screen.click(&mut session, value, value);
                let now = (knob.read)(&session, 0).unwrap();
                assert_eq!(now.value, now.own, "{} of {name}", knob.name);
            }
        }
    }
}

/// Turned away and back, the forces are the same bits as before; turned away they are others.
#[test]
fn what_is_turned_acts_and_what_is_turned_back_leaves_no_trace() {
    let forces = |session: &Session| {
        let run = session.first();
        let mut f = vec![0.0; run.state().len()];
        run.model().system().eval_f(run.time(), run.state(), &mut f);
        f
    };
    let mut session = opened(&["r", "0.005", "--scene", "mit-sphere", "--wind"]);
    session.tick(0.1);
    let turn = |session: &mut Session, name: &str, turn| {
        let k = KNOBS.iter().position(|knob| knob.name == name).unwrap();
        apply(session, Request::Turn(k, turn));
    };
    let before = forces(&session);
    for (name, value) in [
        ("stiffness", 3.0),
        ("drag", 0.15),
        ("gravity", 3.7),
        ("gusts", 2.5),
    ] {
        turn(&mut session, name, Turn::To(value));
        assert_ne!(forces(&session), before, "{name}");
        // What a reset goes back to is tuned too.
        session.act(Action::Reset, 0);
        let k = KNOBS.iter().find(|knob| knob.name == name).unwrap();
        assert_eq!((k.read)(&session, 0).unwrap().value, value);
        for _ in 0..6 {
            session.tick(1.0 / 60.0);
        }
        turn(&mut session, name, Turn::Own);
        session.act(Action::Reset, 0);
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
    let network = |session: &Session| session.first().model().network().unwrap().clone();
    turn(&mut session, "sphere", Turn::To(0.75));
    assert_eq!(network(&session).spheres()[0].radius, 0.75);
    turn(&mut session, "floor", Turn::Toggle);
    assert_eq!(network(&session).floor(), None);
    turn(&mut session, "floor", Turn::Toggle);
    assert_eq!(network(&session).floor().unwrap().height, -5.0);
    turn(&mut session, "pins", Turn::Toggle);
    assert_eq!(network(&session).pins().count(), 0);
    turn(&mut session, "springs of", Turn::To(7.0));
    assert_eq!(session.panes[0].show.springs_of, Some(7));
}

#[test]
fn another_scene_is_not_tuned() {
    let mut session = opened(&["r", "0.005"]);
    for k in 2..=5 {
        apply(
            &mut session,
            Request::Turn(
                k,
                Turn::By {
                    up: true,
                    other: false,
                },
            ),
        );
    }
    session.act(Action::NextScene, 0);
    session.act(Action::NextScene, 0);
    for (_, knob, dial) in rows(&session).iter().skip(2) {
        assert_eq!(dial.value, dial.own, "{}", knob.name);
    }
}

#[test]
fn the_limit_follows_the_stiffness() {
    let mut session = opened(&["r", "0.005", "--scene", "mit", "--paused"]);
    session.read_state();
    let limit = |session: &Session| session.panes[0].watch.limit().unwrap().step;
    let before = limit(&session);
    let k = KNOBS.iter().position(|k| k.name == "stiffness").unwrap();
    apply(&mut session, Request::Turn(k, Turn::To(4.0)));
    session.read_state();
    let after = limit(&session);
    assert!((before / after - 2.0).abs() < 0.05, "{before} {after}");
}

#[test]
fn every_pane_and_the_reference_are_tuned_alike() {
    let mut session = compared(&["r:0.005", "v:0.005", "--scene", "pendulum"], 0.3);
    session.act(Action::Panel, 0);
    for (name, value) in [("stiffness", 2.0), ("gravity", 20.0), ("drag", 0.02)] {
        let k = KNOBS.iter().position(|k| k.name == name).unwrap();
        apply(&mut session, Request::Turn(k, Turn::To(value)));
    }
    for _ in 0..60 {
        session.tick(1.0 / 60.0);
    }
    for pane in &session.panes {
        let error = pane.error.unwrap();
        assert!(error < 1e-3, "{error}");
    }
    // The step is that of one pane.
    session.panel.pane = 1;
    apply(&mut session, Request::Turn(1, Turn::To(0.002)));
    assert_eq!(session.first().control(), Control::Step(0.005));
    assert_eq!(session.panes[1].simulation.control(), Control::Step(0.002));
}

#[test]
fn turning_goes_by_rungs_and_stays_within() {
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

/// With all its plots, beside one pane and beside four.
#[test]
fn nothing_is_cut_or_overlaps() {
    let compared = |scene| opened(&["compare", "e:0.0005", "x", "b", "n", "--scene", scene]);
    let several = ["mit-sphere", "simple"].map(compared);
    let mut screens = SIZES.map(Screen::new);
    for mut session in every_scene().chain(several) {
        let name = session.first().scene().name.clone();
        for k in 1..=4 {
            session.run_to(0.1 * f64::from(k));
        }
        for screen in &mut screens {
            let size = screen.size;
            let texts = screen.read(&session);
            let edge = size[0] - WIDTH;
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
            assert!(said("write scene"));
            assert!(said("energy (J)") != (name == "simple"), "{texts:?}");
        }
    }
}

/// However low the window, the row that keys turn is seen.
#[test]
fn the_chosen_row_is_seen() {
    let mut session = opened(&["r", "0.005"]);
    let mut screen = Screen::new([500.0, 200.0]);
    for (k, knob, _) in rows(&session) {
        session.panel.row = k;
        let texts = screen.written(&session);
        assert!(
            texts
                .iter()
                .any(|(words, rect, seen)| words == knob.name && seen.contains_rect(*rect)),
            "{}",
            knob.name
        );
    }
}

#[test]
fn the_help_stands_alone() {
    let mut session = opened(&["r", "0.005"]);
    assert_eq!(leaves(&session, (1280, 720), 1.0), (976, 720));
    assert_eq!(leaves(&session, (2560, 1440), 2.0), (1952, 1440));
    session.act(Action::Help, 0);
    assert_eq!(leaves(&session, (1280, 720), 1.0), (1280, 720));
    assert!(
        !Screen::new(SIZES[0])
            .read(&session)
            .iter()
            .any(|(words, _)| words == "Tuning")
    );
}
