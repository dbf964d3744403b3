//! The timeline in the bar below the picture.

use egui::{Align2, Color32, CursorIcon, FontId, Id, Rect, Sense, Stroke, Ui, pos2};

use super::panel::PanelRequest;
use super::style::{ALARM, FAINT, PAPER, TEXT};
use super::words::digits;
use crate::session::TimelinePosition;

/// Colour of the track up to the chosen moment.
const ELAPSED: Color32 = Color32::from_rgb(38, 84, 132);

/// Draws the track in a room, with a thumb at the chosen moment, and a cross at the end if the run
/// blew up there. Returns the request of the mouse.
pub fn show(ui: &Ui, room: Rect, position: &TimelinePosition) -> Option<PanelRequest> {
    let response = ui.interact(
        room.expand2(egui::vec2(8.0, 0.0)),
        Id::unique("timeline"),
        Sense::click_and_drag(),
    );
    if response.hovered() || response.dragged() {
        ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    let (painter, y) = (ui.painter(), room.bottom() - 13.0);
    let at = room.left() + position.share * room.width();
    let line = |from, to, color| {
        painter.hline(from..=to, y, Stroke::new(4.0, color));
    };
    line(room.left(), room.right(), FAINT.gamma_multiply(0.35));
    line(room.left(), at, ELAPSED);
    if position.blew_up {
        let stroke = Stroke::new(2.0, ALARM.colour);
        for way in [-4.0, 4.0] {
            let end = room.right() + 8.0;
            painter.line_segment([pos2(end - 4.0, y - way), pos2(end + 4.0, y + way)], stroke);
        }
    }
    painter.circle_filled(pos2(at, y), 6.5, ELAPSED);
    painter.circle_filled(pos2(at, y), 2.5, PAPER);
    let say = |x, align, words: String, color| {
        let place = pos2(x, room.top() + 5.0);
        painter.text(place, align, words, FontId::proportional(12.0), color);
    };
    if position.share < 1.0 {
        let back = format!("{} s back", digits(position.back));
        say(room.left(), Align2::LEFT_TOP, back, TEXT);
    }
    if room.width() > 150.0 {
        let words = if position.blew_up {
            "✖ it blew up".into()
        } else {
            format!("{:.1} s kept", position.span)
        };
        let color = if position.blew_up {
            ALARM.colour
        } else {
            FAINT
        };
        say(room.right(), Align2::RIGHT_TOP, words, color);
    }
    let held = response.dragged() || response.clicked();
    let pointer = response.interact_pointer_pos().filter(|_| held)?;
    let share = (pointer.x - room.left()) / room.width();
    Some(PanelRequest::GoTo(share.clamp(0.0, 1.0)))
}
