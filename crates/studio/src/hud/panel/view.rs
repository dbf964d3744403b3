//! Drawing of the panel: a row for each knob, plots if they fit, and buttons.

use egui::{
    Align2, Context, FontId, Id, Rect, ScrollArea, Sense, Stroke, Ui, UiBuilder, pos2, vec2,
};

use super::super::docked::{Place, close, docked, keep_in_sight};
use super::super::style::{FAINT, TEXT};
use super::request::{self, PanelRequest, Request, is_shown, rows};
use super::row::{self, Row};
use super::values::pane;
use super::{part_rows, plots};
use crate::session::{Action, RunAction, Session, WindowAction};

/// The place of the panel.
pub(super) const PLACE: Place = Place {
    width: (304.0, 460.0, 0.2),
    min_width_beside: 600.0,
    share_below: 0.5,
    narrow: Some(292.0),
};
/// Distance of the rows from the edges of the panel (points).
pub(super) const MARGIN: f32 = 14.0;
/// Height of the title (points).
const TITLE_HEIGHT: f32 = 36.0;
/// Distance between the titles (points).
const TITLE_GAP: f32 = 18.0;
/// Height of the buttons and their margins (points).
const BUTTONS_HEIGHT: f32 = 46.0;
/// The action that closes the panel.
const CLOSE: Action = Action::Run(RunAction::Panel);
/// Distance between groups of rows (points).
const GROUP_GAP: f32 = 7.0;

/// Returns the place of the panel, if it is visible.
pub fn place(session: &Session) -> Option<&'static Place> {
    is_shown(session).then_some(&PLACE)
}

/// Draws the panel, if it is visible, and returns the request of the mouse.
pub fn show(ctx: &Context, session: &Session) -> Option<Request> {
    let rect = place(session)?.rect(ctx);
    docked(ctx, "panel", rect, |ui| {
        let inner = rect.shrink2(vec2(MARGIN, 0.0));
        let heading = inner.with_max_y(inner.top() + TITLE_HEIGHT);
        let closed = close(ui, heading, "Tab").then_some(Request::Act(CLOSE));
        let request = title(ui, inner, session).map(Request::Change).or(closed);
        let room = Rect::from_min_max(
            pos2(inner.left(), inner.top() + TITLE_HEIGHT),
            pos2(inner.right(), inner.bottom() - BUTTONS_HEIGHT),
        );
        let (top, turned) = scrolled(ui, room, |ui, room| {
            if request::shows_parts(session) {
                part_rows::show(ui, room, session)
            } else {
                knobs(ui, room, session)
            }
        });
        let request = turned.map(Request::Change).or(request);
        let request = buttons(ui, inner, session).or(request);
        let room = Rect::from_min_max(
            pos2(inner.left(), top + 12.0),
            pos2(inner.right(), inner.bottom() - BUTTONS_HEIGHT),
        );
        let pane = &session.runs.panes[pane(session)];
        let pointer = ui.ctx().pointer_latest_pos();
        plots::draw(ui.painter(), room, &pane.samples, pointer);
        request
    })
}

/// Draws rows from the top of a room, in which they scroll if they do not fit. Returns the bottom
/// of the last row, and the request of the mouse.
fn scrolled(
    ui: &mut Ui,
    room: Rect,
    rows: impl FnOnce(&Ui, Rect) -> (f32, Option<PanelRequest>),
) -> (f32, Option<PanelRequest>) {
    // The row under the pointer and the chosen one are wider than the room.
    let wide = room.expand2(vec2(6.0, 0.0));
    ui.scope_builder(UiBuilder::new().max_rect(wide), |ui| {
        ScrollArea::vertical()
            .id_salt("rows")
            .auto_shrink([false, false])
            .show(ui, |ui| {
                let top = ui.cursor().top();
                let (bottom, request) = rows(ui, room.translate(vec2(0.0, top - room.top())));
                ui.allocate_space(vec2(wide.width(), bottom - top));
                (bottom, request)
            })
            .inner
    })
    .inner
}

/// Draws the rows of the knobs from the top of a room. Returns the bottom of the last row, and the
/// request of the mouse.
fn knobs(ui: &Ui, room: Rect, session: &Session) -> (f32, Option<PanelRequest>) {
    let mut request = None;
    let rows = rows(session);
    let chosen = rows.iter().rposition(|(k, ..)| *k <= session.panel.row);
    let chosen = chosen.unwrap_or(0);
    let mut top = room.top();
    for (n, (k, knob, dial)) in rows.iter().enumerate() {
        if knob.starts_group && n > 0 {
            top += GROUP_GAP;
        }
        let place = Rect::from_min_size(pos2(room.left(), top), vec2(room.width(), row::HEIGHT));
        if n == chosen {
            keep_in_sight(ui, "knobs", place, *k);
        }
        let row = Row {
            number: *k,
            knob,
            dial,
            chosen: n == chosen,
            typed: session.panel.typed.as_deref().filter(|_| n == chosen),
            is_marked: session.panel.all_marked,
        };
        request = row.show(ui, place).or(request);
        top += row::HEIGHT;
    }
    (top, request)
}

/// Draws the titles of the knobs and of the parts, between which a click changes. Returns the
/// request of the mouse.
fn title(ui: &Ui, inner: Rect, session: &Session) -> Option<PanelRequest> {
    let painter = ui.painter();
    let line = inner.top() + 19.0;
    let named = match session.runs.panes.len() {
        1 => String::new(),
        count => format!("  pane {} of {count}", pane(session) + 1),
    };
    let on_parts = request::shows_parts(session);
    let mut titles = vec![("Tuning", !on_parts, 0)];
    if !session.tuning.parts.is_empty() {
        let first = request::numbers(session).into_iter();
        let first = first.filter(|row| *row >= request::measuring_row()).min();
        titles.push(("Parts", on_parts, first.unwrap_or(0)));
    }
    let (mut left, mut request) = (inner.left(), None);
    for (name, shown, first) in titles {
        let words = format!("{name}{}", if shown { &named } else { "" });
        let font = FontId::proportional(17.0);
        let galley = painter.layout_no_wrap(words, font, if shown { TEXT } else { FAINT });
        let rect = Align2::LEFT_CENTER.anchor_size(pos2(left, line), galley.size());
        let response = ui.interact(rect, Id::unique(("title", name)), Sense::click());
        painter.galley(rect.min, galley, TEXT);
        if shown {
            let line = rect.bottom() + 1.0;
            painter.hline(rect.x_range(), line, Stroke::new(1.6, row::INK));
        } else if response
            .on_hover_cursor(egui::CursorIcon::PointingHand)
            .clicked()
        {
            request = Some(PanelRequest::ChooseRow(first));
        }
        left = rect.right() + TITLE_GAP;
    }
    request
}

/// Draws the buttons: write a scene file, write the plots, start or stop a live film, and film the
/// last seconds.
fn buttons(ui: &Ui, inner: Rect, session: &Session) -> Option<Request> {
    let last = format!("last {} s", session.panel.film_seconds);
    let live = session.readings.film.as_ref().is_some_and(|film| film.live);
    let record = if live { "stop" } else { "film" };
    let buttons = [
        ("scene", "f", Action::Run(RunAction::WriteScene)),
        ("plots", "u", Action::Window(WindowAction::WritePlots)),
        (record, "m", Action::Window(WindowAction::Record)),
        (&last, "n", Action::Window(WindowAction::FilmLast)),
    ];
    let gap = 5.0;
    let width = (inner.width() - 3.0 * gap) / 4.0;
    let mut request = None;
    for (k, (words, key, action)) in buttons.into_iter().enumerate() {
        let left = inner.left() + k as f32 * (width + gap);
        let rect = Rect::from_min_max(
            pos2(left, inner.bottom() - BUTTONS_HEIGHT + 8.0),
            pos2(left + width, inner.bottom() - 10.0),
        );
        let response = ui.interact(rect, Id::unique(("button", k)), Sense::click());
        row::button(ui, rect, &response, words, key);
        request = response
            .clicked()
            .then_some(Request::Act(action))
            .or(request);
    }
    request
}
