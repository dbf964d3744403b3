//! Plots of what a user picks, in the page: there are none, to keep it small.

use a3_files::failure::Failure;
use egui::Context;

use crate::session::{Action, PlotRequest, Session};

/// Offers nothing.
pub fn offer(_: &Context, _: &Session) -> Option<Action> {
    None
}

/// Picks nothing.
pub fn picked(_: &Session, _: Option<usize>) -> Option<PlotRequest> {
    None
}

/// Writes nothing.
pub fn write_files(_: &Session) -> Result<String, Failure> {
    Ok(String::new())
}
