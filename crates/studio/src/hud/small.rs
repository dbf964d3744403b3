//! Small windows and phones: nothing lies over anything else, and nothing is cut off.

use std::collections::HashMap;

use egui::epaint::{ClippedShape, MarginF32};
use egui::{Context, Pos2, RawInput, Rect, SafeAreaInsets, Shape, vec2};

use super::style::context;
use super::{all::show_all, layout, lessons};
use crate::session::{LessonRequest, RunAction, Session, frames, session};

/// Sizes of windows (px), with pixels per point, and whether fingers are used.
const SIZES: [([f32; 2], f32, bool); 6] = [
    ([390.0, 844.0], 1.0, true),
    ([780.0, 1688.0], 2.0, true),
    ([480.0, 360.0], 1.0, false),
    ([800.0, 500.0], 1.0, false),
    ([800.0, 500.0], 2.0, false),
    ([800.0, 500.0], 2.0, true),
];

/// What is open.
const OPEN: [RunAction; 8] = [
    RunAction::Panel,
    RunAction::Edit,
    RunAction::Plots,
    RunAction::Measure,
    RunAction::Lessons,
    RunAction::Help,
    RunAction::Scenes,
    RunAction::Solvers,
];

/// Lays out a window, and returns its context, its shapes from the lowest to the highest, and its
/// size (points).
fn lay_out(session: &Session, size: [f32; 2], scale: f32) -> (Context, Vec<ClippedShape>, Rect) {
    let ctx = context();
    let window = Rect::from_min_size(Pos2::ZERO, vec2(size[0], size[1]) / scale);
    let px = (size[0] as u32, size[1] as u32);
    let [right, bottom] = layout::insets(session, px, scale);
    let mut shapes = vec![];
    for pass in 0..4 {
        let mut input = RawInput {
            screen_rect: Some(window),
            time: Some(f64::from(pass)),
            safe_area_insets: Some(SafeAreaInsets(MarginF32 {
                right,
                bottom,
                ..Default::default()
            })),
            ..RawInput::default()
        };
        let root = input.viewports.entry(egui::ViewportId::ROOT).or_default();
        root.native_pixels_per_point = Some(scale);
        let mut output = ctx.run_ui(input, |ui| {
            let _ = show_all(ui.ctx(), session, &HashMap::new());
        });
        output.textures_delta.set.clear();
        output.textures_delta.free.clear();
        shapes = output.shapes;
    }
    (ctx, shapes, window)
}

/// Returns the words that lie over other words, are below a sheet, or are cut off.
fn faults(session: &Session, size: [f32; 2], scale: f32) -> Vec<String> {
    let (_, shapes, window) = lay_out(session, size, scale);
    let (mut seen, mut faults): (Vec<(String, Rect)>, _) = (vec![], vec![]);
    for clipped in &shapes {
        let clip = clipped.clip_rect.intersect(window);
        let (name, whole) = match &clipped.shape {
            Shape::Text(text) if text.galley.text().is_empty() => continue,
            Shape::Text(text) => (text.galley.text().to_owned(), text.visual_bounding_rect()),
            Shape::Rect(rect) if rect.fill.a() > 150 => ("a sheet".to_owned(), rect.rect),
            _ => continue,
        };
        let rect = whole.intersect(clip).shrink(1.0);
        if !rect.is_positive() {
            continue;
        }
        let below = seen.iter().filter(|(_, other)| rect.intersects(*other));
        faults.extend(below.map(|(words, _)| format!("{name:?} over {words:?}")));
        if matches!(clipped.shape, Shape::Text(_)) {
            // What scrolls may be cut above and below.
            let across = clip.expand(1.0).x_range();
            if !across.contains(whole.left()) || !across.contains(whole.right()) {
                faults.push(format!("{name:?} is cut off"));
            }
            seen.push((name, rect));
        }
    }
    assert!(!seen.is_empty());
    faults
}

#[test]
fn nothing_lies_over_words_in_small_windows() {
    let mut all = vec![];
    for words in [
        &["t", "0.01"][..],
        &["compare", "e:0.0005", "t", "--scene", "mit-sphere"],
        &["compare", "e:0.0005", "t", "r", "x", "--scene", "mit"],
        &["r", "0.05", "--scene", "mit"],
    ] {
        for (size, scale, touch) in SIZES {
            let mut session = session(words);
            session.readings.in_window = true;
            session.readings.touch = touch;
            session.measuring.answerer = Some(|_, _| unreachable!());
            frames(&mut session, 0.5);
            session.read_state();
            let px = (size[0] as u32, size[1] as u32);
            let tile = layout::tiles(session.runs.panes.len(), px, scale)[0];
            let focus = layout::focus(session.runs.panes.len(), layout::points(tile, scale));
            session.view.camera.set_focus(focus);
            let mut look = |session: &Session, open: &str| {
                for fault in faults(session, size, scale) {
                    all.push(format!("{words:?} {open} in {size:?} at {scale}: {fault}"));
                }
            };
            look(&session, "");
            for action in OPEN {
                session.act(action, 0);
                look(&session, &format!("{action:?}"));
                session.list = None;
                session.act(action, 0);
                session.list = None;
            }
        }
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}

/// In lessons, the picture keeps its room, and the keypad is whole unless the window is tiny.
#[test]
fn lessons_have_the_scene_in_view_and_a_whole_keypad() {
    for (size, scale, touch) in SIZES {
        let mut session = session(&["t", "0.01"]);
        session.readings.touch = touch;
        session.act(RunAction::Lessons, 0);
        for (lesson, step) in [(0, 0), (0, 1), (2, 0), (3, 1), (7, 2)] {
            lessons::apply(&mut session, LessonRequest::Open(lesson, step));
            session.readings.touch = touch;
            frames(&mut session, 0.2);
            session.read_state();
            let faults = faults(&session, size, scale);
            assert!(
                faults.is_empty(),
                "lesson {lesson}.{step} in {size:?}: {faults:?}"
            );
            let (ctx, shapes, window) = lay_out(&session, size, scale);
            let picture = ctx.content_rect();
            assert!(
                picture.width() > 0.4 * window.width() && picture.height() > 0.4 * window.height(),
                "{picture:?}"
            );
            let keys = shapes.iter().filter(|clipped| {
                let Shape::Text(text) = &clipped.shape else {
                    return false;
                };
                let rect = text.visual_bounding_rect();
                "1234567890".contains(text.galley.text()) && clipped.clip_rect.contains_rect(rect)
            });
            let asks_number = (lesson, step) != (0, 0) && (lesson, step) != (7, 2);
            let is_low = window.height() < 300.0;
            if touch && asks_number && !is_low {
                assert!(keys.count() >= 10, "lesson {lesson}.{step} in {size:?}");
            }
        }
    }
}

/// Fingers are told what fingers do, and every letter that they see is in the fonts.
#[test]
fn fingers_have_words_of_their_own() {
    let mut session = session(&["t", "0.01"]);
    session.readings.touch = true;
    frames(&mut session, 0.1);
    session.read_state();
    let said = |session: &Session| {
        let (ctx, shapes, _) = lay_out(session, SIZES[0].0, SIZES[0].1);
        let words = shapes.iter().filter_map(|clipped| match &clipped.shape {
            Shape::Text(text) => Some(text.galley.text().to_owned()),
            _ => None,
        });
        let words = words.collect::<Vec<_>>().join("\n");
        let font = egui::FontId::proportional(14.0);
        let known = |letter| ctx.fonts_mut(|fonts| fonts.has_glyph(&font, letter));
        let unknown: String = words.chars().filter(|c| *c != '\n' && !known(*c)).collect();
        assert!(unknown.is_empty(), "{unknown:?} in {words}");
        words
    };
    assert!(said(&session).contains("Pull me with a finger"));
    session.act(RunAction::Help, 0);
    let help = said(&session);
    assert!(
        help.contains("Fingers\n") && help.contains("long press"),
        "{help}"
    );
    assert!(
        !help.contains("Mouse\n") && !help.contains("right click"),
        "{help}"
    );
    session.act(RunAction::Help, 0);
    session.act(RunAction::Lessons, 0);
    lessons::apply(&mut session, LessonRequest::Open(2, 0));
    assert!(said(&session).contains('⬅'));
}
