//! The pane of lessons beside the picture, or below it in a narrow window (key F1).

mod button;
mod contents;
mod marked;
mod place;
mod request;
mod step;
mod view;

pub use place::place;
pub use request::{apply, press_text, request};
pub use view::show;

#[cfg(test)]
mod tests;
