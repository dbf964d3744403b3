//! The ruler: the distance between two particles or points in the picture.

use a3_media::show;
use egui::{Context, FontId, Id, LayerId, Order, Pos2, Rect, Stroke, pos2, vec2};

use super::layout;
use super::style::{PAPER, TEXT};
use super::words::signed;
use crate::session::Session;

/// Radius of an end (points).
const END: f32 = 4.0;

/// Draws the ruler in each pane, with the distance between its ends there.
pub fn show(ctx: &Context, session: &Session) {
    let ends = session.panel.plotting.ruler.as_deref().unwrap_or_default();
    if ends.is_empty() || session.readings.help {
        return;
    }
    let (window, scale) = (ctx.content_rect(), ctx.pixels_per_point());
    let size = [window.width(), window.height()].map(|side| (side * scale).round() as u32);
    let layer = LayerId::new(Order::Background, Id::unique("ruler"));
    let panes = &session.runs.panes;
    let tiles = layout::tiles(panes.len(), size.into(), scale);
    for (pane, tile) in panes.iter().zip(tiles) {
        let [left, top] = [tile.x, tile.y].map(|side| side as f32 / scale);
        let [width, height] = layout::points(tile, scale);
        let room = Rect::from_min_size(pos2(left, top), vec2(width, height));
        let painter = ctx.layer_painter(layer).with_clip_rect(room);
        let places = ends.iter().map(|end| {
            let at = end.place(&pane.simulation)?;
            let camera = &session.view.camera;
            let ([x, y], _) = camera.project(show::to_f32(at), tile.aspect())?;
            Some((at, room.min + vec2(x * width, y * height)))
        });
        let Some(places) = places.collect::<Option<Vec<_>>>() else {
            continue;
        };
        if let [(from, a), (to, b)] = *places {
            let [wide, thin] = [Stroke::new(4.0, PAPER), Stroke::new(1.6, TEXT)];
            for stroke in [wide, thin] {
                painter.line_segment([a, b], stroke);
            }
            let way = to - from;
            let [dx, dy, dz] = [way.x, way.y, way.z].map(signed);
            let length = signed(way.norm());
            let words = format!("{length} m\ndx {dx}   dy {dy}   dz {dz} m");
            let font = FontId::proportional(13.5);
            let galley = painter.layout_no_wrap(words, font, TEXT);
            let sheet = galley.size() + vec2(16.0, 10.0);
            let at = below(a, b, room, sheet);
            painter.rect_filled(Rect::from_min_size(at, sheet), 6.0, PAPER);
            painter.galley(at + vec2(8.0, 5.0), galley, TEXT);
        }
        for (_, at) in places {
            painter.circle(at, END, PAPER.to_opaque(), Stroke::new(1.6, TEXT));
        }
    }
}

/// Returns the place of a sheet of a size beside the middle of a line, within a room.
fn below(a: Pos2, b: Pos2, room: Rect, size: egui::Vec2) -> Pos2 {
    let at = a + 0.5 * (b - a) + vec2(10.0, 10.0);
    let most = room.max - size;
    pos2(
        at.x.min(most.x).max(room.left()),
        at.y.min(most.y).max(room.top()),
    )
}
