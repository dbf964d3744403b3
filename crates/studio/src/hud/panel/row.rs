//! A row of the panel: a name, a value, and a slider, switch or choice.

use a3_files::rounding::short;
use egui::{
    Align2, Color32, CursorIcon, FontId, Id, Rect, Response, Sense, Stroke, Ui, pos2, vec2,
};

use super::super::docked::{EDGE, SHEET};
use super::super::style::{self, FAINT, TEXT};
use super::dial::{Dial, DialScale, Turn};
use super::knobs::Knob;
use super::request::PanelRequest;

/// Height of a row (points).
pub const HEIGHT: f32 = 23.0;
/// Colour of values that differ from the scene's own, and of controls.
pub const INK: Color32 = Color32::from_rgb(38, 84, 132);
/// Colour of the empty part of a track, and of a switch that is off.
pub const TRACK: Color32 = Color32::from_rgb(186, 188, 194);
/// Colour of the chosen row.
pub const CHOSEN: Color32 = Color32::from_rgb(207, 211, 218);
/// Colour of the row under the pointer.
pub const HOVERED: Color32 = Color32::from_rgb(217, 218, 220);

/// Width of the name (points).
const NAME_WIDTH: f32 = 76.0;
/// Width of the value (points).
const VALUE_WIDTH: f32 = 76.0;

/// A row: a knob with its number in the table, and its dial.
pub struct Row<'a> {
    pub number: usize,
    pub knob: &'a Knob,
    pub dial: &'a Dial,
    /// Whether keys turn the knob.
    pub chosen: bool,
    /// Text typed so far for the value.
    pub typed: Option<&'a str>,
    /// Whether that text is marked.
    pub is_marked: bool,
}

impl Row<'_> {
    /// Draws the row, and returns the request of the mouse.
    pub fn show(&self, ui: &Ui, rect: Rect) -> Option<PanelRequest> {
        let Self { number, dial, .. } = *self;
        let id = |part| Id::unique((part, number));
        let whole = ui.interact(rect.expand2(vec2(6.0, 0.0)), id("row"), Sense::click());
        let painter = ui.painter();
        if self.chosen || whole.hovered() {
            let colour = if self.chosen { CHOSEN } else { HOVERED };
            painter.rect_filled(rect.expand2(vec2(6.0, -0.5)), 5.0, colour);
        }
        let middle = rect.center().y;
        let colour = if self.chosen { TEXT } else { FAINT };
        let at = pos2(rect.left(), middle);
        let font = FontId::proportional(12.5);
        painter.text(at, Align2::LEFT_CENTER, self.knob.name, font, colour);
        let whole = whole.on_hover_text(self.tooltip());
        let mut request = None;
        if let DialScale::Choice(_) = dial.scale {
            let left = rect.left() + NAME_WIDTH - 18.0;
            let room = Rect::from_x_y_ranges(left..=rect.right(), rect.y_range());
            request = choice(ui, room, id, dial).map(|turn| PanelRequest::Turn(number, turn));
        } else {
            let value =
                Rect::from_x_y_ranges(rect.right() - VALUE_WIDTH..=rect.right(), rect.y_range());
            let left = rect.left() + NAME_WIDTH;
            let room = Rect::from_x_y_ranges(left..=value.left() - 4.0, rect.y_range());
            let set = if dial.scale == DialScale::Switch {
                switch(ui, room, id("dial"), dial.value != 0.0)
            } else {
                slider(ui, room, id("dial"), dial)
            };
            let set = set.map(|turn| PanelRequest::Turn(number, turn));
            request = set.or(self.value(ui, value, id("value"))).or(request);
        }
        request.or_else(|| whole.clicked().then_some(PanelRequest::ChooseRow(number)))
    }

    /// Draws the value, or the text typed for it. A click starts typing, and a double click
    /// restores the scene's own value.
    fn value(&self, ui: &Ui, rect: Rect, id: Id) -> Option<PanelRequest> {
        let dial = self.dial;
        let response = ui.interact(rect, id, Sense::click());
        let typeable = dial.scale.ends().is_some();
        if typeable && response.hovered() {
            ui.set_cursor_icon(CursorIcon::Text);
        }
        let painter = ui.painter();
        let colour = if dial.value == dial.own { TEXT } else { INK };
        let write = |words: &str, colour| {
            let at = pos2(rect.right(), rect.center().y);
            let font = FontId::proportional(13.0);
            painter.text(at, Align2::RIGHT_CENTER, words, font, colour);
        };
        if let Some(typed) = self.typed {
            let field = rect.expand2(vec2(4.0, -1.0));
            let stroke = Stroke::new(1.2, INK);
            painter.rect(field, 3.0, Color32::WHITE, stroke, egui::StrokeKind::Inside);
            let right = field.right_center() - vec2(4.0, 0.0);
            style::typed(painter, right, Align2::RIGHT_CENTER, typed, self.is_marked);
        } else {
            write(&dial.words, colour);
        }
        let response = response.on_hover_text(self.tooltip());
        if response.double_clicked() {
            return Some(PanelRequest::Turn(self.number, Turn::Own));
        }
        (typeable && response.clicked()).then_some(PanelRequest::Type(self.number))
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

/// Draws a track with a thumb, and a mark at the scene's own value. Returns the turn by the mouse.
pub fn slider(ui: &Ui, room: Rect, id: Id, dial: &Dial) -> Option<Turn> {
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

/// Draws a switch at the left of a room. Returns the turn by the mouse.
pub(super) fn switch(ui: &Ui, room: Rect, id: Id, on: bool) -> Option<Turn> {
    let size = vec2(28.0, 15.0);
    let rect = Rect::from_min_size(
        pos2(room.left() + 6.0, room.center().y - 0.5 * size.y),
        size,
    );
    let response = ui.interact(rect.expand(4.0), id, Sense::click());
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

/// Draws the chosen value between arrows to the previous and the next one. Returns the turn by the
/// mouse.
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

/// Draws a button with its label, and with its key if there is room for both.
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
    let at = pos2(rect.left() + 8.0, rect.center().y);
    let font = FontId::proportional(13.0);
    let label = painter.text(at, Align2::LEFT_CENTER, words, font, TEXT);
    let key = painter.layout_no_wrap(key.into(), FontId::proportional(12.5), FAINT);
    let place = Align2::RIGHT_CENTER.anchor_size(pos2(rect.right() - 7.0, at.y), key.size());
    if place.left() > label.right() + 4.0 {
        painter.galley(place.min, key, FAINT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hud::style::context;

    /// The key is left out where it would run into the label.
    #[test]
    fn a_button_has_its_key_where_there_is_room() {
        for (width, shown) in [(92.0, 1), (108.0, 2)] {
            let ctx = context();
            let mut output = ctx.run_ui(egui::RawInput::default(), |ui| {
                let rect = Rect::from_min_size(pos2(10.0, 10.0), vec2(width, 26.0));
                let response = ui.interact(rect, Id::unique("it"), Sense::click());
                button(ui, rect, &response, "measure", "Enter");
            });
            output.textures_delta.set.clear();
            let texts = output.shapes.iter();
            let texts: Vec<_> = texts
                .filter_map(|it| match &it.shape {
                    egui::Shape::Text(text) => Some(text.visual_bounding_rect()),
                    _ => None,
                })
                .collect();
            assert_eq!(texts.len(), shown, "{width}");
            assert!(
                texts
                    .windows(2)
                    .all(|it| it[0].right() + 2.0 < it[1].left())
            );
        }
    }
}
