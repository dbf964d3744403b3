//! The timeline at the bottom of the window.

use egui::{Align2, Area, Color32, Context, FontId, Id, Pos2, Rect, Sense, Stroke, vec2};

use super::layout;
use super::style::{FAINT, PAPER, TEXT};
use crate::window::session::TimelinePosition;

/// Colour of the track up to the chosen moment.
const ELAPSED: Color32 = Color32::from_rgb(158, 22, 34);

/// Draws the track, with a thumb at the chosen moment.
pub fn show(ctx: &Context, position: &TimelinePosition) {
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
            let at = from + position.share * (to - from);
            let line = |from, to, color| {
                painter.hline(from..=to, y, Stroke::new(4.0, color));
            };
            line(from, to, FAINT.gamma_multiply(0.35));
            line(from, at, ELAPSED);
            painter.circle_filled(Pos2::new(at, y), 7.0, ELAPSED);
            painter.circle_filled(Pos2::new(at, y), 2.5, PAPER);
            let say = |x, align, words: String, color| {
                let place = Pos2::new(x, top + 6.0);
                painter.text(place, align, words, FontId::proportional(12.5), color);
            };
            let back = format!("{:.2} s back", position.back);
            say(from, Align2::LEFT_TOP, back, TEXT);
            let span = format!("{:.1} s kept", position.span);
            say(to, Align2::RIGHT_TOP, span, FAINT);
        });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::hud::{pane, read};
    use crate::window::session::Readings;

    #[test]
    fn slow_motion_and_the_position_in_time_are_shown() {
        let position = TimelinePosition {
            share: 0.25,
            back: 1.5,
            span: 2.0,
        };
        let readings = Readings {
            factor: 0.12,
            slowness: 3,
            rewound: Some(position),
            ..Readings::default()
        };
        for size in [[1280.0, 720.0], [500.0, 400.0], [260.0, 860.0]] {
            let (words, sheets) = read(&[pane("chain", "r", 0.01)], &readings, size);
            for said in [
                "0.12 × real time",
                "1/8 of real time",
                "1.50 s back",
                "2.0 s kept",
            ] {
                assert!(words.contains(said), "{said} in {words}");
            }
            assert!(!sheets[0].intersects(sheets[1]), "{sheets:?}");
        }
    }
}
