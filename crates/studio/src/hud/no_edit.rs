//! The tools that edit the scene, in the page: there are none, because it has to stay small.

use egui::Context;

use crate::session::{Action, Session};

/// Draws nothing.
pub fn show(_: &Context, _: &Session) -> Option<Action> {
    None
}
