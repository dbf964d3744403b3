//! Buttons that are chosen or not.

use egui::{Align2, Color32, CursorIcon, FontId, Rect, Response, Stroke, StrokeKind, Ui};

use super::super::docked::{EDGE, SHEET};
use super::super::style::TEXT;

/// Colour of the chosen button, and of the finished part of a progress bar.
pub const INK: Color32 = Color32::from_rgb(38, 84, 132);
/// Colour under the pointer.
const HOVERED: Color32 = Color32::from_rgb(207, 211, 218);

/// Draws a button with its words in its middle.
pub fn chip(ui: &Ui, rect: Rect, response: &Response, words: &str, chosen: bool) {
    let (fill, colour) = match (chosen, response.hovered()) {
        (true, _) => (INK, Color32::WHITE),
        (false, true) => (HOVERED, TEXT),
        (false, false) => (SHEET, TEXT),
    };
    if response.hovered() {
        ui.set_cursor_icon(CursorIcon::PointingHand);
    }
    let edge = Stroke::new(1.0, if chosen { INK } else { EDGE });
    let painter = ui.painter();
    painter.rect(rect, 6.0, fill, edge, StrokeKind::Inside);
    let font = FontId::proportional(13.0);
    painter.text(rect.center(), Align2::CENTER_CENTER, words, font, colour);
}
