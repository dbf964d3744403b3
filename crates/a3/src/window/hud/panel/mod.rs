//! The panel beside the picture, with knobs and plots (key Tab).

mod dial;
mod edit;
mod knobs;
mod measure;
mod part_rows;
mod parts;
mod plots;
mod request;
mod row;
mod seen;
mod tune;
mod undo;
mod values;
mod view;

pub use dial::{Dial, DialScale, Turn};
pub use edit::{edit, of_one_body};
pub use measure::update;
pub use parts::turn as turn_part;
pub use plots::csv;
pub use request::{PanelKey, PanelRequest, Request, apply, is_shown, press, press_text};
pub use row::{CHOSEN, EDGE, HOVERED, INK, SHEET, TRACK, button, slider};
pub use tune::{tune, tuned};
pub use undo::undo;
pub use view::{picture_size, show};

#[cfg(test)]
mod tests;
