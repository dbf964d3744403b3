//! The box in which particles are pinned or freed.

use egui::{Align2, Context, FontId, Id, LayerId, Order, Pos2, Rect, Stroke, StrokeKind, vec2};

use super::style::{TEXT, WARNING};
use crate::session::Selection;

/// Draws the box, with the effect of releasing the button.
pub fn show(ctx: &Context, selection: &Selection) {
    let [a, b] = selection.corners.map(Pos2::from);
    let rect = Rect::from_two_pos(a, b);
    let painter = ctx.layer_painter(LayerId::new(Order::Foreground, Id::unique("box")));
    let fill = WARNING.colour.gamma_multiply(0.12);
    let stroke = Stroke::new(1.4, WARNING.colour);
    painter.rect(rect, 2.0, fill, stroke, StrokeKind::Middle);
    let does = if selection.pinned { "pin" } else { "free" };
    let words = format!("{does} {}", selection.count);
    let at = rect.left_top() + vec2(6.0, 4.0);
    painter.text(
        at,
        Align2::LEFT_TOP,
        words,
        FontId::proportional(13.5),
        TEXT,
    );
}
