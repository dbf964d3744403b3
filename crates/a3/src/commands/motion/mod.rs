//! Motion of points in different models of a scene, and the error of a scene's own grids.

mod grid_error;
mod track;

pub use grid_error::{GridError, grid, grid_error};
pub use track::{Motion, Places, Points, Track};
