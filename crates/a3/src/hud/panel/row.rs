//! A row of the panel: a name, a slider, a switch or a choice, and the value.

use egui::{
    Align2, Color32, CursorIcon, FontId, Id, Rect, Response, Sense, Stroke, Ui, pos2, vec2,
};

use super::super::style::{FAINT, TEXT};
use super::dial::{Dial, DialScale, Turn};
use super::request::Request;

/// Height of a row (points).
pub const HEIGHT: f32 = 23.0;
/// Colour of the panel.
pub const SHEET: Color32 = Color32::from_rgb(226, 226, 224);
/// Colour of the panel's edge.
pub const EDGE: Color32 = Color32::from_rgb(188, 189, 192);
/// Colour of values that differ from the scene's own, and of what can be moved.
const INK: Color32 = Color32::from_rgb(38, 84, 132);
/// Colour of a track that is empty, and of a switch that is off.
const TRACK: Color32 = Color32::from_rgb(186, 188, 194);
/// Colour of the chosen row.
const CHOSEN: Color32 = Color32::from_rgb(207, 211, 218);
/// Colour of the row under the pointer.
const HOVERED: Color32 = Color32::from_rgb(217, 218, 220);

/// Width of the name (points).
const NAME: f32 = 76.0;
/// Width of the value (points).
const VALUE: f32 = 76.0;

/// Draws the row of knob k, and returns what the mouse asks for.
pub fn show(
    ui: &Ui,
    rect: Rect,
    k: usize,
    name: &str,
    dial: &Dial,
    chosen: bool,
) -> Option<Request> {
    let id = |part| Id::unique((part, k));
    let whole = ui.interact(rect.expand2(vec2(6.0, 0.0)), id("row"), Sense::click());
    let painter = ui.painter();
    if chosen || whole.hovered() {
        let colour = if chosen { CHOSEN } else { HOVERED };
        painter.rect_filled(rect.expand2(vec2(6.0, -0.5)), 5.0, colour);
    }
    let middle = rect.center().y;
    let colour = if chosen { TEXT } else { FAINT };
    let at = pos2(rect.left(), middle);
    painter.text(
        at,
        Align2::LEFT_CENTER,
        name,
        FontId::proportional(12.5),
        colour,
    );
    let mut turn = None;
    if let DialScale::Choice(_) = dial.scale {
        let room = Rect::from_x_y_ranges(rect.left() + NAME - 18.0..=rect.right(), rect.y_range());
        turn = choice(ui, room, id, dial);
    } else {
        let value = Rect::from_x_y_ranges(rect.right() - VALUE..=rect.right(), rect.y_range());
        let room = Rect::from_x_y_ranges(rect.left() + NAME..=value.left() - 4.0, rect.y_range());
        let changed = if dial.value == dial.own { TEXT } else { INK };
        let at = pos2(value.right(), middle);
        painter.text(
            at,
            Align2::RIGHT_CENTER,
            &dial.words,
            FontId::proportional(13.0),
            changed,
        );
        if ui
            .interact(value, id("value"), Sense::click())
            .double_clicked()
        {
            turn = Some(Turn::Own);
        }
        let set = if dial.scale == DialScale::Switch {
            switch(ui, room, id("dial"), dial)
        } else {
            slider(ui, room, id("dial"), dial)
        };
        turn = set.or(turn);
    }
    turn.map(|turn| Request::Turn(k, turn))
        .or_else(|| whole.clicked().then_some(Request::Choose(k)))
}

/// Draws a track with a thumb, and a mark at the scene's own value.
fn slider(ui: &Ui, room: Rect, id: Id, dial: &Dial) -> Option<Turn> {
    let response = ui.interact(room, id, Sense::click_and_drag());
    if response.hovered() || response.dragged() {
        ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    let track = room.shrink2(vec2(6.0, 0.0));
    let (painter, y) = (ui.painter(), room.center().y);
    let place = |value| track.left() + track.width() * dial.scale.share(value) as f32;
    let (thumb, own) = (place(dial.value), place(dial.own));
    let bar = |from: f32, to: f32, colour| {
        let rect = Rect::from_x_y_ranges(from..=to, y - 1.5..=y + 1.5);
        painter.rect_filled(rect, 1.5, colour);
    };
    bar(track.left(), track.right(), TRACK);
    bar(track.left(), thumb, INK);
    painter.vline(own, y - 5.0..=y + 5.0, Stroke::new(1.2, FAINT));
    let radius = if response.dragged() { 6.0 } else { 5.2 };
    painter.circle(
        pos2(thumb, y),
        radius,
        Color32::WHITE,
        Stroke::new(1.8, INK),
    );
    let held = response.dragged() || response.clicked();
    let pointer = response.interact_pointer_pos().filter(|_| held)?;
    let share = (pointer.x - track.left()) / track.width();
    Some(Turn::To(dial.scale.at(share.into())))
}

/// Draws a switch.
fn switch(ui: &Ui, room: Rect, id: Id, dial: &Dial) -> Option<Turn> {
    let size = vec2(28.0, 15.0);
    let rect = Rect::from_min_size(
        pos2(room.left() + 6.0, room.center().y - 0.5 * size.y),
        size,
    );
    let response = ui.interact(rect.expand(4.0), id, Sense::click());
    let on = dial.value != 0.0;
    let painter = ui.painter();
    painter.rect_filled(rect, 7.5, if on { INK } else { TRACK });
    let x = if on {
        rect.right() - 7.5
    } else {
        rect.left() + 7.5
    };
    painter.circle_filled(pos2(x, rect.center().y), 5.5, Color32::WHITE);
    response.clicked().then_some(Turn::Toggle)
}

/// Draws the chosen value between arrows to the one before and the one after it.
fn choice(ui: &Ui, room: Rect, id: impl Fn(&'static str) -> Id, dial: &Dial) -> Option<Turn> {
    let mut turn = None;
    for (part, x, way, up) in [
        ("before", room.left() + 8.0, 1.0, false),
        ("after", room.right() - 8.0, -1.0, true),
    ] {
        let at = pos2(x, room.center().y);
        let rect = Rect::from_center_size(at, vec2(20.0, room.height()));
        let response = ui.interact(rect, id(part), Sense::click());
        let stroke = Stroke::new(1.6, if response.hovered() { TEXT } else { INK });
        let corner = |dx: f32, dy| at + vec2(way * dx, dy);
        let points = vec![corner(2.5, -4.5), corner(-2.0, 0.0), corner(2.5, 4.5)];
        ui.painter().add(egui::Shape::line(points, stroke));
        if response.clicked() {
            turn = Some(Turn::By { up, other: false });
        }
    }
    let colour = if dial.value == dial.own { TEXT } else { INK };
    ui.painter().text(
        room.center(),
        Align2::CENTER_CENTER,
        &dial.words,
        FontId::proportional(13.0),
        colour,
    );
    turn
}

/// Draws a button with its key.
pub fn button(ui: &Ui, rect: Rect, response: &Response, words: &str, key: &str) {
    let painter = ui.painter();
    let fill = if response.is_pointer_button_down_on() {
        CHOSEN
    } else if response.hovered() {
        HOVERED
    } else {
        SHEET
    };
    painter.rect(
        rect,
        6.0,
        fill,
        Stroke::new(1.0, EDGE),
        egui::StrokeKind::Inside,
    );
    let font = || FontId::proportional(13.0);
    let at = pos2(rect.left() + 10.0, rect.center().y);
    painter.text(at, Align2::LEFT_CENTER, words, font(), TEXT);
    let at = pos2(rect.right() - 10.0, rect.center().y);
    painter.text(
        at,
        Align2::RIGHT_CENTER,
        key,
        FontId::proportional(12.5),
        FAINT,
    );
}
