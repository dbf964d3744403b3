//! The panel (key Tab): a row for each knob or each part of the scene, plots if they fit, and
//! buttons.

mod part_rows;
mod plots;

use a3_files::rounding::short;
use egui::{
    Align2, Color32, CursorIcon, FontId, Id, Rect, ScrollArea, Sense, Stroke, StrokeKind, Ui,
    UiBuilder, pos2, vec2,
};

use super::dock::Pane;
use super::style::{self, FAINT, INK, TEXT};
use super::widgets::{
    Asks, LEFT, MIDDLE, RIGHT, arrow, ask, button, columns, keep_in_sight, row, slider, switch,
    write,
};
use crate::session::WindowAction;
use crate::session::panel::{self, Knob};
use crate::session::{Dial, DialScale, PanelRequest, RunAction, Session, Turn, is_here};

pub use plots::csv;

/// The pane.
pub const PANE: Pane = Pane {
    title: "",
    action: RunAction::Panel,
    key: "Tab",
    margins: [14.0, 18.0],
    contents: show,
    width: (304.0, 460.0, 0.2),
    min_width_beside: 600.0,
    share_below: 0.5,
    narrow: Some(292.0),
};

/// Height of a row of a knob (points).
const ROW_HEIGHT: f32 = 23.0;
/// Height of the title (points).
const TITLE_HEIGHT: f32 = 36.0;
/// Distance between the titles (points).
const TITLE_GAP: f32 = 18.0;
/// Height of the buttons and their margins (points).
const BUTTONS_HEIGHT: f32 = 46.0;
/// Distance between groups of rows (points).
const GROUP_GAP: f32 = 7.0;

/// Draws the panel.
fn show(ui: &mut Ui, inner: Rect, session: &Session) {
    title(ui, inner, session);
    let room = inner.with_min_y(inner.top() + TITLE_HEIGHT);
    let room = room.with_max_y(inner.bottom() - BUTTONS_HEIGHT);
    let top = scrolled(ui, room, |ui, room| {
        if panel::shows_parts(session) {
            part_rows::show(ui, room, session)
        } else {
            knobs(ui, room, session)
        }
    });
    buttons(ui, inner, session);
    let pane = &session.runs.panes[panel::pane(session)];
    let pointer = ui.ctx().pointer_latest_pos();
    let room = room.with_min_y(top + 12.0);
    plots::draw(ui.painter(), room, &pane.samples, pointer);
}

/// Draws rows from the top of a room, in which they scroll if they do not fit. Returns the bottom
/// of the last row.
fn scrolled(ui: &mut Ui, room: Rect, rows: impl FnOnce(&Ui, Rect) -> f32) -> f32 {
    // The row under the pointer and the chosen one are wider than the room.
    let wide = room.expand2(vec2(6.0, 0.0));
    ui.scope_builder(UiBuilder::new().max_rect(wide), |ui| {
        ScrollArea::vertical()
            .id_salt("rows")
            .auto_shrink([false, false])
            .show(ui, |ui| {
                let top = ui.cursor().top();
                let bottom = rows(ui, room.translate(vec2(0.0, top - room.top())));
                ui.allocate_space(vec2(wide.width(), bottom - top));
                bottom
            })
            .inner
    })
    .inner
}

/// Draws the rows of the knobs from the top of a room. Returns the bottom of the last row.
fn knobs(ui: &Ui, room: Rect, session: &Session) -> f32 {
    let rows = panel::rows(session);
    let chosen = rows.iter().rposition(|(k, ..)| *k <= session.panel.row);
    let chosen = chosen.unwrap_or(0);
    let mut top = room.top();
    for (n, (k, knob, dial)) in rows.iter().enumerate() {
        if knob.starts_group && n > 0 {
            top += GROUP_GAP;
        }
        let place = Rect::from_min_size(pos2(room.left(), top), vec2(room.width(), ROW_HEIGHT));
        if n == chosen {
            keep_in_sight(ui, "knobs", place, *k);
        }
        let row = KnobRow {
            number: *k,
            knob,
            dial,
            chosen: n == chosen,
            typed: session.panel.typed.as_deref().filter(|_| n == chosen),
            is_marked: session.panel.all_marked,
        };
        row.show(ui, place);
        top += ROW_HEIGHT;
    }
    top
}

/// Draws the titles of the knobs and of the parts, between which a click changes.
fn title(ui: &Ui, inner: Rect, session: &Session) {
    let painter = ui.painter();
    let line = inner.top() + 19.0;
    let named = match session.runs.panes.len() {
        1 => String::new(),
        count => format!("  pane {} of {count}", panel::pane(session) + 1),
    };
    let on_parts = panel::shows_parts(session);
    let mut titles = vec![("Tuning", !on_parts, 0)];
    if !session.tuning.parts.is_empty() {
        let first = panel::numbers(session).into_iter();
        let first = first.filter(|row| *row >= panel::measuring_row()).min();
        titles.push(("Parts", on_parts, first.unwrap_or(0)));
    }
    let mut left = inner.left();
    for (name, shown, first) in titles {
        let words = format!("{name}{}", if shown { &named } else { "" });
        let font = FontId::proportional(17.0);
        let galley = painter.layout_no_wrap(words, font, if shown { TEXT } else { FAINT });
        let rect = Align2::LEFT_CENTER.anchor_size(pos2(left, line), galley.size());
        let response = ui.interact(rect, Id::unique(("title", name)), Sense::click());
        painter.galley(rect.min, galley, TEXT);
        if shown {
            let line = rect.bottom() + 1.0;
            painter.hline(rect.x_range(), line, Stroke::new(1.6, INK));
        } else {
            let response = response.on_hover_cursor(CursorIcon::PointingHand);
            response.asks(PanelRequest::ChooseRow(first));
        }
        left = rect.right() + TITLE_GAP;
    }
}

/// Draws the buttons: write a scene file, write the plots, start or stop a live film, and film the
/// last seconds.
fn buttons(ui: &Ui, inner: Rect, session: &Session) {
    let last = format!("last {} s", session.panel.film_seconds);
    let live = session.readings.film.as_ref().is_some_and(|film| film.live);
    let record = if live { "stop" } else { "film" };
    let buttons = [
        ("scene", "f", RunAction::WriteScene.into()),
        ("plots", "u", WindowAction::WritePlots.into()),
        (record, "m", WindowAction::Record.into()),
        (&last, "n", WindowAction::FilmLast.into()),
    ];
    let top = inner.bottom() - BUTTONS_HEIGHT + 8.0;
    let room = Rect::from_x_y_ranges(inner.x_range(), top..=inner.bottom() - 10.0);
    let here = buttons.into_iter().filter(|(.., action)| is_here(*action));
    for (place, (words, key, action)) in columns(room, 4, 5.0).zip(here) {
        button(ui, place, words, key).asks(action);
    }
}

/// Width of the name (points).
const NAME_WIDTH: f32 = 76.0;
/// Width of the value (points).
const VALUE_WIDTH: f32 = 76.0;

/// A row: a knob with its number in the table, and its dial.
struct KnobRow<'a> {
    number: usize,
    knob: &'a Knob,
    dial: &'a Dial,
    /// Whether keys turn the knob.
    chosen: bool,
    /// Text typed so far for the value.
    typed: Option<&'a str>,
    /// Whether that text is marked.
    is_marked: bool,
}

impl KnobRow<'_> {
    /// Draws the row.
    fn show(&self, ui: &Ui, rect: Rect) {
        let Self { number, dial, .. } = *self;
        let id = |part| Id::unique((part, number));
        let colour = if self.chosen { TEXT } else { FAINT };
        row(ui, rect, id("row"), self.chosen, || self.tooltip())
            .asks(PanelRequest::ChooseRow(number));
        let painter = ui.painter();
        let (at, name) = (rect.left_center(), self.knob.name);
        write(painter, at, LEFT, name, 12.5, colour);
        let [left, right] = [rect.left() + NAME_WIDTH, rect.right() - VALUE_WIDTH];
        let room = rect.with_min_x(left).with_max_x(right - 4.0);
        let turn = match dial.scale {
            DialScale::Choice(_) => choice(ui, rect.with_min_x(left - 18.0), id, dial),
            DialScale::Switch => switch(ui, room, id("dial"), dial.value != 0.0),
            _ => slider(ui, room, id("dial"), dial),
        };
        if !matches!(dial.scale, DialScale::Choice(_)) {
            self.value(ui, rect.with_min_x(right), id("value"));
        }
        if let Some(turn) = turn {
            ask(ui, PanelRequest::Turn(number, turn));
        }
    }

    /// Draws the value, or the text typed for it. A click starts typing, and a double click
    /// restores the scene's own value.
    fn value(&self, ui: &Ui, rect: Rect, id: Id) {
        let dial = self.dial;
        let response = ui.interact(rect, id, Sense::click());
        let typeable = dial.scale.ends().is_some();
        if typeable && response.hovered() {
            ui.set_cursor_icon(CursorIcon::Text);
        }
        let painter = ui.painter();
        if let Some(typed) = self.typed {
            let field = rect.expand2(vec2(4.0, -1.0));
            let stroke = Stroke::new(1.2, INK);
            painter.rect(field, 3.0, Color32::WHITE, stroke, StrokeKind::Inside);
            let right = field.right_center() - vec2(4.0, 0.0);
            style::typed(painter, right, RIGHT, typed, self.is_marked);
        } else {
            let (at, colour) = (rect.right_center(), ink(dial));
            write(painter, at, RIGHT, &dial.words, 13.0, colour);
        }
        let response = response.on_hover_text(self.tooltip());
        if response.double_clicked() {
            ask(ui, PanelRequest::Turn(self.number, Turn::Own));
        } else if typeable {
            response.asks(PanelRequest::Type(self.number));
        }
    }

    /// Returns the tooltip: the knob's description, range and use.
    fn tooltip(&self) -> String {
        let dial = self.dial;
        let Some([from, to]) = dial.scale.ends() else {
            return self.knob.about.into();
        };
        let [from, to, own] = [from, to, dial.own].map(|value| short(value, 4));
        format!(
            "{}\nFrom {from} to {to}; initially {own}.\nClick the value to type another, double-click it to restore \
             the initial one.",
            self.knob.about
        )
    }
}

/// Draws the chosen value between arrows to the previous and the next one. Returns the turn by the
/// mouse.
fn choice(ui: &Ui, room: Rect, id: impl Fn(&'static str) -> Id, dial: &Dial) -> Option<Turn> {
    let mut turn = None;
    for (part, at, up) in [
        ("before", room.left_center() + vec2(8.0, 0.0), false),
        ("after", room.right_center() - vec2(8.0, 0.0), true),
    ] {
        let rect = Rect::from_center_size(at, vec2(20.0, room.height()));
        let response = ui.interact(rect, id(part), Sense::click());
        let stroke = Stroke::new(1.6, if response.hovered() { TEXT } else { INK });
        arrow(ui, at, !up, stroke);
        if response.clicked() {
            turn = Some(Turn::By { up, other: false });
        }
    }
    let (painter, at) = (ui.painter(), room.center());
    write(painter, at, MIDDLE, &dial.words, 13.0, ink(dial));
    turn
}

/// Returns the colour of a value, which stands out if it is not the scene's own.
fn ink(dial: &Dial) -> Color32 {
    if dial.value == dial.own { TEXT } else { INK }
}

#[cfg(test)]
mod tests;
