//! Buttons for what a message offers: to bring surfaces apart where they cross and, after a
//! blow-up, to run again with what would have held, or with what is measured.

use a3_core::Control;
use a3_files::holding::Sought;
use a3_files::rounding::short;
use egui::{Align, Align2, Area, Context, Id, Layout, Order, Rect, Sense, vec2};

use super::panel::{PanelRequest, Request, button};
use crate::session::{Action, MeasureRequest, RunAction, Session};

/// Width and height of a button (points).
const SIZE: [f32; 2] = [190.0, 30.0];
/// Distance between buttons (points).
const GAP: f32 = 8.0;
/// Distance of the buttons from the lower edge of the picture (points).
const DISTANCE: f32 = 24.0;
/// Draws the buttons while something is offered and where they cover no text, and returns the
/// request of the mouse.
pub fn show(ctx: &Context, session: &Session) -> Option<Request> {
    let readings = &session.readings;
    let offers = offers(session);
    if readings.help || readings.asks_to_quit || session.list.is_some() || offers.is_empty() {
        return None;
    }
    let tools = ctx.memory(|memory| memory.area_rect(Id::unique("tools")));
    let tools = tools.filter(|_| session.panel.editor.open);
    let tools = tools.map_or(0.0, |place| place.height());
    let (room, [width, height]) = (ctx.content_rect(), SIZE.map(|side| side + GAP));
    let count = offers.len() as f32;
    let (layout, size) = if room.width() > width * count {
        (
            Layout::left_to_right(Align::Center),
            [width * count, height],
        )
    } else {
        (Layout::top_down(Align::Center), [width, height * count])
    };
    let bottom = room.center_bottom() - vec2(0.0, DISTANCE + tools + 0.5 * size[1]);
    let place = Rect::from_center_size(bottom, size.into());
    let texts = ["run", "pane 0", "pane 1", "pane 2", "pane 3"].map(Id::unique);
    let is_taken = |id| {
        ctx.memory(|memory| memory.area_rect(id))
            .is_some_and(|it| it.intersects(place))
    };
    if texts.into_iter().any(is_taken) || !room.contains_rect(place) {
        return None;
    }
    let mut request = None;
    Area::new(Id::unique("offers"))
        .order(Order::Foreground)
        .anchor(Align2::CENTER_BOTTOM, [0.0, -DISTANCE - tools])
        .show(ctx, |ui| {
            ui.with_layout(layout, |ui| {
                for (words, key, offer) in offers {
                    let (rect, response) = ui.allocate_exact_size(SIZE.into(), Sense::click());
                    button(ui, rect, &response, &words, key);
                    request = response.clicked().then_some(offer).or(request);
                }
            });
        });
    request
}

/// Returns what is offered: words, a key, and the request.
fn offers(session: &Session) -> Vec<(String, &'static str, Request)> {
    let mut all = vec![];
    if session.readings.offers_apart {
        let apart = Request::Act(Action::Run(RunAction::Touch));
        all.push(("Bring the surfaces apart".into(), "x", apart));
    }
    let panes = session.runs.panes.iter().enumerate();
    for (k, pane) in panes.filter(|(_, pane)| !pane.alive()) {
        let again = match pane.limit.sought().and_then(Sought::control) {
            Some(Control::Step(step)) => format!("Run with {} ms", short(1e3 * step, 3)),
            Some(Control::Tolerance(tolerance)) => format!("Run with {tolerance:e}"),
            None => continue,
        };
        let name = match session.runs.panes.len() {
            1 => again,
            _ => format!("{again} in pane {}", k + 1),
        };
        all.push((name, "", Request::Change(PanelRequest::RunAgain(k))));
    }
    let dead = session.runs.panes.iter().any(|pane| !pane.alive());
    if dead && session.measuring.answerer.is_some() {
        let choose = PanelRequest::Measure(MeasureRequest::Choose);
        all.push(("Let a3 choose".into(), "", Request::Change(choose)));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hud::panel::apply;
    use crate::session::session;

    /// After a blow-up, a button runs the scene again with what would have held.
    #[test]
    fn a_blow_up_offers_what_holds() {
        let mut session = session(&["r", "0.05", "--scene", "mit"]);
        assert_eq!(offers(&session), []);
        while session.runs.any_alive() {
            session.tick(1.0 / 60.0);
        }
        session.read_state();
        let offers = offers(&session);
        let (words, _, again) = &offers[0];
        assert_eq!((&**words, offers.len()), ("Run with 30 ms", 1));
        let Request::Change(again) = again else {
            panic!("{again:?}");
        };
        apply(&mut session, *again);
        let run = session.runs.first();
        assert_eq!((run.time(), run.control()), (0.0, Control::Step(0.03)));
        assert!(session.animated());
    }
}
