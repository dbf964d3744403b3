//! The question whether to quit.

use egui::{Align2, Area, Context, Id, Order, Sense, vec2};

use super::panel::{Request, button};
use super::style::{sheet, title};
use crate::session::{Action, WindowAction};

/// Width and height of a button (points).
const BUTTON_SIZE: [f32; 2] = [112.0, 28.0];

/// Asks, with a button for each answer, and returns the request of the mouse.
pub fn show(ctx: &Context) -> Option<Request> {
    let mut request = None;
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
                        let (rect, response) = ui.allocate_exact_size(
                            vec2(BUTTON_SIZE[0], BUTTON_SIZE[1]),
                            Sense::click(),
                        );
                        button(ui, rect, &response, words, key);
                        if response.clicked() {
                            request = Some(Request::Act(Action::Window(action)));
                        }
                    }
                });
            });
        });
    request
}
