//! Questions about the scene, in the page: there are none, because it has no second thread.

use egui::Context;

use super::panel::Request;
use crate::session::Session;

/// Returns whether they are visible.
pub fn is_shown(_: &Session) -> bool {
    false
}

/// Returns the size (px) of the picture beside them, in a window of `size` (px).
pub fn picture_size(size: (u32, u32), _: f32) -> (u32, u32) {
    size
}

/// Draws nothing.
pub fn show(_: &Context, _: &Session) -> Option<Request> {
    None
}
