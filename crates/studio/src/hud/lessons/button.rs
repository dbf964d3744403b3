//! A button of the lessons.

use egui::{Align2, Color32, FontId, Rect, Response, Stroke, StrokeKind, Ui};

use super::super::docked::EDGE;
use super::super::panel::{HOVERED, INK};
use super::super::style::TEXT;

/// Draws a button with its label in the middle; one that `is_due` stands out.
pub fn button(ui: &Ui, rect: Rect, response: &Response, words: &str, is_due: bool) {
    let (fill, colour) = match (is_due, response.hovered()) {
        (true, false) => (INK, Color32::WHITE),
        (true, true) => (INK.gamma_multiply(0.86), Color32::WHITE),
        (false, true) => (HOVERED, TEXT),
        (false, false) => (Color32::from_gray(238), TEXT),
    };
    let stroke = Stroke::new(1.0, if is_due { INK } else { EDGE });
    let painter = ui.painter();
    painter.rect(rect, 6.0, fill, stroke, StrokeKind::Inside);
    let font = FontId::proportional(13.5);
    painter.text(rect.center(), Align2::CENTER_CENTER, words, font, colour);
}
