//! The text over the picture.

use egui::{Align2, Context};

use super::help::help;
use super::style::{column, sheet};
use super::{panes, single, timeline};
use crate::session::{Pane, Readings};

/// Writes all text over the picture. Sheets stand below one another, and the help stands alone, so
/// that nothing overlaps in however small a window.
pub fn show(ctx: &Context, panes: &[Pane], readings: &Readings) {
    match panes {
        [pane] if !readings.help => single::show(ctx, pane, readings),
        [_] => {}
        panes => panes::show(ctx, panes, readings),
    }
    if readings.help {
        column(ctx, "help", Align2::CENTER_CENTER, [0.0, 0.0], |ui| {
            sheet(ui, |ui| help(ui, panes.len() > 1));
        });
    } else if let Some(position) = &readings.rewound {
        timeline::show(ctx, position);
    }
}
