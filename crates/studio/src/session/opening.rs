//! What a window is to open with.

use std::path::PathBuf;

use a3_core::{Method, StepLimits};

use a3_files::setup::SceneOptions;
use a3_media::show::Manner;

/// A scene, its runs, and the first look of the window.
#[expect(clippy::struct_excessive_bools, reason = "each is an option")]
pub struct Opening {
    /// The scene's name or file.
    pub scene: String,
    /// Options of the scene.
    pub options: SceneOptions,
    /// Solver of each run, `None` for the scene's own, and its step or tolerance, `None` for the
    /// solver's own.
    pub methods: Vec<(Option<&'static Method>, Option<f64>)>,
    /// Limits of adaptive steps.
    pub limits: StepLimits,
    /// Whether surfaces pass through one another and themselves.
    pub no_contact: bool,
    /// How the runs are drawn.
    pub manner: Manner,
    /// Whether the background is light, whatever the settings say.
    pub light: bool,
    /// Whether the runs are paused.
    pub paused: bool,
    /// Whether the window neither reads nor writes its settings.
    pub no_settings: bool,
    /// Whether the scene's file is loaded again whenever it is saved.
    pub watch: bool,
    /// Checkpoint from which the run continues.
    pub resume: Option<PathBuf>,
    /// Whether the window writes what is on the screen as lines of text.
    pub status: bool,
}
