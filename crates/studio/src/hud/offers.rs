//! Buttons over the picture: those that add a run beside a pane and remove it, the buttons below a
//! message, and the question whether to quit. A message of crossing surfaces offers to bring them
//! apart; one of a blow-up offers to run again with a step that would have held, or to measure
//! which solver and step serve best.

use a3_core::Control;
use a3_files::holding::Sought;
use a3_files::rounding::short;
use egui::{
    Align, Align2, Area, Color32, Context, CursorIcon, Id, Layout, Order, Pos2, Rect, Response,
    Sense, Stroke, Ui, vec2,
};

use super::layout;
use super::style::{FAINT, PAPER, TEXT, sheet, title};
use super::widgets::{Asks, button, fixed};
use crate::session::{
    Action, MAX_PANES, MeasureRequest, PanelRequest, RunAction, Session, WindowAction,
};

/// Width and height of a button on a pane (points).
const SIDE: f32 = 26.0;
/// Distance of these buttons from the edges of the pane (points).
const EDGE_GAP: f32 = 8.0;
/// Width of a pane below which it has no buttons (points).
const MIN_WIDTH: f32 = 280.0;

/// Draws the buttons of all panes, unless something covers them.
pub fn on_panes(ctx: &Context, session: &Session) {
    let (readings, count) = (&session.readings, session.runs.panes.len());
    if readings.help || readings.asks_to_quit || session.list.is_some() {
        return;
    }
    let tiles = layout::tiles_in(ctx, count).into_iter().enumerate();
    for (k, (_, room)) in tiles.filter(|(_, (_, room))| room.width() >= MIN_WIDTH) {
        let kinds = [
            (count > 1, true, PanelRequest::RemovePane(k)),
            (count < MAX_PANES, false, PanelRequest::AddPane(k)),
        ];
        let mut corner = room.right_top() + vec2(-EDGE_GAP - SIDE, EDGE_GAP);
        for (_, closes, change) in kinds.into_iter().filter(|(there, ..)| *there) {
            let place = Rect::from_min_size(corner, vec2(SIDE, SIDE));
            corner.x -= SIDE + 4.0;
            fixed(ctx, Id::unique(("pane button", k, closes)), place.min, |ui| {
                pane_button(ui, place, closes).asks(change);
            });
        }
    }
}

/// Draws a cross that closes, or a plus that adds.
fn pane_button(ui: &mut Ui, place: Rect, closes: bool) -> Response {
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
    let about = if closes { "Close this run" } else { "Run another solver beside, from here" };
    let response = response.on_hover_cursor(CursorIcon::PointingHand);
    response.on_hover_text(about)
}

/// Width and height of a button of an offer (points).
const SIZE: [f32; 2] = [190.0, 30.0];
/// Distance between buttons (points).
const GAP: f32 = 8.0;
/// Distance of the buttons from the lower edge of the picture (points).
const DISTANCE: f32 = 24.0;

/// Draws the buttons while something is offered and where they cover no text.
pub fn offer(ctx: &Context, session: &Session) {
    let readings = &session.readings;
    let offers = offers(session);
    if readings.help || readings.asks_to_quit || session.list.is_some() || offers.is_empty() {
        return;
    }
    let tools = ctx.memory(|memory| memory.area_rect(Id::unique("tools")));
    let tools = tools.filter(|_| session.panel.editor.open);
    let tools = tools.map_or(0.0, |place| place.height());
    let (room, [width, height]) = (ctx.content_rect(), SIZE.map(|side| side + GAP));
    let count = offers.len() as f32;
    let (layout, size) = if room.width() > width * count {
        (Layout::left_to_right(Align::Center), [width * count, height])
    } else {
        (Layout::top_down(Align::Center), [width, height * count])
    };
    let bottom = room.center_bottom() - vec2(0.0, DISTANCE + tools + 0.5 * size[1]);
    let place = Rect::from_center_size(bottom, size.into());
    let texts = ["run", "pane 0", "pane 1", "pane 2", "pane 3"].map(Id::unique);
    let is_taken =
        |id| ctx.memory(|memory| memory.area_rect(id)).is_some_and(|it| it.intersects(place));
    if texts.into_iter().any(is_taken) || !room.contains_rect(place) {
        return;
    }
    Area::new(Id::unique("offers"))
        .order(Order::Foreground)
        .anchor(Align2::CENTER_BOTTOM, [0.0, -DISTANCE - tools])
        .show(ctx, |ui| {
            ui.with_layout(layout, |ui| {
                for (words, key, offer) in offers {
                    let (rect, _) = ui.allocate_exact_size(SIZE.into(), Sense::hover());
                    button(ui, rect, &words, key).asks(offer);
                }
            });
        });
}

/// Returns the buttons below the message, each with its words, its key and its action.
fn offers(session: &Session) -> Vec<(String, &'static str, Action)> {
    let mut all = vec![];
    if session.readings.offers_apart {
        let words = "Bring the surfaces apart".into();
        all.push((words, "x", RunAction::Touch.into()));
    }
    let panes = session.runs.panes.iter().enumerate();
    for (k, pane) in panes.filter(|(_, pane)| !pane.alive()) {
        let again = match pane.limit.sought.and_then(Sought::control) {
            Some(Control::Step(step)) => format!("Run with {} ms", short(1e3 * step, 3)),
            Some(Control::Tolerance(tolerance)) => format!("Run with {tolerance:e}"),
            None => continue,
        };
        let name = match session.runs.panes.len() {
            1 => again,
            _ => format!("{again} in pane {}", k + 1),
        };
        all.push((name, "", PanelRequest::RunAgain(k).into()));
    }
    let dead = session.runs.panes.iter().any(|pane| !pane.alive());
    if dead && session.measuring.answerer.is_some() {
        all.push(("Let a3 choose".into(), "", MeasureRequest::Choose.into()));
    }
    all
}

/// Width and height of a button of the question (points).
const BUTTON_SIZE: [f32; 2] = [112.0, 28.0];

/// Asks whether to quit, with a button for each answer.
pub fn ask_to_quit(ctx: &Context) {
    Area::new(Id::unique("question"))
        .order(Order::Foreground)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .show(ctx, |ui| {
            sheet(ui, |ui| {
                ui.label(title("Quit a3?"));
                ui.add_space(6.0);
                ui.horizontal(|ui| {
                    for (words, key, action) in [
                        ("Quit", "Enter", WindowAction::Close),
                        ("Stay", "Esc", WindowAction::Stay),
                    ] {
                        let size = BUTTON_SIZE.into();
                        let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
                        button(ui, rect, words, key).asks(action);
                    }
                });
            });
        });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{apply, session};

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
        apply(&mut session, *again, 0);
        let run = session.runs.first();
        assert_eq!((run.time(), run.control()), (0.0, Control::Step(0.03)));
        assert!(session.animated());
    }
}
