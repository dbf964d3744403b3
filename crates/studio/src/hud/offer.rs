//! The button that brings surfaces apart where they cross.

use egui::{Align2, Area, Context, Id, Order, Sense, vec2};

use super::panel::{Request, button};
use crate::session::{Action, RunAction, Session};

/// Width and height of the button (points).
const SIZE: [f32; 2] = [190.0, 30.0];
/// Distance of the button from the lower edge of the picture (points).
const DISTANCE: f32 = 24.0;
/// Height of the tools, which are there when they are open (points).
const TOOLS: f32 = 96.0;

/// Draws the button while a message offers that, and returns the request of the mouse.
pub fn show(ctx: &Context, session: &Session) -> Option<Request> {
    let readings = &session.readings;
    let hidden = readings.help || readings.asks_to_quit || session.list.is_some();
    if hidden || !readings.offers_apart {
        return None;
    }
    let tools = if session.panel.editor.open {
        TOOLS
    } else {
        0.0
    };
    let clicked = Area::new(Id::unique("apart"))
        .order(Order::Foreground)
        .anchor(Align2::CENTER_BOTTOM, [0.0, -DISTANCE - tools])
        .show(ctx, |ui| {
            let (rect, response) = ui.allocate_exact_size(vec2(SIZE[0], SIZE[1]), Sense::click());
            button(ui, rect, &response, "Bring the surfaces apart", "x");
            response.clicked()
        })
        .inner;
    clicked.then_some(Request::Act(Action::Run(RunAction::Touch)))
}
