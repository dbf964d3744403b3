//! The origin of a scene: its source and the options that change it.

use a3_core::{Grid, StepLimits};
use a3_scenes::Setup;

use crate::base::input_error::InputError;
use crate::files::scene_file::Source;

/// A scene's name or file, and the options that change it.
#[derive(Clone)]
pub struct Origin {
    /// The name or file.
    pub source: Source,
    /// Grid of the cloth, `None` for the scene's own.
    pub grid: Option<Grid>,
    /// Limits of adaptive steps, where they differ from the scene's own.
    pub limits: StepLimits,
}

impl Origin {
    /// Creates the origin of an unchanged scene.
    pub fn of(source: Source) -> Self {
        Self {
            source,
            grid: None,
            limits: StepLimits::default(),
        }
    }

    /// Builds the scene. Fails if its description is invalid.
    pub fn build(&self) -> Result<Setup, InputError> {
        let mut setup = self.source.build(self.grid)?;
        setup.scene.limits = self.limits.or(setup.scene.limits);
        Ok(setup)
    }
}
