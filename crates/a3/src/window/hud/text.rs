//! The text over the picture.

use egui::Context;

use super::help::help;
use super::{panes, selection, single, timeline};
use crate::window::session::{Pane, Readings};

/// Draws all text over the picture. Sheets are below one another, and the help hides them, so that
/// nothing overlaps even in a small window.
pub fn show(ctx: &Context, panes: &[Pane], readings: &Readings) {
    match panes {
        [pane] if !readings.help => single::show(ctx, pane, readings),
        [_] => {}
        panes => panes::show(ctx, panes, readings),
    }
    if let Some(selection) = &readings.selection {
        selection::show(ctx, selection);
    }
    if readings.help {
        help(ctx, panes.len() > 1);
    } else if let Some(position) = &readings.rewound {
        timeline::show(ctx, position);
    }
}
