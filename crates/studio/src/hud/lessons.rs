//! The pane of lessons (key F1): the list of lessons with the progress in each, and a step: what
//! runs, what to look at, the question, and the reply to an answer.

use a3_files::lessons::{ALL, Answer, Choice, Lesson, Step};
use egui::text::{LayoutJob, TextFormat};
use egui::{
    Color32, CornerRadius, CursorIcon, FontId, Id, Painter, Pos2, Rect, ScrollArea, Sense, Stroke,
    StrokeKind, Ui, UiBuilder, pos2, vec2,
};

use super::dock::Pane;
use super::style::{self, FAINT, INK, SAFE, TEXT, WARNING};
use super::widgets::{
    Asks, CARD, CHOSEN, EDGE, HOVERED, LEFT, MIDDLE, RIGHT, TRACK, columns, due, keep_in_sight,
    write,
};
use crate::session::{Given, LessonRequest, Lessons, RunAction, Session};

/// Distance of the contents from the edges, and of the middle of the title from the top (points).
const MARGINS: [f32; 2] = [16.0, 21.0];

/// The pane.
pub const PANE: Pane = Pane {
    title: "",
    action: RunAction::Lessons,
    key: "F1",
    margins: MARGINS,
    contents: show,
    width: (330.0, 470.0, 0.3),
    min_width_beside: 600.0,
    share_below: 0.47,
    narrow: Some(236.0),
};

/// Height of the heading (points).
const HEADING_HEIGHT: f32 = 44.0;
/// Width of the button that closes the lessons (points).
const CLOSE_WIDTH: f32 = 28.0;
/// Height of a pane whose keypad scrolls with the text (points).
const LOW: f32 = 300.0;
/// Height of the buttons and of their margins, with the mouse and with fingers (points).
const BUTTONS_HEIGHTS: [f32; 2] = [48.0, 58.0];

/// Draws the lessons: a heading, and what scrolls below it.
fn show(ui: &mut Ui, inner: Rect, session: &Session) {
    let lessons = &session.panel.lessons;
    heading(ui, inner, lessons);
    let shown = lessons.shown();
    let buttons_height = BUTTONS_HEIGHTS[usize::from(session.readings.touch)];
    let below = inner.height() > LOW;
    let keys = if below { keypad_height(session) } else { 0.0 };
    let foot = shown.map_or(8.0, |_| buttons_height + keys);
    let body = inner.with_min_y(inner.top() + HEADING_HEIGHT);
    let body = body.with_max_y(inner.bottom() - foot);
    let body = body.with_max_x(inner.right() + MARGINS[0] - 4.0);
    let salt = shown.map(|_| (lessons.chosen, lessons.step));
    ui.scope_builder(UiBuilder::new().max_rect(body), |ui| {
        ScrollArea::vertical().id_salt(("lessons", salt)).auto_shrink([false, false]).show(
            ui,
            |ui| {
                ui.set_width(inner.width());
                ui.spacing_mut().item_spacing = vec2(0.0, 0.0);
                match shown {
                    Some((lesson, shown)) => step(ui, session, lesson, shown, !below),
                    None => contents(ui, lessons),
                }
            },
        );
    });
    if shown.is_some() {
        let row = inner.with_min_y(inner.bottom() - buttons_height);
        buttons(ui, row.shrink2(vec2(0.0, 8.0)), lessons);
        let room = Rect::from_min_max(pos2(inner.left(), row.top() - keys), row.right_top());
        keypad(ui, room);
    }
}

/// Draws the title of the lesson, with the way back to the list.
fn heading(ui: &Ui, inner: Rect, lessons: &Lessons) {
    let (painter, line) = (ui.painter(), inner.top() + MARGINS[1]);
    let at = |x: f32| pos2(inner.left() + x, line);
    let Some((lesson, _)) = lessons.shown() else {
        write(painter, at(0.0), LEFT, "Lessons", 17.0, TEXT);
        return;
    };
    let font = FontId::proportional(17.0);
    let words = painter.layout_no_wrap(lesson.title.clone(), font, TEXT);
    let fit = (inner.width() - 18.0 - CLOSE_WIDTH) / words.size().x;
    let size = 17.0 * fit.min(1.0);
    let title = write(painter, at(18.0), LEFT, &lesson.title, size, TEXT);
    let way = Rect::from_center_size(at(5.0), vec2(34.0, 34.0)).union(title);
    let response = ui.interact(way, Id::unique("back to the lessons"), Sense::click());
    let stroke = Stroke::new(1.8, if response.hovered() { TEXT } else { INK });
    let points = [(7.0, -5.5), (1.5, 0.0), (7.0, 5.5)].map(|(x, y)| at(x) + vec2(0.0, y));
    painter.add(egui::Shape::line(points.to_vec(), stroke));
    let response = response.on_hover_cursor(CursorIcon::PointingHand).on_hover_text("All lessons");
    response.asks(LessonRequest::Contents);
}

/// Draws the buttons that go back, run the step again, and go on.
fn buttons(ui: &Ui, row: Rect, lessons: &Lessons) {
    let all = [
        ("Back", lessons.previous(), false),
        ("Run again", LessonRequest::Again, false),
        ("Next", lessons.next(), lessons.given().done),
    ];
    for (place, (words, wish, is_due)) in columns(row, 3, 6.0).zip(all) {
        due(ui, place, words, is_due).asks(wish);
    }
}

/// Width of the numbers (points).
const NUMBER_WIDTH: f32 = 26.0;
/// Radius of a dot of the progress, and the distance between dots (points).
const DOT: (f32, f32) = (3.6, 11.0);

/// Draws the list.
fn contents(ui: &mut Ui, lessons: &Lessons) {
    let width = ui.available_width();
    let intro = "Each step runs a scene beside this text and asks what you see.";
    ui.label(job(intro, 13.0, FAINT, width));
    ui.add_space(8.0);
    for (k, lesson) in ALL.iter().enumerate() {
        entry(ui, lessons, k, lesson);
    }
}

/// Draws a lesson.
fn entry(ui: &mut Ui, lessons: &Lessons, number: usize, lesson: &Lesson) {
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
        Color32::TRANSPARENT
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
    let response = response.on_hover_cursor(CursorIcon::PointingHand);
    response.asks(LessonRequest::Open(number, lessons.next_step(number)));
}

/// Draws a dot: full if its step is done.
fn dot(painter: &Painter, at: Pos2, done: bool) {
    if done {
        painter.circle_filled(at, DOT.0, INK);
    } else {
        painter.circle_stroke(at, DOT.0 - 0.6, Stroke::new(1.2, TRACK));
    }
}

/// Lays out words in a colour, in lines of a width. Code and emphasised words stand out, without
/// their marks.
pub fn job(words: &str, size: f32, colour: Color32, width: f32) -> LayoutJob {
    let mut job = LayoutJob::default();
    job.wrap.max_width = width;
    let line_height = Some((1.36 * size).round());
    let mut add = |part: &str, colour| {
        let format =
            TextFormat { line_height, ..TextFormat::simple(FontId::proportional(size), colour) };
        job.append(part, 0.0, format);
    };
    for (k, part) in words.split('`').enumerate() {
        if k % 2 == 1 {
            add(part, INK);
            continue;
        }
        for (k, part) in part.replace("**", "*").split('*').enumerate() {
            add(part, if k % 2 == 1 { INK } else { colour });
        }
    }
    job
}

/// Number of wrong answers after which the right one can be shown.
const TRIES: u32 = 2;
/// Width of the button that checks a number (points).
const CHECK_WIDTH: f32 = 84.0;
/// Heights of a button, with the mouse and with fingers (points).
const HEIGHTS: [f32; 2] = [32.0, 42.0];
/// The keys of the keypad, for fingers; `<` erases.
const KEYPAD: [&str; 2] = ["12345-<", "67890.e"];
/// The face of the key that erases.
const ERASE: char = '⬅';
/// Height of a key (points).
const KEY_HEIGHT: f32 = 42.0;

/// Draws a step, with the keypad if `keys`.
fn step(ui: &mut Ui, session: &Session, lesson: &Lesson, shown: &Step, keys: bool) {
    let (lessons, width) = (&session.panel.lessons, ui.available_width());
    let given = lessons.given();
    stations(ui, session, lesson);
    ui.add_space(10.0);
    ui.label(job(&shown.title, 15.5, TEXT, width));
    ui.add_space(7.0);
    card(ui, &shown.run, INK, 12.5);
    for paragraph in &shown.look {
        ui.add_space(8.0);
        ui.label(job(paragraph, 13.5, TEXT, width));
    }
    ui.add_space(14.0);
    let line = ui.cursor().top();
    let left = ui.cursor().left();
    ui.painter().hline(left..=left + width, line, Stroke::new(1.0, EDGE));
    ui.add_space(10.0);
    ui.label(job(&shown.question.words, 14.5, TEXT, width));
    ui.add_space(8.0);
    match &shown.question.answer {
        Answer::Choice { choices, right } => choose(ui, session, &given, choices, *right),
        Answer::Number { unit, .. } => number(ui, session, &given, unit),
    }
    if keys {
        let size = vec2(width, keypad_height(session));
        let (room, _) = ui.allocate_exact_size(size, Sense::hover());
        keypad(ui, room);
    }
    reply(ui, &given, shown);
    ui.add_space(12.0);
}

/// Draws the steps of the lesson as a row of numbers, between which a click changes.
fn stations(ui: &mut Ui, session: &Session, lesson: &Lesson) {
    let lessons = &session.panel.lessons;
    let size = HEIGHTS[usize::from(session.readings.touch)] - 4.0;
    let (row, _) = ui.allocate_exact_size(vec2(ui.available_width(), size), Sense::hover());
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
        let words =
            if is_done && !is_shown { SAFE.symbol.to_string() } else { (k + 1).to_string() };
        write(painter, middle, MIDDLE, words, 13.0, ink);
        response
            .on_hover_cursor(CursorIcon::PointingHand)
            .on_hover_text(&lesson.steps[k].title)
            .asks(LessonRequest::Open(lessons.chosen, k));
    }
}

/// Draws words on a card of the whole width.
fn card(ui: &mut Ui, words: &str, colour: Color32, size: f32) {
    let width = ui.available_width();
    let words = job(words, size, colour, width - 20.0);
    let galley = ui.painter().layout_job(words);
    let (rect, _) = ui.allocate_exact_size(vec2(width, galley.size().y + 12.0), Sense::hover());
    ui.painter().rect_filled(rect, 5.0, CARD);
    ui.painter().galley(rect.min + vec2(10.0, 6.0), galley, colour);
}

/// Draws the choices.
fn choose(ui: &mut Ui, session: &Session, given: &Given, choices: &[Choice], right: usize) {
    let least = HEIGHTS[usize::from(session.readings.touch)];
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
        if is_given {
            let mark = if k == right { SAFE } else { WARNING };
            write(painter, at, MIDDLE, mark.symbol, 14.0, mark.colour);
        } else {
            painter.circle_stroke(at, 5.0, Stroke::new(1.4, TRACK));
        }
        let top = rect.center().y - 0.5 * galley.size().y;
        painter.galley(pos2(rect.left() + 32.0, top), galley, TEXT);
        ui.add_space(5.0);
        let response = response.on_hover_cursor(CursorIcon::PointingHand);
        response.asks(LessonRequest::Answer(k));
    }
}

/// Draws the field for a number with its button, and a keypad for fingers.
fn number(ui: &mut Ui, session: &Session, given: &Given, unit: &str) {
    let height = HEIGHTS[usize::from(session.readings.touch)];
    let (row, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let typing = session.panel.lessons.typing;
    let field = row.with_max_x(row.right() - CHECK_WIDTH - 8.0);
    let response = ui.interact(field, Id::unique("number"), Sense::click());
    let edge = if typing { INK } else { EDGE };
    let painter = ui.painter();
    let stroke = Stroke::new(1.2, edge);
    painter.rect(field, 6.0, Color32::WHITE, stroke, StrokeKind::Inside);
    let left = field.left_center() + vec2(11.0, 0.0);
    let (typed, colour) = match &given.typed[..] {
        "" => ("your answer", FAINT),
        typed => (typed, Color32::BLACK),
    };
    if typing {
        let is_marked = session.panel.all_marked;
        style::typed(painter, left, LEFT, &given.typed, is_marked);
    } else {
        write(painter, left, LEFT, typed, 14.0, colour);
    }
    let right = field.right_center() - vec2(11.0, 0.0);
    write(painter, right, RIGHT, unit, 14.0, FAINT);
    let place = row.with_min_x(row.right() - CHECK_WIDTH);
    let is_due = !given.typed.is_empty() && given.right.is_none();
    due(ui, place, "Check", is_due).asks(LessonRequest::Check);
    ui.add_space(5.0);
    let response = response.on_hover_cursor(CursorIcon::Text);
    response.asks(LessonRequest::Type(true));
}

/// Returns the height of the keypad (points), which fingers have while a number is asked for.
fn keypad_height(session: &Session) -> f32 {
    let lessons = &session.panel.lessons;
    let asked = lessons.shown().map(|(_, step)| &step.question.answer);
    let asks_number = matches!(asked, Some(Answer::Number { .. }));
    if asks_number && session.readings.touch && !lessons.given().done {
        KEYPAD.len() as f32 * KEY_HEIGHT
    } else {
        0.0
    }
}

/// Draws the keys of numbers, if their room has a height.
fn keypad(ui: &Ui, room: Rect) {
    for (line, keys) in KEYPAD.iter().enumerate().filter(|_| room.height() > 0.0) {
        let size = vec2(room.width() / keys.len() as f32, KEY_HEIGHT);
        for (k, key) in keys.chars().enumerate() {
            let at = room.min + vec2(k as f32, line as f32) * size;
            let rect = Rect::from_min_size(at, size).shrink(2.0);
            let face = if key == '<' { ERASE } else { key };
            let letter = Some(key).filter(|key| *key != '<');
            due(ui, rect, &face.to_string(), false).asks(LessonRequest::Letter(letter));
        }
    }
}

/// Draws the reply to the answer, if there is one, and after several wrong ones the offer to show
/// the right one.
fn reply(ui: &mut Ui, given: &Given, step: &Step) {
    let Some((right, words)) = given.right.zip(words_of_reply(given, step)) else {
        return;
    };
    let (mark, heading) = if right { (SAFE, "That is right.") } else { (WARNING, "Not quite.") };
    let width = ui.available_width();
    ui.add_space(6.0);
    ui.label(mark.text(heading));
    ui.add_space(3.0);
    ui.label(job(&words, 13.5, TEXT, width));
    if !given.done && given.wrong >= TRIES {
        ui.add_space(8.0);
        let (rect, _) = ui.allocate_exact_size(vec2(width, 30.0), Sense::hover());
        due(ui, rect, "Show the answer", false).asks(LessonRequest::Reveal);
    }
}

/// Returns the words of the reply to an answer.
fn words_of_reply(given: &Given, step: &Step) -> Option<String> {
    Some(match &step.question.answer {
        _ if given.right? => step.question.why.clone(),
        Answer::Choice { choices, .. } => choices[given.choice?].reply.clone()?,
        Answer::Number { .. } if given.typed.parse::<f64>().is_err() => {
            format!("{} is no number.", given.typed)
        }
        Answer::Number { hint, .. } => hint.clone(),
    })
}

#[cfg(test)]
mod tests;
