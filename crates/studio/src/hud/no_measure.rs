//! Questions about the scene, in the page: there are none, because it has no second thread.

use egui::Context;

use super::docked::Place;
use super::panel::Request;
use crate::session::Session;

/// Returns that they have no place.
pub fn place(_: &Session) -> Option<&'static Place> {
    None
}

/// Draws nothing.
pub fn show(_: &Context, _: &Session) -> Option<Request> {
    None
}
