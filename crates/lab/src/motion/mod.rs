//! Motion in different models of a scene, and the error that the scene's grids cause.

mod grid_error;
mod track;

pub use grid_error::{GridError, grid, grid_error};
pub use grid_error::{Known, beside, open, words};
pub use track::{Compared, Places, Track};
