//! The hint for the first run: the mouse can pull.

use a3_media::show;
use egui::{Align2, Area, Context, Id, pos2};

use super::layout;
use super::style::{sheet, text};
use crate::session::Session;

/// Writes the hint below the body of the first pane, until something was pulled for the first time.
pub fn show(ctx: &Context, session: &Session) {
    let (run, readings) = (session.runs.first(), &session.readings);
    let hidden = session.pulled
        || session.panel.editor.open
        || readings.paused
        || readings.help
        || session.list.is_some();
    let Some(network) = run.model().network().filter(|_| !hidden) else {
        return;
    };
    let words = match network.bodies().len() {
        0 if session.panel.touch => "Pull me with a finger",
        0 => "Pull me with the mouse",
        1 => "Push or pull me with the mouse",
        _ => "Push or pull one with the mouse",
    };
    let (window, scale) = (ctx.content_rect(), ctx.pixels_per_point());
    let size = [window.width(), window.height()].map(|side| (side * scale).round() as u32);
    let tiles = layout::tiles(session.runs.panes.len(), size.into(), scale);
    let Some(tile) = tiles.first() else {
        return;
    };
    let project = session.view.camera.projection(tile.aspect());
    let free = (0..run.particles()).filter(|i| !network.is_pinned(*i) && !network.is_wall(*i));
    let seen = free.filter_map(|i| project(show::to_f32(run.position(i))));
    let seen = seen.filter(|([x, y], _)| (0.0..1.0).contains(x) && (0.0..1.0).contains(y));
    let (mut sum, mut low, mut count) = (0.0, 0.0f32, 0.0);
    for ([x, y], _) in seen {
        (sum, low, count) = (sum + x, low.max(y), count + 1.0);
    }
    if count == 0.0 || run.blow_up().is_some() {
        return;
    }
    let place = |share: f32, from: u32, side: u32| (from as f32 + share * side as f32) / scale;
    let at = pos2(
        place(sum / count, tile.x, tile.width),
        place(low, tile.y, tile.height) + 14.0,
    );
    Area::new(Id::unique("pull"))
        .fixed_pos(at)
        .pivot(Align2::CENTER_TOP)
        .constrain_to(window.shrink(8.0))
        .interactable(false)
        .show(ctx, |ui| {
            sheet(ui, |ui| {
                ui.label(text(words).strong());
            });
        });
}
