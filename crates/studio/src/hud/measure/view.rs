//! The pane of questions: a button for each, what it is asked about, and its answer.

use egui::{Align2, Color32, Context, FontId, Id, Rect, Sense, Ui, pos2, vec2};

use super::super::docked::{Place, close, docked};
use super::super::panel::{PanelRequest, Request, button};
use super::super::style::{FAINT, TEXT};
use super::answer;
use super::chip::{INK, chip};
use crate::session::{IS_PAGE, MeasureRequest, Progress, Question, Session};

/// The place of the pane.
const PLACE: Place = Place {
    width: (420.0, 860.0, 0.46),
    min_width_beside: 700.0,
    share_below: 0.62,
    narrow: None,
};
/// Distance of the contents from the edges (points).
const MARGIN: f32 = 16.0;
/// Height of the title, of a row of buttons, and distance between rows (points).
const HEIGHTS: [f32; 3] = [38.0, 28.0, 7.0];
/// Width of the pane above which the questions are in one row (points).
const ONE_ROW_WIDTH: f32 = 640.0;
/// Width of all settings (points).
const SETTINGS_WIDTH: f32 = 322.0;
/// Smallest and largest width of the button that measures (points).
const BUTTON_WIDTHS: [f32; 2] = [92.0, 108.0];
/// Colour of the track of a progress.
const TRACK: Color32 = Color32::from_rgb(200, 202, 207);

/// Returns the place of the pane, if it is visible: it is open, and the help does not hide it. A
/// page has none.
pub fn place(session: &Session) -> Option<&'static Place> {
    (!IS_PAGE && session.measuring.open && !session.readings.help).then_some(&PLACE)
}

/// Draws the pane, if it is visible, and returns the request of the mouse.
pub fn show(ctx: &Context, session: &Session) -> Option<Request> {
    let rect = place(session)?.rect(ctx);
    let request = docked(ctx, "measure", rect, |ui| {
        ui.set_clip_rect(rect);
        contents(ui, rect.shrink2(vec2(MARGIN, 0.0)), session)
    });
    request.map(|request| Request::Change(PanelRequest::Measure(request)))
}

/// Draws all rows from the top of a room. Returns the request of the mouse.
fn contents(ui: &mut Ui, room: Rect, session: &Session) -> Option<MeasureRequest> {
    let [heading, row, gap] = HEIGHTS;
    let mut top = room.top();
    let mut next = |height: f32| {
        let place = Rect::from_min_size(pos2(room.left(), top), vec2(room.width(), height));
        top += height + gap;
        place
    };
    let mut request = head(ui, next(heading - gap));
    let columns = if room.width() > ONE_ROW_WIDTH { 4 } else { 2 };
    for questions in Question::ALL.chunks(columns) {
        request = tabs(ui, next(row), session, questions).or(request);
    }
    request = settings(ui, next(row), session).or(request);
    let measuring = &session.measuring;
    let going = measuring.progress();
    if let Some((question, progress, stopping)) = &going {
        bar(ui, next(row), *question, progress, *stopping);
    }
    let known = measuring.known();
    if let Some(known) = known {
        let line = next(14.0);
        let font = FontId::proportional(12.5);
        let at = line.left_center();
        let painter = ui.painter().with_clip_rect(line.expand(4.0));
        painter.text(at, Align2::LEFT_CENTER, &known.of, font, FAINT);
    }
    let below = pos2(room.right(), room.bottom() - 10.0);
    let room = Rect::from_min_max(pos2(room.left(), top), below);
    match known.map(|known| &known.answer) {
        Some(Ok(found)) => {
            let panes = session.runs.panes.iter().map(|pane| &pane.simulation);
            let shown: Vec<_> = panes.map(|run| (run.method(), run.control())).collect();
            request = answer::show(ui, room, found, &shown).or(request);
        }
        Some(Err(why)) => answer::say(ui, room, why),
        None => answer::say(ui, room, measuring.question.about()),
    }
    request
}

/// Draws the title, and a button that hides the pane.
fn head(ui: &Ui, rect: Rect) -> Option<MeasureRequest> {
    let painter = ui.painter();
    let font = FontId::proportional(17.0);
    painter.text(
        rect.left_center() + vec2(0.0, 2.0),
        Align2::LEFT_CENTER,
        "Measure",
        font,
        TEXT,
    );
    close(ui, rect.translate(vec2(0.0, 2.0)), "q").then_some(MeasureRequest::Close)
}

/// Draws a row of questions. Returns the request of the mouse.
fn tabs(ui: &Ui, rect: Rect, session: &Session, of: &[Question]) -> Option<MeasureRequest> {
    let gap = 6.0;
    let width = (rect.width() - gap * (of.len() - 1) as f32) / of.len() as f32;
    let mut request = None;
    for (k, question) in of.iter().enumerate() {
        let left = rect.left() + k as f32 * (width + gap);
        let place = Rect::from_min_size(pos2(left, rect.top()), vec2(width, rect.height()));
        let chosen = session.measuring.question == *question;
        if choice(ui, place, question.words(), chosen) {
            request = Some(MeasureRequest::Ask(*question));
        }
    }
    request
}

/// Draws a button that is chosen or not, and returns whether it was clicked.
fn choice(ui: &Ui, rect: Rect, words: &str, chosen: bool) -> bool {
    let response = ui.interact(rect, Id::unique(("choice", words)), Sense::click());
    chip(ui, rect, &response, words, chosen);
    response.clicked()
}

/// Draws what the question depends on, and the button that measures or stops.
fn settings(ui: &Ui, rect: Rect, session: &Session) -> Option<MeasureRequest> {
    let measuring = &session.measuring;
    let mut request = None;
    let mut left = rect.left();
    // In a narrow pane, all is narrower.
    let fit = ((rect.width() - BUTTON_WIDTHS[0] - 6.0) / SETTINGS_WIDTH).min(1.0);
    let mut place = |width: f32| {
        let size = vec2(fit * width, rect.height());
        let place = Rect::from_min_size(pos2(left, rect.top()), size);
        left += size.x;
        place
    };
    for (words, on) in [("from now", false), ("the start", true)] {
        if choice(
            ui,
            place(78.0).shrink(1.0),
            words,
            measuring.from_start == on,
        ) {
            request = Some(MeasureRequest::FromStart(on));
        }
    }
    place(10.0);
    match measuring.question {
        Question::Chart => {
            for (words, on) in [("work", false), ("time", true)] {
                if choice(ui, place(54.0).shrink(1.0), words, measuring.timed == on) {
                    request = Some(MeasureRequest::Timed(on));
                }
            }
        }
        Question::Choose | Question::Simplify => {
            for (words, finer) in [("−", true), ("+", false)] {
                if finer {
                    let at = place(42.0).left_center() + vec2(2.0, 0.0);
                    let font = FontId::proportional(13.0);
                    ui.painter()
                        .text(at, Align2::LEFT_CENTER, "error", font, FAINT);
                }
                if choice(ui, place(26.0).shrink(1.0), words, false) {
                    request = Some(MeasureRequest::Error { finer });
                }
                if finer {
                    let at = place(62.0).center();
                    let font = FontId::proportional(13.0);
                    let words = format!("1e-{} m", measuring.digits);
                    ui.painter()
                        .text(at, Align2::CENTER_CENTER, words, font, TEXT);
                }
            }
        }
        Question::Stability => {}
    }
    let [least, most] = BUTTON_WIDTHS;
    let width = (rect.right() - place(6.0).right()).clamp(least, most);
    let place = Rect::from_min_max(pos2(rect.right() - width, rect.top()), rect.max);
    let response = ui.interact(place, Id::unique("measure it"), Sense::click());
    let words = match (measuring.progress(), measuring.known()) {
        (Some(_), _) => "stop",
        (None, Some(_)) => "again",
        (None, None) => "measure",
    };
    button(ui, place, &response, words, "Enter");
    response
        .clicked()
        .then_some(MeasureRequest::Toggle)
        .or(request)
}

/// Draws the progress of a measurement.
fn bar(ui: &Ui, rect: Rect, question: Question, progress: &Progress, stopping: bool) {
    let painter = ui.painter();
    let track = Rect::from_min_max(pos2(rect.left(), rect.bottom() - 7.0), rect.max);
    painter.rect_filled(track, 3.5, TRACK);
    let right = track.left() + progress.share() * track.width();
    painter.rect_filled(track.with_max_x(right), 3.5, INK);
    let stage = if stopping {
        "stopping"
    } else {
        &progress.stage
    };
    let words = format!("{}  {stage}", question.words());
    let font = FontId::proportional(12.5);
    painter.text(rect.left_top(), Align2::LEFT_TOP, words, font, TEXT);
    let percent = format!("{:.0} %", 100.0 * progress.share());
    let font = FontId::proportional(12.5);
    painter.text(rect.right_top(), Align2::RIGHT_TOP, percent, font, FAINT);
}
