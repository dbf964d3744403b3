//! What the sheets are made of: words, buttons, sliders and switches, and rows of them, and what
//! the mouse asks for there.

use egui::style::ScrollAnimation;
use egui::{
    Align2, Area, Color32, Context, CursorIcon, FontId, Id, Painter, Pos2, Rect, Response, Sense,
    Shape, Stroke, StrokeKind, Ui, pos2, vec2,
};

use super::style::{FAINT, INK, TEXT};
use crate::session::{Action, Dial, Turn};

/// Colour of the sheets.
pub const SHEET: Color32 = Color32::from_rgb(226, 226, 224);
/// Colour of their edges.
pub const EDGE: Color32 = Color32::from_rgb(188, 189, 192);
/// Colour of fields, cards and the buttons of lessons.
pub const CARD: Color32 = Color32::from_gray(238);
/// Colour of the empty part of a track, and of a switch that is off.
pub const TRACK: Color32 = Color32::from_rgb(186, 188, 194);
/// Background of a chosen row or choice, and of a small button under the pointer.
pub const CHOSEN: Color32 = Color32::from_rgb(207, 211, 218);
/// Background of a row or choice under the pointer.
pub const HOVERED: Color32 = Color32::from_rgb(217, 218, 220);

/// The place of words is the middle of their left or right side, or their own.
pub const LEFT: Align2 = Align2::LEFT_CENTER;
pub const RIGHT: Align2 = Align2::RIGHT_CENTER;
pub const MIDDLE: Align2 = Align2::CENTER_CENTER;

/// Looks at what the mouse asked for, or changes it.
fn wish<R>(ctx: &Context, look: impl FnOnce(&mut Option<Action>) -> R) -> R {
    let id = Id::unique("asked");
    ctx.data_mut(|data| look(data.get_temp_mut_or_default(id)))
}

/// Asks for an action, in place of what was asked for before.
pub fn ask(ctx: &Context, action: impl Into<Action>) {
    let action = action.into();
    wish(ctx, |wish| *wish = Some(action));
}

/// Takes the action that the mouse asked for, if it did.
pub fn asked(ctx: &Context) -> Option<Action> {
    wish(ctx, Option::take)
}

/// Returns whether the mouse asked for an action.
pub fn is_asked(ctx: &Context) -> bool {
    wish(ctx, |wish| wish.is_some())
}

/// What can be clicked.
pub trait Asks {
    /// Asks for an action if this was clicked.
    fn asks(&self, wish: impl Into<Action>);
}

impl Asks for Response {
    fn asks(&self, wish: impl Into<Action>) {
        if self.clicked() {
            ask(&self.ctx, wish);
        }
    }
}

/// Draws contents in a place that they do not leave.
pub fn fixed<R>(ctx: &Context, id: Id, at: Pos2, contents: impl FnOnce(&mut Ui) -> R) -> R {
    let area = Area::new(id).fixed_pos(at).constrain(false).fade_in(false);
    area.show(ctx, contents).inner
}

/// Writes words of a size (points), aligned at a place, and returns their rectangle.
pub fn write(
    painter: &Painter,
    at: Pos2,
    align: Align2,
    words: impl ToString,
    size: f32,
    colour: Color32,
) -> Rect {
    painter.text(at, align, words, FontId::proportional(size), colour)
}

/// Returns places of equal width in a row, with gaps between them (points).
pub fn columns(row: Rect, count: usize, gap: f32) -> impl Iterator<Item = Rect> {
    let width = (row.width() - gap * (count - 1) as f32) / count as f32;
    (0..count).map(move |k| {
        let left = row.left() + k as f32 * (width + gap);
        Rect::from_min_size(pos2(left, row.top()), vec2(width, row.height()))
    })
}

/// Senses clicks on a button. Its words and its place tell it from others.
fn sense(ui: &Ui, rect: Rect, words: &str) -> Response {
    let id = Id::unique((words, rect.left() as i32, rect.top() as i32));
    ui.interact(rect, id, Sense::click())
}

/// Paints the face of a button, with words in its middle.
fn face(ui: &Ui, rect: Rect, words: &str, size: f32, [fill, edge, ink]: [Color32; 3]) {
    let painter = ui.painter();
    let edge = Stroke::new(1.0, edge);
    painter.rect(rect, 6.0, fill, edge, StrokeKind::Inside);
    write(painter, rect.center(), MIDDLE, words, size, ink);
}

/// Draws a small button, which is chosen or not.
pub fn chip(ui: &Ui, rect: Rect, words: &str, chosen: bool) -> Response {
    let response = sense(ui, rect, words);
    let colours = match (chosen, response.hovered()) {
        (true, _) => [INK, INK, Color32::WHITE],
        (false, true) => [CHOSEN, EDGE, TEXT],
        (false, false) => [SHEET, EDGE, TEXT],
    };
    face(ui, rect, words, 13.0, colours);
    response.on_hover_cursor(CursorIcon::PointingHand)
}

/// Draws a button of the lessons; one that `is_due` stands out.
pub fn due(ui: &Ui, rect: Rect, words: &str, is_due: bool) -> Response {
    let response = sense(ui, rect, words);
    let colours = match (is_due, response.hovered()) {
        (true, false) => [INK, INK, Color32::WHITE],
        (true, true) => [INK.gamma_multiply(0.86), INK, Color32::WHITE],
        (false, true) => [HOVERED, EDGE, TEXT],
        (false, false) => [CARD, EDGE, TEXT],
    };
    face(ui, rect, words, 13.5, colours);
    response
}

/// Draws a button with its label on the left, and with its key if there is room for both.
pub fn button(ui: &Ui, rect: Rect, words: &str, key: &str) -> Response {
    let response = sense(ui, rect, words);
    let painter = ui.painter();
    let fill = if response.is_pointer_button_down_on() {
        CHOSEN
    } else if response.hovered() {
        HOVERED
    } else {
        SHEET
    };
    face(ui, rect, "", 13.0, [fill, EDGE, TEXT]);
    let at = rect.left_center() + vec2(8.0, 0.0);
    let label = write(painter, at, LEFT, words, 13.0, TEXT);
    let key = painter.layout_no_wrap(key.into(), FontId::proportional(12.5), FAINT);
    let place = Align2::RIGHT_CENTER.anchor_size(pos2(rect.right() - 7.0, at.y), key.size());
    if place.left() > label.right() + 4.0 {
        painter.galley(place.min, key, FAINT);
    }
    response
}

/// Draws the cross that closes a sheet, around a place.
pub fn cross(ui: &Ui, at: Pos2) -> Response {
    let place = Rect::from_center_size(at, vec2(32.0, 32.0));
    let response = sense(ui, place, "close");
    let colour = if response.hovered() { TEXT } else { FAINT };
    write(ui.painter(), at, MIDDLE, "✖", 14.0, colour);
    response.on_hover_cursor(CursorIcon::PointingHand)
}

/// Draws an arrow to the left or to the right with its tip near a place.
pub fn arrow(ui: &Ui, at: Pos2, is_left: bool, stroke: Stroke) {
    let way = if is_left { 1.0 } else { -1.0 };
    let corner = |dx: f32, dy| at + vec2(way * dx, dy);
    let points = vec![corner(2.5, -4.5), corner(-2.0, 0.0), corner(2.5, 4.5)];
    ui.painter().add(Shape::line(points, stroke));
}

/// Scrolls to the row that is chosen in a list when another one is chosen, so that the wheel can
/// scroll.
pub fn keep_in_sight(ui: &Ui, list: &str, row: Rect, chosen: usize) {
    let was = Id::unique(("chosen in", list));
    if ui.data(|data| data.get_temp(was)) != Some(chosen) {
        ui.data_mut(|data| data.insert_temp(was, chosen));
        ui.scroll_to_rect_animation(row, None, ScrollAnimation::none());
    }
}

/// Draws the ground of a row that can be chosen, with its tooltip.
pub fn row(
    ui: &Ui,
    rect: Rect,
    id: Id,
    chosen: bool,
    tooltip: impl FnOnce() -> String,
) -> Response {
    let whole = ui.interact(rect.expand2(vec2(6.0, 0.0)), id, Sense::click());
    if chosen || whole.hovered() {
        let colour = if chosen { CHOSEN } else { HOVERED };
        let place = rect.expand2(vec2(6.0, -0.5));
        ui.painter().rect_filled(place, 5.0, colour);
    }
    whole.on_hover_text(tooltip())
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
    for (to, colour) in [(track.right(), TRACK), (thumb, INK)] {
        let bar = Rect::from_x_y_ranges(track.left()..=to, y - 1.5..=y + 1.5);
        painter.rect_filled(bar, 1.5, colour);
    }
    painter.vline(own, y - 5.0..=y + 5.0, Stroke::new(1.2, FAINT));
    let radius = if response.dragged() { 6.0 } else { 5.2 };
    let edge = Stroke::new(1.8, INK);
    painter.circle(pos2(thumb, y), radius, Color32::WHITE, edge);
    let held = response.dragged() || response.clicked();
    let pointer = response.interact_pointer_pos().filter(|_| held)?;
    let share = (pointer.x - track.left()) / track.width();
    Some(Turn::To(dial.scale.at(share.into())))
}

/// Draws a switch at the left of a room. Returns the turn by the mouse.
pub fn switch(ui: &Ui, room: Rect, id: Id, on: bool) -> Option<Turn> {
    let middle = room.left_center() + vec2(20.0, 0.0);
    let rect = Rect::from_center_size(middle, vec2(28.0, 15.0));
    let response = ui.interact(rect.expand(4.0), id, Sense::click());
    let painter = ui.painter();
    painter.rect_filled(rect, 7.5, if on { INK } else { TRACK });
    let way = vec2(if on { 6.5 } else { -6.5 }, 0.0);
    painter.circle_filled(rect.center() + way, 5.5, Color32::WHITE);
    response.clicked().then_some(Turn::Toggle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hud::window::Window;

    /// The key is left out where it would run into the label.
    #[test]
    fn a_button_has_its_key_where_there_is_room() {
        for (width, shown) in [(92.0, 1), (108.0, 2)] {
            let mut window = Window::new([300.0, 200.0]);
            for _ in 0..2 {
                window.frame([0.0; 2], vec![], |ctx| {
                    let rect = Rect::from_min_size(pos2(10.0, 10.0), vec2(width, 26.0));
                    let area = egui::Area::new(Id::unique("it")).fixed_pos(rect.min);
                    area.show(ctx, |ui| button(ui, rect, "measure", "Enter"));
                });
            }
            let texts = window.written();
            assert_eq!(texts.len(), shown, "{width}");
            let mut pairs = texts.windows(2);
            assert!(pairs.all(|it| it[0].1.right() + 2.0 < it[1].1.left()));
        }
    }
}
