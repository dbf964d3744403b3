//! Buttons on each pane: another run beside it, and the end of this one.

use egui::{Area, Color32, Context, CursorIcon, Id, Pos2, Rect, Sense, Stroke, Ui, pos2, vec2};

use super::layout;
use super::panel::{PanelRequest, Request};
use super::style::{FAINT, PAPER, TEXT};
use crate::session::Session;
use crate::session::panes::MAX_PANES;

/// Width and height of a button (points).
const SIDE: f32 = 26.0;
/// Distance of the buttons from the edges of the pane, and from one another (points).
const GAP: f32 = 8.0;
/// Width of a pane below which it has no buttons (points).
const MIN_WIDTH: f32 = 280.0;

/// Draws the buttons of all panes, unless something covers them. Returns the request of the mouse.
pub fn show(ctx: &Context, session: &Session) -> Option<Request> {
    let (readings, count) = (&session.readings, session.runs.panes.len());
    if readings.help || readings.asks_to_quit || session.list.is_some() {
        return None;
    }
    let (window, scale) = (ctx.content_rect(), ctx.pixels_per_point());
    let size = [window.width(), window.height()].map(|side| (side * scale).round() as u32);
    let mut request = None;
    for (k, tile) in layout::tiles(count, size.into(), scale)
        .into_iter()
        .enumerate()
    {
        let [width, _] = layout::points(tile, scale);
        if width < MIN_WIDTH {
            continue;
        }
        let right = (tile.x + tile.width) as f32 / scale - GAP;
        let top = tile.y as f32 / scale + GAP;
        let kinds = [
            (count > 1, true, PanelRequest::RemovePane(k)),
            (count < MAX_PANES, false, PanelRequest::AddPane(k)),
        ];
        let mut at = right;
        for (_, closes, change) in kinds.into_iter().filter(|(there, ..)| *there) {
            let place = Rect::from_min_size(pos2(at - SIDE, top), vec2(SIDE, SIDE));
            at -= SIDE + 4.0;
            Area::new(Id::unique(("pane button", k, closes)))
                .fixed_pos(place.min)
                .constrain(false)
                .fade_in(false)
                .show(ctx, |ui| {
                    if button(ui, place, closes) {
                        request = Some(Request::Change(change));
                    }
                });
        }
    }
    request
}

/// Draws a cross that closes, or a plus that adds. Returns whether it was clicked.
fn button(ui: &mut Ui, place: Rect, closes: bool) -> bool {
    let response = ui.allocate_rect(place, Sense::click());
    let painter = ui.painter();
    let hovered = response.hovered();
    let fill = if hovered { Color32::WHITE } else { PAPER };
    painter.rect_filled(place, 7.0, fill);
    let stroke = Stroke::new(1.8, if hovered { TEXT } else { FAINT });
    let centre = place.center();
    let bar = |from: [f32; 2], to: [f32; 2]| {
        let end = |[x, y]: [f32; 2]| -> Pos2 { centre + vec2(x, y) };
        painter.line_segment([end(from), end(to)], stroke);
    };
    if closes {
        bar([-4.5, -4.5], [4.5, 4.5]);
        bar([-4.5, 4.5], [4.5, -4.5]);
    } else {
        bar([-6.0, 0.0], [6.0, 0.0]);
        bar([0.0, -6.0], [0.0, 6.0]);
    }
    let about = if closes {
        "Close this run"
    } else {
        "Run another solver beside, from here"
    };
    response
        .on_hover_cursor(CursorIcon::PointingHand)
        .on_hover_text(about)
        .clicked()
}
