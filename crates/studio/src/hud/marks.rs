//! Marks at places of the picture: the hint for the first run, that the mouse can pull; the ruler,
//! the distance between two particles or points; and the box in which particles are pinned or
//! freed.

use a3_media::show;
use egui::{
    Align2, Context, FontId, Id, LayerId, Order, Pos2, Rect, Stroke, StrokeKind, Vec2, vec2,
};

use super::layout;
use super::style::{MARGIN, PAPER, TEXT, WARNING};
use super::widgets::write;
use super::words::signed;
use crate::session::{Selection, Session};

/// Time for which the hint is shown (s).
const HINT_DURATION: f64 = 10.0;
/// Distance of the hint from the body, and of its words from its edges (points).
const GAP: f32 = 14.0;
const PAD: [f32; 2] = [12.0, 9.0];

/// Writes the hint beside the body of the first pane for a while, until something was pulled for
/// the first time. It covers neither the body nor other text.
pub fn hint(ctx: &Context, session: &Session) {
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
    if now - begun > HINT_DURATION {
        return;
    }
    let by = if readings.touch { "a finger" } else { "the mouse" };
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
    let (tile, pane) = *layout::tiles_in(ctx, panes.len()).first()?;
    let project = session.view.camera.projection(tile.aspect());
    let (right, up, _) = session.view.camera.axes();
    let ball = panes[0].show.ball_radius();
    let particles = (0..run.particles()).filter(|i| !network.is_wall(*i)).map(|i| (i, ball));
    let bodies = network.bodies().iter().map(|body| (body.center(), body.radius() as f32));
    let edges = particles.chain(bodies).flat_map(|(i, reach)| {
        let center = show::to_f32(run.position(i));
        [right, up, -right, -up].map(|way| [0, 1, 2].map(|k| center[k] + reach * way[k]))
    });
    let seen = edges.filter_map(project);
    let places = seen.map(|([x, y], _)| pane.min + vec2(x, y) * pane.size());
    let body =
        places.fold(Rect::NOTHING, |body, place| body.union(Rect::from_min_max(place, place)));
    let room = pane.intersect(ctx.content_rect()).shrink(MARGIN);
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

/// Radius of an end of the ruler (points).
const END: f32 = 4.0;

/// Draws the ruler in each pane, with the distance between its ends there.
pub fn ruler(ctx: &Context, session: &Session) {
    let ends = session.panel.plotting.ruler.as_deref().unwrap_or_default();
    if ends.is_empty() || session.readings.help {
        return;
    }
    let layer = LayerId::new(Order::Background, Id::unique("ruler"));
    let panes = &session.runs.panes;
    for (pane, (tile, room)) in panes.iter().zip(layout::tiles_in(ctx, panes.len())) {
        let painter = ctx.layer_painter(layer).with_clip_rect(room);
        let places = ends.iter().map(|end| {
            let at = end.place(&pane.simulation)?;
            let camera = &session.view.camera;
            let ([x, y], _) = camera.project(show::to_f32(at), tile.aspect())?;
            Some((at, room.min + vec2(x, y) * room.size()))
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
fn below(a: Pos2, b: Pos2, room: Rect, size: Vec2) -> Pos2 {
    let at = a + 0.5 * (b - a) + vec2(10.0, 10.0);
    let most = room.max - size;
    at.min(most).max(room.min)
}

/// Draws the box in which particles are pinned or freed, with the effect of releasing the button.
pub fn selection(ctx: &Context, selection: &Selection) {
    let [a, b] = selection.corners.map(Pos2::from);
    let rect = Rect::from_two_pos(a, b);
    let painter = ctx.layer_painter(LayerId::new(Order::Foreground, Id::unique("box")));
    let fill = WARNING.colour.gamma_multiply(0.12);
    let stroke = Stroke::new(1.4, WARNING.colour);
    painter.rect(rect, 2.0, fill, stroke, StrokeKind::Middle);
    let does = if selection.pinned { "pin" } else { "free" };
    let words = format!("{does} {}", selection.count);
    let at = rect.left_top() + vec2(6.0, 4.0);
    write(&painter, at, Align2::LEFT_TOP, words, 13.5, TEXT);
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;
    use crate::hud::window::Window;
    use crate::session::{frames, session};

    /// Returns the words of the hint and its place after a time (s) in a window of a size (points),
    /// drawn twice a second.
    fn seen(session: &Session, size: [f32; 2], time: f64) -> Option<(String, Rect)> {
        let mut window = Window::new(size);
        window.step = 0.5;
        for _ in 0..=(2.0 * time) as u32 {
            window.frame([0.0; 2], vec![], |ctx| hint(ctx, session));
        }
        window.read().into_iter().next()
    }

    #[test]
    fn the_hint_is_beside_what_moves_and_goes_after_ten_seconds() {
        for scene in ["cloth", "chain", "jelly", "boxes", "mit-sphere"] {
            let mut session = session(&["v", "0.001", "--scene", scene]);
            frames(&mut session, 0.1);
            for size in [[1280.0, 720.0], [390.0, 780.0], [480.0, 320.0], [800.0, 460.0]] {
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
