//! The hint for the first run: the mouse can pull.

use a3_media::show;
use egui::{Context, FontId, Id, LayerId, Order, Rect, Vec2, pos2, vec2};

use super::layout;
use super::style::{MARGIN, PAPER, TEXT};
use crate::session::Session;

/// Time for which the hint is shown (s).
const DURATION: f64 = 10.0;
/// Distance of the hint from the body, and of its words from its edges (points).
const GAP: f32 = 14.0;
const PAD: [f32; 2] = [12.0, 9.0];

/// Writes the hint beside the body of the first pane for a while, until something was pulled for
/// the first time. It covers neither the body nor other text.
pub fn show(ctx: &Context, session: &Session) {
    let (run, readings) = (session.runs.first(), &session.readings);
    let hidden = session.pulled
        || session.panel.editor.open
        || readings.paused
        || readings.help
        || session.list.is_some()
        || run.blow_up().is_some();
    let Some(network) = run.model().network().filter(|_| !hidden) else {
        return;
    };
    let (since, now) = (Id::unique("hint since"), ctx.input(|input| input.time));
    let begun = ctx.data_mut(|data| *data.get_temp_mut_or(since, now));
    if now - begun > DURATION {
        return;
    }
    let by = if readings.touch {
        "a finger"
    } else {
        "the mouse"
    };
    let words = match network.bodies().len() {
        0 => format!("Pull me with {by}"),
        1 => format!("Push or pull me with {by}"),
        _ => format!("Push or pull one with {by}"),
    };
    let Some((body, room)) = body(ctx, session) else {
        return;
    };
    let layer = LayerId::new(Order::Background, Id::unique("hint"));
    let painter = ctx.layer_painter(layer);
    let words = painter.layout_no_wrap(words, FontId::proportional(13.5), TEXT);
    let size = words.size() + 2.0 * vec2(PAD[0], PAD[1]);
    let text = ["run", "pane 0"].map(Id::unique);
    let readings = ctx.memory(|memory| text.into_iter().find_map(|id| memory.area_rect(id)));
    let taken = [body, readings.unwrap_or(Rect::NOTHING)];
    if let Some(place) = beside(body, size, room, taken) {
        painter.rect_filled(place, 7.0, PAPER);
        painter.galley(place.min + PAD.into(), words, TEXT);
    }
}

/// Returns the rectangle around what moves in the first pane, and the room for text there; `None`
/// if nothing is seen.
fn body(ctx: &Context, session: &Session) -> Option<(Rect, Rect)> {
    let (run, panes) = (session.runs.first(), &session.runs.panes);
    let network = run.model().network()?;
    let (window, scale) = (ctx.content_rect(), ctx.pixels_per_point());
    let size = [window.width(), window.height()].map(|side| (side * scale).round() as u32);
    let tile = *layout::tiles(panes.len(), size.into(), scale).first()?;
    let corner = pos2(tile.x as f32, tile.y as f32) / scale;
    let pane = Rect::from_min_size(corner, layout::points(tile, scale).into());
    let project = session.view.camera.projection(tile.aspect());
    let (right, up, _) = session.view.camera.axes();
    let particles = (0..run.particles()).filter(|i| !network.is_wall(*i));
    let edges = network.bodies().iter().flat_map(|body| {
        let center = show::to_f32(run.position(body.center()));
        let reach = body.radius() as f32;
        [right, up, -right, -up].map(|way| [0, 1, 2].map(|k| center[k] + reach * way[k]))
    });
    let points = particles
        .map(|i| show::to_f32(run.position(i)))
        .chain(edges);
    let seen = points.filter_map(project);
    let places = seen.map(|([x, y], _)| pane.min + vec2(x, y) * pane.size());
    let body = places.fold(Rect::NOTHING, |body, place| {
        body.union(Rect::from_min_max(place, place))
    });
    let room = pane.intersect(window).shrink(MARGIN);
    body.intersects(room).then_some((body, room))
}

/// Returns the place of a sheet of a size beside a body, in a room and apart from other rectangles:
/// below the body, above it, or at a side, if one of these is free.
fn beside(body: Rect, size: Vec2, room: Rect, taken: [Rect; 2]) -> Option<Rect> {
    let apart = 0.5 * size + vec2(GAP, GAP);
    let middles = [
        body.center_bottom() + vec2(0.0, apart.y),
        body.center_top() - vec2(0.0, apart.y),
        body.right_center() + vec2(apart.x, 0.0),
        body.left_center() - vec2(apart.x, 0.0),
    ];
    let within = room.shrink2(0.5 * size);
    if within.is_negative() {
        return None;
    }
    middles.into_iter().find_map(|middle| {
        let place = Rect::from_center_size(within.clamp(middle), size);
        let is_free = taken.iter().all(|other| !place.intersects(*other));
        (is_free && room.contains_rect(place)).then_some(place)
    })
}

#[cfg(test)]
mod tests {
    use egui::Pos2;

    use super::*;
    use crate::session::{frames, session};

    /// Returns the words of the hint and its place after a time (s) in a window of a size (points),
    /// drawn twice a second.
    fn seen(session: &Session, size: [f32; 2], time: f64) -> Option<(String, Rect)> {
        let ctx = crate::hud::style::context();
        let mut seen = None;
        for k in 0..=(2.0 * time) as u32 {
            let input = egui::RawInput {
                screen_rect: Some(Rect::from_min_size(Pos2::ZERO, size.into())),
                time: Some(0.5 * f64::from(k)),
                ..Default::default()
            };
            let mut output = ctx.run_ui(input, |ui| show(ui.ctx(), session));
            output.textures_delta.set.clear();
            output.textures_delta.free.clear();
            seen = output
                .shapes
                .iter()
                .find_map(|clipped| match &clipped.shape {
                    egui::Shape::Text(text) => {
                        Some((text.galley.text().to_owned(), text.visual_bounding_rect()))
                    }
                    _ => None,
                });
        }
        seen
    }

    #[test]
    fn the_hint_is_beside_what_moves_and_goes_after_ten_seconds() {
        for scene in ["cloth", "chain", "jelly", "boxes", "mit-sphere"] {
            let mut session = session(&["v", "0.001", "--scene", scene]);
            frames(&mut session, 0.1);
            for size in [
                [1280.0, 720.0],
                [390.0, 780.0],
                [480.0, 320.0],
                [800.0, 460.0],
            ] {
                let focus = layout::focus(1, size);
                session.view.camera.set_focus(focus);
                let Some((words, place)) = seen(&session, size, 1.0) else {
                    continue;
                };
                assert!(words.ends_with("with the mouse"), "{words}");
                let aspect = size[0] / size[1];
                let project = session.view.camera.projection(aspect);
                let run = session.runs.first();
                for i in 0..run.particles() {
                    let ([x, y], _) = project(show::to_f32(run.position(i))).unwrap();
                    let at = pos2(x * size[0], y * size[1]);
                    assert!(!place.contains(at), "{i} of {scene} in {size:?}");
                }
            }
            assert!(seen(&session, [1280.0, 720.0], 1.0).is_some(), "{scene}");
            assert!(seen(&session, [1280.0, 720.0], 11.0).is_none(), "{scene}");
        }
    }
}
