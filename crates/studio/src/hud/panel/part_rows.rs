//! Rows of the parts of a scene: a switch, a name, and whether the part is needed.

use egui::text::{LayoutJob, TextWrapping};
use egui::{Align2, Color32, FontId, Id, Rect, Ui, pos2, vec2};

use super::super::style::{FAINT, INK, TEXT};
use super::super::widgets::{Asks, CHOSEN, ask, button, keep_in_sight, row, switch};
use crate::session::panel::{is_as_in_scene, is_in, measured, measuring_row, part_row};
use crate::session::{PanelRequest, Question, Session, Turn};

/// Height of the row of a part (points).
const HEIGHT: f32 = 36.0;
/// Height of the row that measures the parts (points).
const MEASURING_HEIGHT: f32 = 34.0;
/// Distance of the name from the left edge (points).
const NAME_LEFT: f32 = 46.0;

/// Draws the rows of the parts from the top of a room. Returns the bottom of the last row.
pub fn show(ui: &Ui, room: Rect, session: &Session) -> f32 {
    let mut top = room.top();
    let place = |top: f32, height: f32| {
        Rect::from_min_size(pos2(room.left(), top), vec2(room.width(), height))
    };
    if session.measuring.answerer.is_some() {
        measuring(ui, place(top, MEASURING_HEIGHT), session);
        top += MEASURING_HEIGHT + 6.0;
    }
    let count = session.tuning.parts.len();
    let chosen = session.panel.row.saturating_sub(part_row(0)).min(count - 1);
    for part in 0..count {
        let place = place(top, HEIGHT);
        if part == chosen {
            keep_in_sight(ui, "parts", place, part);
        }
        part_row_of(ui, place, session, part);
        top += HEIGHT;
    }
    top
}

/// Draws the row that measures the parts.
fn measuring(ui: &Ui, rect: Rect, session: &Session) {
    let place = rect.shrink2(vec2(0.0, 3.0));
    let number = measuring_row();
    let known = session.measuring.known_of(Question::Simplify);
    let progress = session.measuring.progress();
    let progress = progress.filter(|(question, ..)| *question == Question::Simplify);
    let (words, state) = match (progress, known) {
        (Some((.., true)), _) => ("stopping", String::new()),
        (Some((_, progress, _)), _) => ("stop", format!("{:.0} %", 100.0 * progress.share())),
        (None, Some(known)) if known.answer.is_err() => ("measure again", "no answer".into()),
        (None, Some(_)) => ("measure again", "Enter".into()),
        (None, None) => ("measure the parts", "Enter".into()),
    };
    if session.panel.row == number {
        let painter = ui.painter();
        painter.rect_filled(rect.expand2(vec2(6.0, -0.5)), 5.0, CHOSEN);
    }
    let about = match known.map(|known| (&known.of, &known.answer)) {
        Some((of, Ok(found))) => format!("{of}: {}{}", found.report.head, found.report.foot),
        Some((of, Err(why))) => format!("{of}: {why}"),
        None => format!("{} Key q shows the table.", Question::Simplify.about()),
    };
    let response = button(ui, place, words, &state).on_hover_text(about);
    response.asks(PanelRequest::Turn(number, Turn::Toggle));
}

/// Draws the row of a part.
fn part_row_of(ui: &Ui, rect: Rect, session: &Session, part: usize) {
    let number = part_row(part);
    let id = |what| Id::unique((what, "part", part));
    let (name, on) = (&session.tuning.parts[part].name, is_in(session, part));
    let measured = measured(session, part).and_then(in_words);
    let (chosen, about) = (session.panel.row == number, measured.as_deref());
    row(ui, rect, id("row"), chosen, || tooltip(name, about)).asks(PanelRequest::ChooseRow(number));
    let painter = ui.painter();
    let as_in_scene = is_as_in_scene(session, part);
    let write = |y: f32, words: &str, size: f32, colour: Color32| {
        let mut job =
            LayoutJob::simple_singleline(words.into(), FontId::proportional(size), colour);
        job.wrap = TextWrapping::truncate_at_width(rect.width() - NAME_LEFT);
        let galley = painter.layout_job(job);
        let at = pos2(rect.left() + NAME_LEFT, rect.top() + y);
        let place = Align2::LEFT_CENTER.anchor_size(at, galley.size());
        painter.galley(place.min, galley, colour);
    };
    write(11.5, name, 13.0, if as_in_scene { TEXT } else { INK });
    let state = match (on, &measured) {
        (_, Some(words)) => words,
        (true, None) => "in",
        (false, None) if as_in_scene => "off",
        (false, None) => "left out",
    };
    write(26.5, state, 11.5, if as_in_scene { FAINT } else { INK });
    if let Some(turn) = switch(ui, rect, id("switch"), on) {
        ask(ui, PanelRequest::Turn(number, turn));
    }
}

/// Returns a row of the table of what can be left out, without its name, in words.
fn in_words(row: &[String]) -> Option<String> {
    let [_, changes, .., saves, verdict] = row else {
        return None;
    };
    Some(match &**changes {
        "-" => verdict.clone(),
        changes => format!("{verdict}: changes {changes} m, saves {saves}"),
    })
}

/// Returns the tooltip of a part: its measured effect in words, if there is one, and the use of the
/// switch.
fn tooltip(name: &str, measured: Option<&str>) -> String {
    let measured = measured.map_or(String::new(), |words| format!("{name}: {words}.\n"));
    format!(
        "{measured}The switch leaves the part out, or brings it back, while the motion goes on."
    )
}
