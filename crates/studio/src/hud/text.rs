//! The text over the picture.

use egui::Context;

use super::help::help;
use super::panel::Request;
use super::{panes, selection, single};
use crate::session::{Pane, Readings};

/// Draws all text over the picture, and returns the request of the mouse. Sheets are below one
/// another, and the help hides them, so that nothing overlaps even in a small window.
pub fn show(ctx: &Context, panes: &[Pane], readings: &Readings) -> Option<Request> {
    match panes {
        [pane] if !readings.help => single::show(ctx, pane, readings),
        [_] => {}
        panes => panes::show(ctx, panes, readings),
    }
    if let Some(selection) = &readings.selection {
        selection::show(ctx, selection);
    }
    readings
        .help
        .then(|| help(ctx, panes.len() > 1, readings.touch))
        .flatten()
}
