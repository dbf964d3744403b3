//! All that a window draws over and around its picture.

use std::collections::HashMap;

use egui::{Context, TextureId};

use super::style::MARGIN;
use super::{bar, edit, layout, list, marks, offers, plotting, text};
use crate::session::Session;

/// Shorter side of a picture that lists cover (points).
const LIST_COVERS: f32 = 500.0;

/// Largest width of the explanation of the row or button under the pointer (points).
const WIDEST: f32 = 500.0;

/// Heights of a picture without room for text above the tools, with one row of panes and with two
/// (points).
const TOOLS_COVER: [f32; 2] = [260.0, 560.0];

/// Draws text, panel, bar and the open list, with `pictures` of scenes by their names. What the
/// mouse asks for is [`asked`](super::asked) then.
pub fn show_all(ctx: &Context, session: &Session, pictures: &HashMap<String, TextureId>) {
    let window = ctx.viewport_rect().size();
    // Explanations are beside a pane, over the picture.
    let beside = ctx.content_rect().width() - 2.0 * MARGIN;
    ctx.global_style_mut(|style| style.spacing.tooltip_width = beside.clamp(80.0, WIDEST));
    if !layout::is_covered(session, window.into()) {
        over_picture(ctx, session);
    }
    if let Some(pane) = layout::beside(session) {
        pane.show(ctx, session);
    }
    bar::show(ctx, session);
    if session.readings.asks_to_quit {
        offers::ask_to_quit(ctx);
    }
    list::show(ctx, session, pictures);
}

/// Draws what lies over the picture.
fn over_picture(ctx: &Context, session: &Session) {
    let window = ctx.content_rect().size();
    // In a small window, the open list leaves no room for text beside it.
    if session.list.is_some() && window.min_elem() < LIST_COVERS {
        return;
    }
    // In a low window, the tools leave no room for text above them, nor for that of lower panes.
    let several = session.runs.panes.len() > 2;
    let is_low = window.y < TOOLS_COVER[usize::from(several)] && session.panel.editor.open;
    if is_low && !session.readings.help {
        return edit::show(ctx, session);
    }
    marks::hint(ctx, session);
    text::show_text(ctx, &session.runs.panes, &session.readings);
    plotting::offer(ctx, session);
    offers::offer(ctx, session);
    marks::ruler(ctx, session);
    offers::on_panes(ctx, session);
    edit::show(ctx, session);
}

#[cfg(test)]
mod tests {
    //! Small windows and phones: nothing lies over anything else, and nothing is cut off.

    use egui::{Rect, Shape};

    use super::*;
    use crate::hud::window::Window;
    use crate::session::{LessonRequest, RunAction, apply, frames, session};

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

    /// Lays out a window of a size (px) at a scale.
    fn lay_out(session: &Session, size: [f32; 2], scale: f32) -> Window {
        let mut window = Window::new(size.map(|side| side / scale));
        (window.step, window.scale) = (1.0, scale);
        let px = (size[0] as u32, size[1] as u32);
        let taken = layout::insets(session, px, scale);
        for _ in 0..4 {
            window.frame(taken, vec![], |ctx| show_all(ctx, session, &HashMap::new()));
        }
        window
    }

    /// Returns the words that lie over other words, are below a sheet, or are cut off.
    fn faults(session: &Session, size: [f32; 2], scale: f32) -> Vec<String> {
        let window = lay_out(session, size, scale);
        let (mut seen, mut faults): (Vec<(String, Rect)>, _) = (vec![], vec![]);
        for clipped in &window.shapes {
            let clip = clipped.clip_rect.intersect(window.place);
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
    fn an_explanation_fits_beside_a_pane_in_a_small_window() {
        let mut session = session(&["r", "0.005", "--scene", "flag"]);
        session.act(RunAction::Panel, 0);
        let mut window = lay_out(&session, [480.0, 360.0], 1.0);
        let taken = layout::insets(&session, (480, 360), 1.0);
        let row = window.written().into_iter().find(|it| it.0 == "strain limit");
        let at = row.unwrap().1.center();
        let moved = Some(egui::Event::PointerMoved(at));
        for events in [moved, None, None, None] {
            let events = events.into_iter().collect();
            window.frame(taken, events, |ctx| {
                show_all(ctx, &session, &HashMap::new());
            });
        }
        let mut words = window.written().into_iter();
        let (said, rect, seen) = words.find(|it| it.0.contains("Click the value")).unwrap();
        assert!(seen.contains_rect(rect), "{said:?} at {rect:?}");
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
                apply(&mut session, LessonRequest::Open(lesson, step), 0);
                session.readings.touch = touch;
                frames(&mut session, 0.2);
                session.read_state();
                let faults = faults(&session, size, scale);
                assert!(faults.is_empty(), "lesson {lesson}.{step} in {size:?}: {faults:?}");
                let window = lay_out(&session, size, scale);
                let (picture, whole) = (window.ctx.content_rect(), window.place);
                let is_large = |part: f32, all: f32| part > 0.4 * all;
                assert!(
                    is_large(picture.width(), whole.width())
                        && is_large(picture.height(), whole.height()),
                    "{picture:?}"
                );
                let keys = window.written().into_iter().filter(|(words, rect, seen)| {
                    "1234567890".contains(words.as_str()) && seen.contains_rect(*rect)
                });
                let asks_number = (lesson, step) != (0, 0) && (lesson, step) != (7, 2);
                let is_low = whole.height() < 300.0;
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
            let window = lay_out(session, SIZES[0].0, SIZES[0].1);
            let words = window.words();
            let font = egui::FontId::proportional(14.0);
            let known = |letter| window.ctx.fonts_mut(|fonts| fonts.has_glyph(&font, letter));
            let unknown: String = words.chars().filter(|c| *c != '\n' && !known(*c)).collect();
            assert!(unknown.is_empty(), "{unknown:?} in {words}");
            words
        };
        assert!(said(&session).contains("Pull me with a finger"));
        session.act(RunAction::Help, 0);
        let help = said(&session);
        assert!(help.contains("Fingers\n") && help.contains("long press"), "{help}");
        assert!(!help.contains("Mouse\n") && !help.contains("right click"), "{help}");
        session.act(RunAction::Help, 0);
        session.act(RunAction::Lessons, 0);
        apply(&mut session, LessonRequest::Open(2, 0), 0);
        assert!(said(&session).contains('⬅'));
    }
}
