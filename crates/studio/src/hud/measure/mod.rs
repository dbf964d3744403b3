//! Questions about the scene and their answers, beside the picture (key q).

mod answer;
mod chip;
mod diagram;
mod view;

pub use chip::chip;
pub use view::{place, show};
