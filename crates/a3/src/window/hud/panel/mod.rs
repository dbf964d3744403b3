//! The panel beside the picture, with knobs and plots (key Tab).

mod dial;
mod knobs;
mod plots;
mod request;
mod row;
mod seen;
mod undo;
mod values;
mod view;

pub use knobs::{tune, tuned};
pub use plots::csv;
pub use request::{PanelKey, PanelRequest, Request, apply, press, press_text};
pub use undo::undo;
pub use view::{inset, picture_size, show};

#[cfg(test)]
mod tests;
