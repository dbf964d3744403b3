//! The origin of a scene.

use a3_core::Grid;

use crate::scene_file::Source;

/// A scene's name or file, and the grid of its cloth.
#[derive(Clone)]
pub struct Origin {
    /// The name or the file.
    pub source: Source,
    /// Grid of the cloth, if not the scene's own.
    pub grid: Option<Grid>,
}
