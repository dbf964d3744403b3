//! The origin of a scene.

use a3_core::{Grid, StepLimits};
use a3_scenes::Setup;

use crate::base::input_error::InputError;
use crate::files::scene_file::Source;

/// A scene's name or file, and what the command line changes in it.
#[derive(Clone)]
pub struct Origin {
    /// The name or the file.
    pub source: Source,
    /// Grid of the cloth, if not the scene's own.
    pub grid: Option<Grid>,
    /// Limits of adaptive steps, if not the scene's own.
    pub limits: StepLimits,
}

impl Origin {
    /// Origin of a scene as it is in its file.
    pub fn of(source: Source) -> Self {
        Self {
            source,
            grid: None,
            limits: StepLimits::default(),
        }
    }

    /// Builds the scene.
    pub fn build(&self) -> Result<Setup, InputError> {
        let mut setup = self.source.build(self.grid)?;
        setup.scene.limits = self.limits.or(setup.scene.limits);
        Ok(setup)
    }
}
