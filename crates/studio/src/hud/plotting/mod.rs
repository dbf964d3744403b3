//! Plots of what a user picks, beside the picture (key F3).

mod chart;
mod draw;
mod request;
mod rows;
mod view;

pub use request::write;
pub use request::{apply, begin_scene, is_shown, offer, pick, place, press};
pub use view::show;
