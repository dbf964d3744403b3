//! Where in the kept time one is, at the bottom of the window.

use egui::{Align2, Area, Color32, Context, FontId, Id, Pos2, Rect, Sense, Stroke, vec2};

use super::layout;
use super::text::{FAINT, PAPER, TEXT};
use crate::session::Place;

const DONE: Color32 = Color32::from_rgb(158, 22, 34);

pub fn show(ctx: &Context, place: &Place) {
    let window = ctx.content_rect();
    let [left, top, width, height] = layout::timeline([window.width(), window.height()]);
    let sheet = Rect::from_min_size(Pos2::new(left, top), vec2(width, height));
    Area::new(Id::unique("timeline"))
        .fixed_pos(sheet.min)
        .constrain(false)
        .interactable(false)
        .show(ctx, |ui| {
            ui.allocate_exact_size(sheet.size(), Sense::hover());
            let painter = ui.painter();
            painter.rect_filled(sheet, 7.0, PAPER);
            let (from, to) = layout::track(left, width);
            let y = top + height - 13.0;
            let at = from + place.share * (to - from);
            let line = |from, to, color| {
                painter.hline(from..=to, y, Stroke::new(4.0, color));
            };
            line(from, to, FAINT.gamma_multiply(0.35));
            line(from, at, DONE);
            painter.circle_filled(Pos2::new(at, y), 7.0, DONE);
            painter.circle_filled(Pos2::new(at, y), 2.5, PAPER);
            let say = |x, align, words: String, color| {
                let place = Pos2::new(x, top + 6.0);
                painter.text(place, align, words, FontId::proportional(12.5), color);
            };
            let back = format!("{:.2} s back", place.back);
            say(from, Align2::LEFT_TOP, back, TEXT);
            let span = format!("{:.1} s kept", place.span);
            say(to, Align2::RIGHT_TOP, span, FAINT);
        });
}
