//! The list of lessons, with the progress in each.

use a3_files::lessons::{ALL, Lesson};
use egui::{CornerRadius, CursorIcon, Id, Painter, Pos2, Sense, Stroke, Ui, pos2, vec2};

use super::super::docked::keep_in_sight;
use super::super::panel::{CHOSEN, HOVERED, INK, TRACK};
use super::super::style::{FAINT, TEXT};
use super::marked::job;
use crate::session::{LessonRequest, Lessons};

/// Width of the numbers (points).
const NUMBER_WIDTH: f32 = 26.0;
/// Radius of a dot of the progress, and the distance between dots (points).
const DOT: (f32, f32) = (3.6, 11.0);

/// Draws the list, and returns the request of the mouse.
pub fn show(ui: &mut Ui, lessons: &Lessons) -> Option<LessonRequest> {
    let width = ui.available_width();
    let intro = "Each step runs a scene beside this text and asks what you see.";
    ui.label(job(intro, 13.0, FAINT, width));
    ui.add_space(8.0);
    let mut request = None;
    for (k, lesson) in ALL.iter().enumerate() {
        if row(ui, lessons, k, lesson) {
            request = Some(LessonRequest::Open(k, lessons.next_step(k)));
        }
    }
    request
}

/// Draws a lesson, and returns whether it was clicked.
fn row(ui: &mut Ui, lessons: &Lessons, number: usize, lesson: &Lesson) -> bool {
    let dots = DOT.1 * lesson.steps.len() as f32;
    let width = ui.available_width();
    let room = width - NUMBER_WIDTH - dots - 14.0;
    let painter = ui.painter().clone();
    let title = painter.layout_job(job(&lesson.title, 14.5, TEXT, room));
    let about = painter.layout_job(job(&lesson.about, 12.5, FAINT, width - NUMBER_WIDTH - 8.0));
    let height = 16.0 + title.size().y + about.size().y;
    let (rect, _) = ui.allocate_exact_size(vec2(width, height), Sense::hover());
    let response = ui.interact(rect, Id::unique(("lesson", number)), Sense::click());
    let fill = if response.hovered() {
        HOVERED
    } else if lessons.chosen == number {
        CHOSEN
    } else {
        egui::Color32::TRANSPARENT
    };
    painter.rect_filled(rect.shrink2(vec2(0.0, 1.0)), CornerRadius::same(6), fill);
    let at = rect.min + vec2(8.0, 8.0);
    let words = format!("{}", number + 1);
    painter.galley(at, painter.layout_job(job(&words, 14.5, INK, 40.0)), INK);
    let left = rect.left() + NUMBER_WIDTH;
    let below = pos2(left, at.y + title.size().y);
    let middle = at.y + 0.5 * title.size().y;
    painter.galley(pos2(left, at.y), title, TEXT);
    painter.galley(below, about, FAINT);
    for step in 0..lesson.steps.len() {
        let x = rect.right() - 10.0 - dots + DOT.1 * (step as f32 + 1.0);
        dot(&painter, pos2(x, middle), lessons.is_done(number, step));
    }
    if lessons.chosen == number && lessons.step.is_none() {
        keep_in_sight(ui, "lessons", rect, number);
    }
    response.on_hover_cursor(CursorIcon::PointingHand).clicked()
}

/// Draws a dot: full if its step is done.
fn dot(painter: &Painter, at: Pos2, done: bool) {
    if done {
        painter.circle_filled(at, DOT.0, INK);
    } else {
        painter.circle_stroke(at, DOT.0 - 0.6, Stroke::new(1.2, TRACK));
    }
}
