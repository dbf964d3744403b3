//! The pane of plots: its heading, its rows, the chart, and buttons below it.

use egui::{Align2, Context, FontId, Id, Rect, Sense, Ui, pos2, vec2};

use super::super::docked::{close, docked};
use super::super::measure::chip;
use super::super::style::TEXT;
use super::draw;
use super::request::place;
use super::rows::Rows;
use crate::session::{IS_PAGE, Mode, PlotFile, PlotRequest, SPANS, Session};

/// Distance of the contents from the edges (points).
const MARGIN: f32 = 16.0;
/// Height of the heading, of the modes, and of the buttons below the chart (points).
const HEIGHTS: [f32; 3] = [38.0, 28.0, 26.0];
/// Distance between rows (points).
const GAP: f32 = 7.0;

/// Draws the pane, if it is visible, and returns the request of the mouse.
pub fn show(ctx: &Context, session: &Session) -> Option<PlotRequest> {
    let rect = place(session)?.rect(ctx);
    docked(ctx, "plots", rect, |ui| {
        ui.set_clip_rect(rect);
        contents(ui, rect.shrink2(vec2(MARGIN, 0.0)), session)
    })
}

/// Draws all rows from the top of a room. Returns the request of the mouse.
fn contents(ui: &Ui, room: Rect, session: &Session) -> Option<PlotRequest> {
    let [heading, modes, buttons] = HEIGHTS;
    let closed = head(ui, room.with_max_y(room.top() + heading - GAP));
    let top = room.top() + heading;
    let chosen = tabs(
        ui,
        Rect::from_x_y_ranges(room.x_range(), top..=top + modes),
        session,
    );
    let mut rows = Rows {
        ui,
        session,
        room: room.with_min_y(top + modes + GAP),
        request: closed.or(chosen),
    };
    rows.picks();
    let is_empty = session.runs.panes[0].traces.is_empty();
    if !is_empty {
        rows.variables();
    }
    let (top, request) = (rows.room.top(), rows.request);
    let below = room.bottom() - buttons - 10.0;
    let place = Rect::from_min_max(
        pos2(room.left(), top + 2.0),
        pos2(room.right(), below - GAP),
    );
    if !is_empty && place.height() > 0.0 {
        draw::show(ui, place, session);
    }
    let place = Rect::from_x_y_ranges(room.x_range(), below..=below + buttons);
    foot(ui, place, session).or(request)
}

/// Draws the title, and a button that hides the pane.
fn head(ui: &Ui, rect: Rect) -> Option<PlotRequest> {
    let painter = ui.painter();
    let at = rect.left_center() + vec2(0.0, 2.0);
    let font = FontId::proportional(17.0);
    painter.text(at, Align2::LEFT_CENTER, "Plots", font, TEXT);
    close(ui, rect.translate(vec2(0.0, 2.0)), "F3").then_some(PlotRequest::Close)
}

/// Draws the modes. Returns the request of the mouse.
fn tabs(ui: &Ui, rect: Rect, session: &Session) -> Option<PlotRequest> {
    let gap = 6.0;
    let width = (rect.width() - 2.0 * gap) / 3.0;
    let mut request = None;
    for (k, mode) in Mode::ALL.into_iter().enumerate() {
        let left = rect.left() + k as f32 * (width + gap);
        let place = Rect::from_min_size(pos2(left, rect.top()), vec2(width, rect.height()));
        let chosen = session.panel.plotting.mode == mode;
        if button(ui, place, mode.name(), chosen) {
            request = Some(PlotRequest::Mode(mode));
        }
    }
    request
}

/// Draws a button, and returns whether it was clicked.
fn button(ui: &Ui, rect: Rect, words: &str, chosen: bool) -> bool {
    let response = ui.interact(rect, Id::unique(("plots", words)), Sense::click());
    chip(ui, rect, &response, words, chosen);
    response.clicked()
}

/// Draws the spans of time, and the buttons that write files. Returns the request of the mouse.
fn foot(ui: &Ui, rect: Rect, session: &Session) -> Option<PlotRequest> {
    let settings = &session.panel.plotting;
    let mut request = None;
    let mut left = rect.left();
    if settings.mode != Mode::Section {
        for span in SPANS {
            let place = Rect::from_min_size(pos2(left, rect.top()), vec2(44.0, rect.height()));
            if button(ui, place, &format!("{span} s"), settings.span == span) {
                request = Some(PlotRequest::Span(span));
            }
            left = place.right() + 4.0;
        }
    }
    let mut right = rect.right();
    let ruled = settings.ruler.is_some();
    for (words, wish) in [
        (
            if IS_PAGE { "SVG" } else { "PNG" },
            PlotRequest::Write(PlotFile::Picture),
        ),
        ("CSV", PlotRequest::Write(PlotFile::Table)),
        ("clear", PlotRequest::Clear),
        ("ruler", PlotRequest::Ruler),
    ] {
        let place = Rect::from_min_max(pos2(right - 50.0, rect.top()), pos2(right, rect.bottom()));
        let chosen = ruled && wish == PlotRequest::Ruler;
        if button(ui, place, words, chosen) {
            request = Some(wish);
        }
        right = place.left() - 4.0;
    }
    request
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use a3_core::Vector3;
    use egui::epaint::MarginF32;
    use egui::{Event, Modifiers, PointerButton, Pos2, RawInput, SafeAreaInsets};

    use super::super::super::all::show_all;
    use super::super::super::layout;
    use super::super::super::panel::Request;
    use super::super::super::style::context;
    use super::super::super::words::signed;
    use super::super::request::apply;
    use super::*;
    use crate::session::{Pick, RulerEnd, RunAction, Trigger, Variable, frames, session};

    /// Draws a window of a size (points), and presses at a place. Returns the words of the pane,
    /// their places, and the request.
    fn draw(session: &Session, [width, height]: [f32; 2], at: Pos2) -> Drawn {
        let ctx = context();
        let window = Rect::from_min_size(Pos2::ZERO, vec2(width, height));
        let press = |pressed| Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::default(),
        };
        let [right, bottom] = layout::insets(session, (width as u32, height as u32), 1.0);
        let mut drawn = Drawn::default();
        for event in [None, None, Some(press(true)), Some(press(false))] {
            let input = RawInput {
                screen_rect: Some(window),
                safe_area_insets: Some(SafeAreaInsets(MarginF32 {
                    right,
                    bottom,
                    ..Default::default()
                })),
                events: [Event::PointerMoved(at)].into_iter().chain(event).collect(),
                ..RawInput::default()
            };
            let mut request = None;
            let mut output = ctx.run_ui(input, |ui| {
                request = show_all(ui.ctx(), session, &HashMap::new());
            });
            output.textures_delta.set.clear();
            output.textures_delta.free.clear();
            drawn.request = request.or(drawn.request);
            drawn.words.clear();
            drawn.all.clear();
            for clipped in &output.shapes {
                let egui::Shape::Text(text) = &clipped.shape else {
                    continue;
                };
                drawn.all.push(text.galley.text().to_owned());
                let rect = text.visual_bounding_rect();
                let is_in_pane = if right > 0.0 {
                    rect.left() > width - right
                } else {
                    rect.top() > height - bottom && rect.bottom() < height - 40.0
                };
                if is_in_pane {
                    let said = text.galley.text().to_owned();
                    assert!(clipped.clip_rect.contains_rect(rect), "{said} in {width}");
                    drawn.words.push((said, rect));
                }
            }
        }
        drawn
    }

    #[derive(Default)]
    struct Drawn {
        words: Vec<(String, Rect)>,
        /// The words of the whole window.
        all: Vec<String>,
        request: Option<Request>,
    }

    impl Drawn {
        /// Returns the place of words.
        fn place(&self, words: &str) -> Pos2 {
            let found = self.words.iter().find(|(said, _)| said == words);
            let all = self.words.iter().map(|(said, _)| said).collect::<Vec<_>>();
            found
                .unwrap_or_else(|| panic!("{words} in {all:?}"))
                .1
                .center()
        }
    }

    /// Returns a session of a curtain with three plots.
    fn curtain() -> Session {
        let mut session = session(&["t", "0.01", "--springs-of", "210"]);
        session.act(RunAction::Plots, 0);
        apply(&mut session, PlotRequest::Toggle(Pick::Particle(399)));
        apply(&mut session, PlotRequest::Toggle(Pick::Spring(210, 230)));
        frames(&mut session, 1.0);
        session
    }

    #[test]
    fn no_words_cover_others_in_any_window() {
        let mut session = curtain();
        let away = Pos2::new(5.0, 5.0);
        for mode in Mode::ALL {
            apply(&mut session, PlotRequest::Mode(mode));
            for size in [
                [1000.0, 560.0],
                [1280.0, 800.0],
                [1920.0, 1080.0],
                [620.0, 900.0],
            ] {
                let drawn = draw(&session, size, away);
                for (k, (a, place)) in drawn.words.iter().enumerate() {
                    for (b, other) in &drawn.words[..k] {
                        let apart = !place.shrink(1.0).intersects(*other);
                        assert!(apart, "{a} over {b} in {size:?}, {mode:?}");
                    }
                }
                for said in [
                    "particle 210",
                    "spring 210 to 230",
                    "CSV",
                    "PNG",
                    mode.name(),
                ] {
                    drawn.place(said);
                }
            }
        }
    }

    #[test]
    fn clicks_choose_what_is_plotted_and_how() {
        let mut session = curtain();
        let size = [1280.0, 800.0];
        let mut click = |words: &str| {
            let at = draw(&session, size, Pos2::new(5.0, 5.0)).place(words);
            let request = draw(&session, size, at).request;
            let Some(Request::Plot(wish)) = request else {
                panic!("{words}: {request:?}");
            };
            apply(&mut session, wish);
            wish
        };
        assert_eq!(click("vy"), PlotRequest::Show(Variable::VelocityY));
        assert_eq!(
            click("particle 399"),
            PlotRequest::Toggle(Pick::Particle(399))
        );
        assert_eq!(click("190"), PlotRequest::Toggle(Pick::Spring(190, 210)));
        assert_eq!(click("5 s"), PlotRequest::Span(5.0));
        assert_eq!(click("section"), PlotRequest::Mode(Mode::Section));
        assert_eq!(click("ruler"), PlotRequest::Ruler);
        let lower = Trigger::Rises(Variable::VelocityY, 0.0);
        let trigger = |session: &Session| session.runs.panes[0].traces.trigger();
        assert_eq!(trigger(&session), lower);
    }

    #[test]
    fn values_are_shown_at_the_pointer() {
        let mut session = curtain();
        let size = [1280.0, 800.0];
        let away = draw(&session, size, Pos2::new(5.0, 5.0));
        let left = away.place("y (m)");
        let said = |session: &Session, at: Pos2| -> Vec<String> {
            let drawn = draw(session, size, at);
            drawn.words.into_iter().map(|(said, _)| said).collect()
        };
        // At a twentieth of the way, 1 s of 20 s have passed.
        let (from, to) = (left.x + 30.0, 1264.0);
        let at = Pos2::new(from + (to - from) / 20.0, left.y + 30.0);
        let words = said(&session, at);
        let time = words
            .iter()
            .find_map(|it| it.strip_prefix("at ")?.strip_suffix(" s"));
        let time: f64 = time.unwrap().parse().unwrap();
        assert!((0.8..1.05).contains(&time), "{time}");
        let (_, series) = &session.runs.panes[0].traces.iter().as_slice()[0];
        let y = series.nearest(time).unwrap().values[1];
        let value = format!("particle 210  {y:.2} m");
        assert!(words.contains(&value), "{value} in {words:?}");
        apply(&mut session, PlotRequest::Mode(Mode::Phase));
        assert!(
            !said(&session, Pos2::new(5.0, 5.0))
                .iter()
                .any(|it| it.starts_with("at "))
        );
    }

    #[test]
    fn the_ruler_follows_its_ends() {
        let mut session = curtain();
        assert!(!session.panel.plotting.is_ruling());
        apply(&mut session, PlotRequest::Ruler);
        for end in [RulerEnd::Particle(210), RulerEnd::Particle(399)] {
            assert!(session.panel.plotting.is_ruling());
            session.panel.plotting.begin_end(end);
        }
        assert!(!session.panel.plotting.is_ruling());
        session
            .panel
            .plotting
            .move_end(RulerEnd::Point(Vector3::new(0.0, 2.0, 0.0)));
        let mut last = String::new();
        for _ in 0..2 {
            frames(&mut session, 0.3);
            let way = Vector3::new(0.0, 2.0, 0.0) - session.runs.first().position(210);
            let [dx, dy, dz] = [way.x, way.y, way.z].map(signed);
            let length = signed(way.norm());
            let words = format!("{length} m\ndx {dx}   dy {dy}   dz {dz} m");
            let drawn = draw(&session, [1280.0, 800.0], Pos2::new(5.0, 5.0));
            assert!(
                drawn.all.contains(&words) && words != last,
                "{words} in {:?}",
                drawn.all
            );
            last = words;
        }
        apply(&mut session, PlotRequest::Ruler);
        assert!(session.panel.plotting.ruler.is_none());
    }

    #[test]
    fn a_small_window_says_that_plots_have_no_room() {
        let mut session = curtain();
        apply(&mut session, PlotRequest::Mode(Mode::Phase));
        let said = |session: &Session, size, words: &str| {
            let drawn = draw(session, size, Pos2::new(5.0, 5.0));
            drawn.all.iter().any(|it| it.contains(words))
        };
        assert!(said(&session, [640.0, 400.0], "There is no room"));
        assert!(!said(&session, [640.0, 400.0], "Choose what to show"));
        assert!(!said(&session, [1280.0, 800.0], "There is no room"));
        apply(&mut session, PlotRequest::Mode(Mode::Time));
        for variable in session.panel.plotting.shown.clone() {
            apply(&mut session, PlotRequest::Show(variable));
        }
        assert!(said(&session, [1280.0, 800.0], "Choose what to show"));
    }
}
