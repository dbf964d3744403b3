//! The panel's part of a session: the tuning of the scene, the settings that the panel changes, and
//! the actions that a page for teaching leaves out.

use a3_core::Scene;
use a3_files::ending::Ending;
use a3_scenes::{Defaults, Part, PartChange, Setup};

use super::action::RunAction;
use super::editor::Editor;
use super::lessons::Lessons;
use super::origin::Origin;
use super::traces::PlotSettings;

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
#[derive(Default)]
pub struct PanelState {
    /// What is open beside the picture, by the action that opens it: the panel, the measurements,
    /// the lessons or the plots.
    pub beside: Option<RunAction>,
    /// The lessons.
    pub lessons: Lessons,
    /// The actions that are left out.
    pub hidden: Hidden,
    /// The settings of the plots.
    pub plotting: PlotSettings,
    /// Number of the chosen row in the table of knobs, which keys turn.
    pub row: usize,
    /// Whether the dark theme is on, if the panel chose it.
    pub dark: Option<bool>,
    /// Text typed so far for the value of the chosen row; `None` while none is typed.
    pub typed: Option<String>,
    /// Whether the text that is typed is marked as a whole: the next letter replaces it.
    pub all_marked: bool,
    /// Index of the material that was just chosen for the scene.
    pub material: Option<usize>,
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

impl PanelState {
    /// Returns whether this is open beside the picture.
    pub fn has(&self, pane: RunAction) -> bool {
        self.beside == Some(pane)
    }

    /// Closes this, and returns whether it was open.
    pub fn close(&mut self, pane: RunAction) -> bool {
        self.beside.take_if(|open| *open == pane).is_some()
    }
}

/// The actions that a session leaves out; none, unless the address of a page says so.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Hidden {
    /// The panel, and with it all tuning.
    pub panel: bool,
    /// All other solvers than the first.
    pub solvers: bool,
    /// The lessons.
    pub lessons: bool,
}

impl Hidden {
    /// Returns why an action is left out; `None` if it is not.
    pub fn refusal(&self, action: RunAction) -> Option<&'static str> {
        match action {
            RunAction::Panel if self.panel => Some("This page has no panel."),
            RunAction::Lessons if self.lessons => Some("This page has no lessons."),
            RunAction::Solvers | RunAction::Solver(_) if self.solvers => {
                Some("This page has this solver alone.")
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::session::{Topic, session};

    #[test]
    fn what_is_hidden_is_refused_and_nothing_changes() {
        let mut session = session(&["t", "0.01"]);
        session.panel.hidden = Hidden { panel: true, solvers: true, lessons: true };
        for action in
            [RunAction::Panel, RunAction::Lessons, RunAction::Solvers, RunAction::Solver(3)]
        {
            session.readings.message = None;
            assert!(!session.act(action, 0));
            let said = session.readings.message.take().unwrap();
            assert!(said.starts_with("This page has"), "{said}");
        }
        session.toggle_list(Topic::Beside { pane: 0 });
        assert!(session.list.is_none() && session.panel.beside.is_none());
        assert_eq!(session.runs.first().method().name, "trapezoid");
    }

    #[test]
    fn scenes_that_are_not_offered_cannot_be_shown() {
        let strip = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes/strip.toml");
        let tear = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes/tear.toml");
        let mut session = session(&["t", "0.01", "--scene", "mit"]);
        session.scenes.offer(vec!["mit".into(), strip.into()]);
        assert_eq!(session.scenes.entries().len(), 2);
        let name = |session: &crate::session::Session| session.runs.first().scene().name.clone();
        for shown in ["strip", "mit", "strip"] {
            session.act(RunAction::NextScene, 0);
            assert_eq!(name(&session), shown);
        }
        assert!(!session.open(Path::new(tear)));
        assert_eq!(name(&session), "strip");
        assert!(session.open(Path::new(strip)));
    }
}
