//! What is drawn over the picture with egui: text, the timeline, and the panel of knobs and plots.

pub mod layout;
mod overlay;
pub mod panel;
mod panes;
mod picture;
mod text;
mod timeline;

pub use overlay::Overlay;
pub use panes::digits;
pub use picture::draw;
pub use text::show;
