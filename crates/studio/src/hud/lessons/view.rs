//! Drawing of the lessons: their sheet, the heading, and what scrolls below it.

use egui::{
    Align2, Context, CursorIcon, FontId, Id, Rect, ScrollArea, Sense, Stroke, Ui, UiBuilder, pos2,
    vec2,
};

use super::super::docked::{close, docked};
use super::super::panel::INK;
use super::super::style::TEXT;
use super::button::button;
use super::place::place;
use super::request::{next, previous};
use super::{contents, step};
use crate::session::{LessonRequest, Session};

/// Distance of the text from the edges of the sheet (points).
const MARGIN: f32 = 16.0;
/// Height of the heading (points).
const HEADING_HEIGHT: f32 = 44.0;
/// Width of the button that closes the lessons (points).
const CLOSE_WIDTH: f32 = 28.0;
/// Height of a pane whose keypad scrolls with the text (points).
const LOW: f32 = 300.0;
/// Height of the buttons and of their margins, with the mouse and with fingers (points).
const BUTTONS_HEIGHTS: [f32; 2] = [48.0, 58.0];

/// Draws the lessons, if they are visible, and returns the request of the mouse.
pub fn show(ctx: &Context, session: &Session) -> Option<LessonRequest> {
    let rect = place(session)?.rect(ctx);
    let lessons = &session.panel.lessons;
    docked(ctx, "lessons", rect, |ui| {
        let inner = rect.shrink2(vec2(MARGIN, 0.0));
        let mut request = heading(ui, inner, session);
        let shown = lessons.shown();
        let buttons_height = BUTTONS_HEIGHTS[usize::from(session.readings.touch)];
        let below = rect.height() > LOW;
        let keys = if below {
            step::keypad_height(session)
        } else {
            0.0
        };
        let foot = shown.map_or(8.0, |_| buttons_height + keys);
        let body = Rect::from_min_max(
            pos2(inner.left(), inner.top() + HEADING_HEIGHT),
            pos2(inner.right() + MARGIN - 4.0, inner.bottom() - foot),
        );
        let salt = shown.map(|_| (lessons.chosen, lessons.step));
        let scrolled = ui.scope_builder(UiBuilder::new().max_rect(body), |ui| {
            ScrollArea::vertical()
                .id_salt(("lessons", salt))
                .auto_shrink([false, false])
                .show(ui, |ui| {
                    ui.set_width(inner.width());
                    ui.spacing_mut().item_spacing = vec2(0.0, 0.0);
                    match shown {
                        Some((lesson, step)) => step::show(ui, session, lesson, step, !below),
                        None => contents::show(ui, lessons),
                    }
                })
                .inner
        });
        request = scrolled.inner.or(request);
        if shown.is_some() {
            let row = inner.with_min_y(inner.bottom() - buttons_height);
            request = buttons(ui, row.shrink2(vec2(0.0, 8.0)), session).or(request);
            let room = Rect::from_min_max(pos2(inner.left(), row.top() - keys), row.right_top());
            request = step::keypad(ui, room).or(request);
        }
        request
    })
}

/// Draws the title: of the list, or of the lesson, with the way back to the list. Returns the
/// request of the mouse.
fn heading(ui: &Ui, inner: Rect, session: &Session) -> Option<LessonRequest> {
    let lessons = &session.panel.lessons;
    let line = inner.top() + 21.0;
    let write = |x: f32, words: &str, size, colour| {
        let (at, font) = (pos2(x, line), FontId::proportional(size));
        let painter = ui.painter();
        painter.text(at, Align2::LEFT_CENTER, words, font, colour)
    };
    let top = inner.with_max_y(inner.top() + HEADING_HEIGHT - 2.0);
    let closed = close(ui, top, "F1").then_some(LessonRequest::Close);
    let Some((lesson, _)) = lessons.shown() else {
        write(inner.left(), "Lessons", 17.0, TEXT);
        return closed;
    };
    let arrow = Rect::from_center_size(pos2(inner.left() + 5.0, line), vec2(34.0, 34.0));
    let font = FontId::proportional(17.0);
    let words = ui
        .painter()
        .layout_no_wrap(lesson.title.clone(), font, TEXT);
    let fit = (inner.width() - 18.0 - CLOSE_WIDTH) / words.size().x;
    let size = 17.0 * fit.min(1.0);
    let title = write(inner.left() + 18.0, &lesson.title, size, TEXT);
    let id = Id::unique("back to the lessons");
    let response = ui.interact(arrow.union(title), id, Sense::click());
    let stroke = Stroke::new(1.8, if response.hovered() { TEXT } else { INK });
    let corner = |x: f32, y: f32| pos2(inner.left() + x, line + y);
    let points = vec![corner(7.0, -5.5), corner(1.5, 0.0), corner(7.0, 5.5)];
    ui.painter().add(egui::Shape::line(points, stroke));
    let response = response
        .on_hover_cursor(CursorIcon::PointingHand)
        .on_hover_text("All lessons");
    let back = response.clicked().then_some(LessonRequest::Contents);
    back.or(closed)
}

/// Draws the buttons that go back, run the step again, and go on. Returns the request of the mouse.
fn buttons(ui: &Ui, row: Rect, session: &Session) -> Option<LessonRequest> {
    let done = session.panel.lessons.given().done;
    let gap = 6.0;
    let width = (row.width() - 2.0 * gap) / 3.0;
    let mut request = None;
    let all = [
        ("Back", previous(session), false),
        ("Run again", LessonRequest::Again, false),
        ("Next", next(session), done),
    ];
    for (k, (words, wish, is_due)) in all.into_iter().enumerate() {
        let left = row.left() + k as f32 * (width + gap);
        let place = Rect::from_min_size(pos2(left, row.top()), vec2(width, row.height()));
        let response = ui.interact(place, Id::unique(("lesson button", k)), Sense::click());
        button(ui, place, &response, words, is_due);
        if response.clicked() {
            request = Some(wish);
        }
    }
    request
}
