//! The origin of a scene.

use a3_core::Grid;
use a3_scenes::Setup;

use crate::scene_file::Source;

/// A scene's name or file, and what the command line changes in it.
#[derive(Clone)]
pub struct Origin {
    /// The name or the file.
    pub source: Source,
    /// Grid of the cloth, if not the scene's own.
    pub grid: Option<Grid>,
    /// Absolute tolerance (m), if not that of the scene's size.
    pub absolute: Option<f64>,
}

impl Origin {
    /// Origin of a scene as it is in its file.
    pub fn of(source: Source) -> Self {
        Self {
            source,
            grid: None,
            absolute: None,
        }
    }

    /// Builds the scene.
    pub fn build(&self) -> Result<Setup, String> {
        let mut setup = self.source.build(self.grid)?;
        setup.scene.absolute = self.absolute;
        Ok(setup)
    }
}
