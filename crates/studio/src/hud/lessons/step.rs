//! A step of a lesson: what runs, what to look at, the question, and the reply to an answer.

use a3_files::lessons::{Answer, Choice, Lesson, Step};
use egui::{
    Align2, Color32, CursorIcon, FontId, Id, Rect, Sense, Stroke, StrokeKind, Ui, pos2, vec2,
};

use super::super::docked::EDGE;
use super::super::panel::{CHOSEN, HOVERED, INK, TRACK};
use super::super::style::{self, FAINT, SAFE, TEXT, WARNING};
use super::button::button;
use super::marked::job;
use crate::session::{Given, LessonRequest, Session};

/// Number of wrong answers after which the right one can be shown.
const TRIES: u32 = 2;
/// Colour of fields and cards.
const CARD: Color32 = Color32::from_gray(238);
/// Width of the button that checks a number (points).
const CHECK_WIDTH: f32 = 84.0;
/// Heights of a button, with the mouse and with fingers (points).
const HEIGHTS: [f32; 2] = [32.0, 42.0];
/// The keys of the keypad, for fingers; `<` erases.
const KEYPAD: [&str; 2] = ["12345-<", "67890.e"];
/// The face of the key that erases.
pub const ERASE: char = '⬅';
/// Height of a key (points).
const KEY_HEIGHT: f32 = 42.0;

/// Draws a step, with the keypad if `keys`, and returns the request of the mouse.
pub fn show(
    ui: &mut Ui,
    session: &Session,
    lesson: &Lesson,
    step: &Step,
    keys: bool,
) -> Option<LessonRequest> {
    let (lessons, width) = (&session.panel.lessons, ui.available_width());
    let given = lessons.given();
    let mut request = stations(ui, session, lesson);
    ui.add_space(10.0);
    ui.label(job(&step.title, 15.5, TEXT, width));
    ui.add_space(7.0);
    card(ui, &step.run, INK, 12.5);
    for paragraph in &step.look {
        ui.add_space(8.0);
        ui.label(job(paragraph, 13.5, TEXT, width));
    }
    ui.add_space(14.0);
    let line = ui.cursor().top();
    let left = ui.cursor().left();
    ui.painter()
        .hline(left..=left + width, line, Stroke::new(1.0, EDGE));
    ui.add_space(10.0);
    ui.label(job(&step.question.words, 14.5, TEXT, width));
    ui.add_space(8.0);
    let asked = match &step.question.answer {
        Answer::Choice { choices, right } => choose(ui, session, &given, choices, *right),
        Answer::Number { unit, .. } => number(ui, session, &given, unit),
    };
    request = asked.or(request);
    if keys {
        let size = vec2(width, keypad_height(session));
        let (room, _) = ui.allocate_exact_size(size, Sense::hover());
        request = keypad(ui, room).or(request);
    }
    request = reply(ui, &given, step).or(request);
    ui.add_space(12.0);
    request
}

/// Draws the steps of the lesson as a row of numbers, between which a click changes.
fn stations(ui: &mut Ui, session: &Session, lesson: &Lesson) -> Option<LessonRequest> {
    let lessons = &session.panel.lessons;
    let size = HEIGHTS[usize::from(session.readings.touch)] - 4.0;
    let (row, _) = ui.allocate_exact_size(vec2(ui.available_width(), size), Sense::hover());
    let mut request = None;
    for k in 0..lesson.steps.len() {
        let at = pos2(row.left() + (size + 16.0) * k as f32, row.top());
        let rect = Rect::from_min_size(at, vec2(size, size));
        let response = ui.interact(rect, Id::unique(("station", k)), Sense::click());
        let (painter, middle) = (ui.painter(), rect.center());
        let (is_done, is_shown) = (lessons.is_done(lessons.chosen, k), lessons.step == Some(k));
        if k + 1 < lesson.steps.len() {
            let line = rect.right() + 3.0..=rect.right() + 13.0;
            painter.hline(line, middle.y, Stroke::new(1.2, TRACK));
        }
        let (fill, ink) = match (is_shown, is_done, response.hovered()) {
            (true, ..) => (INK, Color32::WHITE),
            (_, _, true) => (HOVERED, TEXT),
            (_, true, _) => (CHOSEN, INK),
            _ => (CARD, FAINT),
        };
        let stroke = Stroke::new(1.0, if is_done { INK } else { EDGE });
        painter.circle(middle, 0.42 * size, fill, stroke);
        let words = if is_done && !is_shown {
            SAFE.symbol().to_string()
        } else {
            (k + 1).to_string()
        };
        let font = FontId::proportional(13.0);
        painter.text(middle, Align2::CENTER_CENTER, words, font, ink);
        if response
            .on_hover_cursor(CursorIcon::PointingHand)
            .on_hover_text(&lesson.steps[k].title)
            .clicked()
        {
            request = Some(LessonRequest::Open(lessons.chosen, k));
        }
    }
    request
}

/// Draws words on a card of the whole width.
fn card(ui: &mut Ui, words: &str, colour: Color32, size: f32) {
    let width = ui.available_width();
    let words = job(words, size, colour, width - 20.0);
    let galley = ui.painter().layout_job(words);
    let (rect, _) = ui.allocate_exact_size(vec2(width, galley.size().y + 12.0), Sense::hover());
    ui.painter().rect_filled(rect, 5.0, CARD);
    ui.painter()
        .galley(rect.min + vec2(10.0, 6.0), galley, colour);
}

/// Draws the choices, and returns the request of the mouse.
fn choose(
    ui: &mut Ui,
    session: &Session,
    given: &Given,
    choices: &[Choice],
    right: usize,
) -> Option<LessonRequest> {
    let least = HEIGHTS[usize::from(session.readings.touch)];
    let mut request = None;
    for (k, choice) in choices.iter().enumerate() {
        let width = ui.available_width();
        let words = job(&choice.words, 13.5, TEXT, width - 44.0);
        let galley = ui.painter().layout_job(words);
        let height = (galley.size().y + 12.0).max(least);
        let (rect, _) = ui.allocate_exact_size(vec2(width, height), Sense::hover());
        let response = ui.interact(rect, Id::unique(("choice", k)), Sense::click());
        let is_given = given.choice == Some(k);
        let is_marked = session.panel.lessons.marked == k && !given.done;
        let (fill, edge) = match (is_given, response.hovered()) {
            (true, _) => (CHOSEN, INK),
            (_, true) => (HOVERED, EDGE),
            _ if is_marked => (CARD, INK),
            _ => (CARD, EDGE),
        };
        let (painter, stroke) = (ui.painter(), Stroke::new(1.0, edge));
        painter.rect(rect, 6.0, fill, stroke, StrokeKind::Inside);
        let at = pos2(rect.left() + 16.0, rect.center().y);
        match (is_given, k == right) {
            (true, is_right) => {
                let mark = if is_right { SAFE } else { WARNING };
                let font = FontId::proportional(14.0);
                let symbol = mark.symbol();
                painter.text(at, Align2::CENTER_CENTER, symbol, font, mark.colour);
            }
            (false, _) => {
                painter.circle_stroke(at, 5.0, Stroke::new(1.4, TRACK));
            }
        }
        let top = rect.center().y - 0.5 * galley.size().y;
        painter.galley(pos2(rect.left() + 32.0, top), galley, TEXT);
        ui.add_space(5.0);
        if response.on_hover_cursor(CursorIcon::PointingHand).clicked() {
            request = Some(LessonRequest::Answer(k));
        }
    }
    request
}

/// Draws the field for a number with its button, and a keypad for fingers. Returns the request of
/// the mouse.
fn number(ui: &mut Ui, session: &Session, given: &Given, unit: &str) -> Option<LessonRequest> {
    let height = HEIGHTS[usize::from(session.readings.touch)];
    let (row, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let typing = session.panel.lessons.typing;
    let field = row.with_max_x(row.right() - CHECK_WIDTH - 8.0);
    let response = ui.interact(field, Id::unique("number"), Sense::click());
    let edge = if typing { INK } else { EDGE };
    let painter = ui.painter();
    painter.rect(
        field,
        6.0,
        Color32::WHITE,
        Stroke::new(1.2, edge),
        StrokeKind::Inside,
    );
    let write = |at, align, words: &str, colour| {
        painter.text(at, align, words, FontId::proportional(14.0), colour);
    };
    let left = field.left_center() + vec2(11.0, 0.0);
    match (&given.typed[..], typing) {
        ("", false) => write(left, Align2::LEFT_CENTER, "your answer", FAINT),
        (typed, false) => write(left, Align2::LEFT_CENTER, typed, Color32::BLACK),
        (typed, true) => {
            let is_marked = session.panel.all_marked;
            style::typed(painter, left, Align2::LEFT_CENTER, typed, is_marked);
        }
    }
    let right = field.right_center() - vec2(11.0, 0.0);
    if !unit.is_empty() {
        write(right, Align2::RIGHT_CENTER, unit, FAINT);
    }
    let place = row.with_min_x(row.right() - CHECK_WIDTH);
    let check = ui.interact(place, Id::unique("check"), Sense::click());
    let is_due = !given.typed.is_empty() && given.right.is_none();
    button(ui, place, &check, "Check", is_due);
    ui.add_space(5.0);
    let mut request = None;
    if response.on_hover_cursor(CursorIcon::Text).clicked() {
        request = Some(LessonRequest::Type(true));
    } else if check.clicked() {
        request = Some(LessonRequest::Check);
    }
    request
}

/// Returns the height of the keypad (points), which fingers have while a number is asked for.
pub fn keypad_height(session: &Session) -> f32 {
    let lessons = &session.panel.lessons;
    let asked = lessons.shown().map(|(_, step)| &step.question.answer);
    let asks_number = matches!(asked, Some(Answer::Number { .. }));
    if asks_number && session.readings.touch && !lessons.given().done {
        KEYPAD.len() as f32 * KEY_HEIGHT
    } else {
        0.0
    }
}

/// Draws the keys of numbers, if their room has a height. Returns the request of the mouse.
pub fn keypad(ui: &Ui, room: Rect) -> Option<LessonRequest> {
    let mut request = None;
    for (line, keys) in KEYPAD.iter().enumerate().filter(|_| room.height() > 0.0) {
        let size = vec2(room.width() / keys.len() as f32, KEY_HEIGHT);
        for (k, key) in keys.chars().enumerate() {
            let at = room.min + vec2(k as f32, line as f32) * size;
            let rect = Rect::from_min_size(at, size).shrink(2.0);
            let response = ui.interact(rect, Id::unique(("keypad", key)), Sense::click());
            let face = if key == '<' { ERASE } else { key };
            button(ui, rect, &response, &face.to_string(), false);
            if response.clicked() {
                request = Some(LessonRequest::Letter(Some(key).filter(|key| *key != '<')));
            }
        }
    }
    request
}

/// Draws the reply to the answer, and after several wrong ones the offer to show the right one.
/// Returns the request of the mouse.
fn reply(ui: &mut Ui, given: &Given, step: &Step) -> Option<LessonRequest> {
    let right = given.right?;
    let (mark, heading) = if right {
        (SAFE, "That is right.")
    } else {
        (WARNING, "Not quite.")
    };
    let words = match &step.question.answer {
        _ if right => &step.question.why,
        Answer::Choice { choices, .. } => choices[given.choice?].reply.as_ref()?,
        Answer::Number { .. } if given.typed.parse::<f64>().is_err() => {
            &format!("{} is no number.", given.typed)
        }
        Answer::Number { hint, .. } => hint,
    };
    let width = ui.available_width();
    ui.add_space(6.0);
    ui.label(mark.text(heading));
    ui.add_space(3.0);
    ui.label(job(words, 13.5, TEXT, width));
    if given.done || given.wrong < TRIES {
        return None;
    }
    ui.add_space(8.0);
    let (rect, response) = ui.allocate_exact_size(vec2(width, 30.0), Sense::click());
    button(ui, rect, &response, "Show the answer", false);
    response.clicked().then_some(LessonRequest::Reveal)
}
