//! Rows of the parts of a scene: a switch, a name, and what the part costs and changes.

use a3_files::rounding::short;
use egui::{Id, Rect, Sense, Ui, pos2, vec2};

use super::super::style::{FAINT, INK, TEXT};
use super::super::widgets::{CHOSEN, HOVERED, LEFT, button, keep_in_sight, switch, write};
use crate::session::panel::{can_measure, measuring_row, part_row};
use crate::session::panel::{effect_in_words, is_as_in_scene, is_in};
use crate::session::{PanelRequest, Session, Turn};

/// Height of the row of a part (points).
const HEIGHT: f32 = 36.0;
/// Height of the row that measures the parts (points).
const MEASURING_HEIGHT: f32 = 34.0;
/// Distance of the name from the left edge (points).
const NAME_LEFT: f32 = 46.0;

/// Draws the rows of the parts from the top of a room. Returns the bottom of the last row, and the
/// request of the mouse.
pub fn show(ui: &Ui, room: Rect, session: &Session) -> (f32, Option<PanelRequest>) {
    let mut request = None;
    let mut top = room.top();
    let place = |top: f32, height: f32| {
        Rect::from_min_size(pos2(room.left(), top), vec2(room.width(), height))
    };
    if can_measure() {
        request = measuring(ui, place(top, MEASURING_HEIGHT), session);
        top += MEASURING_HEIGHT + 6.0;
    }
    let count = session.tuning.parts.len();
    let chosen = session.panel.row.saturating_sub(part_row(0)).min(count - 1);
    for part in 0..count {
        let place = place(top, HEIGHT);
        if part == chosen {
            keep_in_sight(ui, "parts", place, part);
        }
        request = row(ui, place, session, part).or(request);
        top += HEIGHT;
    }
    (top, request)
}

/// Draws the row that measures the parts.
fn measuring(ui: &Ui, rect: Rect, session: &Session) -> Option<PanelRequest> {
    let place = rect.shrink2(vec2(0.0, 3.0));
    let (effects, number) = (&session.effects, measuring_row());
    let (words, state) = match (effects.progress(), effects.time()) {
        (Some([done, all]), _) => ("stop", format!("{done} of {all} measured")),
        (None, Some(time)) => ("measure again", format!("measured at {} s", short(time, 3))),
        (None, None) => ("measure the parts", "Enter".into()),
    };
    if session.panel.row == number {
        let painter = ui.painter();
        painter.rect_filled(rect.expand2(vec2(6.0, -0.5)), 5.0, CHOSEN);
    }
    let response = button(ui, place, words, &state).on_hover_text(
        "Measures, from the present state on, what each part costs in a step and how far it moves the particles \
         in the next seconds. Parts that are left out are measured by bringing them back.",
    );
    response
        .clicked()
        .then_some(PanelRequest::Turn(number, Turn::Toggle))
}

/// Draws the row of a part.
fn row(ui: &Ui, rect: Rect, session: &Session, part: usize) -> Option<PanelRequest> {
    let number = part_row(part);
    let id = |what| Id::unique((what, "part", part));
    let whole = ui.interact(rect.expand2(vec2(6.0, 0.0)), id("row"), Sense::click());
    let chosen = session.panel.row == number;
    let painter = ui.painter();
    if chosen || whole.hovered() {
        let colour = if chosen { CHOSEN } else { HOVERED };
        painter.rect_filled(rect.expand2(vec2(6.0, -0.5)), 5.0, colour);
    }
    let (name, on) = (&session.tuning.parts[part].name, is_in(session, part));
    let effect = session.effects.of(part).map(|it| effect_in_words(&it));
    let as_in_scene = is_as_in_scene(session, part);
    let say = |y: f32, words: &str, size: f32, colour| {
        let at = rect.min + vec2(NAME_LEFT, y);
        write(painter, at, LEFT, words, size, colour);
    };
    say(11.5, name, 13.0, if as_in_scene { TEXT } else { INK });
    let state = match (on, &effect) {
        (_, Some(effect)) => effect,
        (true, None) => "in",
        (false, None) if as_in_scene => "off",
        (false, None) => "left out",
    };
    say(26.5, state, 11.5, if as_in_scene { FAINT } else { INK });
    let turn = switch(ui, rect, id("switch"), on);
    let whole = whole.on_hover_text(tooltip(session, part, effect.as_deref()));
    turn.map(|turn| PanelRequest::Turn(number, turn))
        .or_else(|| whole.clicked().then_some(PanelRequest::ChooseRow(number)))
}

/// Returns the tooltip of a part: its effect in sentences, and the use of the switch.
fn tooltip(session: &Session, part: usize, effect: Option<&str>) -> String {
    let name = &session.tuning.parts[part].name;
    let measured = session.effects.of(part).zip(effect).map(|(it, words)| {
        let way = it.change.map_or(String::new(), |change| {
            format!(
                "\nThe distance is the root mean square over the particles, at the time in {} s when it is largest.",
                short(change.time, 2)
            )
        });
        format!("{name}: {words}.{way}\n")
    });
    format!(
        "{}The switch leaves the part out, or brings it back, while the motion goes on.",
        measured.unwrap_or_default()
    )
}
