//! The panel beside the picture, with knobs and plots (key Tab).

mod dial;
mod knobs;
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
pub use parts::turn as turn_part;
pub use plots::csv;
pub use request::{PanelKey, PanelRequest, Request, apply, press, press_text};
pub use row::slider;
pub use row::{CHOSEN, HOVERED, INK, TRACK, button};
pub use tune::{tune, tuned};
pub use undo::undo;
pub use undo::{edit, of_one_body};
pub use view::{place, show};

#[cfg(test)]
mod tests;
