//! Plots of what a user picks, in the page: there are none, to keep it small.

use a3_files::failure::Failure;
use egui::Context;

use super::docked::Place;
use super::panel::{PanelKey, Request};
use crate::session::{PlotRequest, Session};

/// Returns that they have no place.
pub fn place(_: &Session) -> Option<&'static Place> {
    None
}

/// Returns whether they are visible.
pub fn is_shown(_: &Session) -> bool {
    false
}

/// Draws nothing.
pub fn show(_: &Context, _: &Session) -> Option<PlotRequest> {
    None
}

/// Offers nothing.
pub fn offer(_: &Context, _: &Session) -> Option<Request> {
    None
}

/// Picks nothing.
pub fn pick(_: &mut Session, _: Option<usize>) {}

/// Does nothing.
pub fn begin_scene(_: &mut Session) {}

/// Takes no key.
pub fn press(_: &mut Session, _: PanelKey) -> bool {
    false
}

/// Does nothing.
pub fn apply(_: &mut Session, _: PlotRequest) {}

/// Writes nothing.
pub fn write(_: &Session) -> Result<String, Failure> {
    Ok(String::new())
}
