//! The panel's part of a session: the tuning of the scene, and the state of the panel.

use a3_core::Scene;
use a3_scenes::{Defaults, Part, PartChange, Setup};

use super::editor::Editor;
use super::hidden::Hidden;
use super::lessons::Lessons;
use super::origin::Origin;
use super::traces::PlotSettings;
use crate::files::ending::Ending;

/// The original scene, and what the panel changes of it: factors, and parts that are left out.
#[derive(Clone)]
pub struct Tuning {
    /// The untuned scene, without the parts that are left out.
    pub own: Scene,
    /// Default solver and step of the scene.
    pub defaults: Defaults,
    /// Factor on the stiffness of the scene's springs.
    pub stiffness: f64,
    /// Factor on the damping of the scene's springs.
    pub damping: f64,
    /// Factor on the force or velocity of the scene's wind.
    pub gusts: f64,
    /// The parts of the scene that can be left out.
    pub parts: Vec<Part>,
    /// Indices of the parts that are left out, in order. Wind, self-collision and the floor are
    /// never among them: the runs turn them on and off.
    pub left_out: Vec<usize>,
    /// Names and values of knobs that tune parts that are left out, for when these come back.
    pub parked: Vec<(String, f64)>,
}

impl Tuning {
    /// Creates the tuning of an untuned scene from `origin`, which was built as `setup`.
    pub fn of(origin: &Origin, setup: &Setup) -> Self {
        Self {
            parts: origin.parts(&setup.scene),
            left_out: vec![],
            parked: vec![],
            own: setup.scene.clone(),
            defaults: setup.defaults,
            stiffness: 1.0,
            damping: 1.0,
            gusts: 1.0,
        }
    }

    /// Returns how each part is left out that is.
    pub fn changes(&self) -> Vec<PartChange> {
        let changes = self.left_out.iter().map(|k| self.parts[*k].change);
        changes.collect()
    }
}

/// Default simulated time that a film of the last seconds covers (s).
pub const DEFAULT_FILM_SECONDS: f64 = 5.0;

/// State of the panel, except the settings of runs, and of the pane of lessons.
pub struct PanelState {
    /// Whether the panel is open.
    pub open: bool,
    /// The lessons, in whose place the panel opens.
    pub lessons: Lessons,
    /// The actions that are left out.
    pub hidden: Hidden,
    /// The pane of plots, which opens in its place too.
    pub plotting: PlotSettings,
    /// Whether fingers are used, for which buttons are larger.
    pub touch: bool,
    /// Number of the chosen row in the table of knobs, which keys turn.
    pub row: usize,
    /// Whether the dark theme is on, if the panel chose it.
    pub dark: Option<bool>,
    /// Text typed so far for the value of the chosen row; `None` while none is typed.
    pub typed: Option<String>,
    /// Largest frame rate (1/s), or 0 for that of the screen.
    pub frame_limit: u32,
    /// The format of films.
    pub film: Ending,
    /// Simulated time that a film of the last seconds covers (s).
    pub film_seconds: f64,
    /// The pane whose settings the panel shows: the last one under the pointer.
    pub pane: usize,
    /// The tools that edit the scene.
    pub editor: Editor,
}

impl Default for PanelState {
    fn default() -> Self {
        Self {
            open: false,
            lessons: Lessons::default(),
            hidden: Hidden::default(),
            plotting: PlotSettings::default(),
            touch: false,
            row: 0,
            dark: None,
            typed: None,
            frame_limit: 0,
            film: Ending::default(),
            film_seconds: DEFAULT_FILM_SECONDS,
            pane: 0,
            editor: Editor::default(),
        }
    }
}
