//! The panel's part of a session: the tuning of the scene, and the chosen row.

use a3_core::Scene;
use a3_scenes::{Defaults, Setup};

use crate::files::ending::Ending;

/// Changes to a scene that cannot be read off its model.
#[derive(Clone)]
pub struct Tuning {
    /// The scene as it was built.
    pub own: Scene,
    /// How the scene is run unless one says otherwise.
    pub defaults: Defaults,
    /// Factor of the springs' stiffness over the scene's own.
    pub stiffness: f64,
    /// Factor of the springs' damping over the scene's own.
    pub damping: f64,
    /// Factor of the wind's velocity over the scene's own.
    pub gusts: f64,
}

impl Tuning {
    /// An untuned scene.
    pub fn of(setup: &Setup) -> Self {
        Self {
            own: setup.scene.clone(),
            defaults: setup.defaults,
            stiffness: 1.0,
            damping: 1.0,
            gusts: 1.0,
        }
    }
}

/// Simulated time that a film of what was kept covers, if nothing else was chosen (s).
pub const DEFAULT_FILM_SECONDS: f64 = 5.0;

/// The panel beside the picture, as far as it is no setting of a run.
pub struct PanelState {
    /// Whether the panel is open.
    pub open: bool,
    /// The chosen row, as its number in the table of knobs: keys turn it.
    pub row: usize,
    /// What was typed so far for the value of the chosen row, while one is typed.
    pub typed: Option<String>,
    /// The most frames a second, or 0 for as many as the screen shows.
    pub frame_limit: u32,
    /// The format of films.
    pub film: Ending,
    /// Simulated time that a film of what was kept covers (s).
    pub film_seconds: f64,
    /// The pane that the panel is about: the last that the pointer was over.
    pub pane: usize,
}

impl Default for PanelState {
    fn default() -> Self {
        Self {
            open: false,
            row: 0,
            typed: None,
            frame_limit: 0,
            film: Ending::default(),
            film_seconds: DEFAULT_FILM_SECONDS,
            pane: 0,
        }
    }
}
