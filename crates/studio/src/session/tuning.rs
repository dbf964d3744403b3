//! The panel's part of a session: the tuning of the scene, the tools that edit it, with the sizes,
//! speeds and masses of what they add, and the actions that a page for teaching leaves out.

use a3_core::{Network, Scene};
use a3_files::ending::Ending;
use a3_files::rounding::short;
use a3_scenes::{Defaults, Part, PartChange, Setup};

use super::keys::RunAction;
use super::lessons::Lessons;
use super::list::Topic;
use super::origin::Origin;
use super::runs::Runs;
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
pub struct PanelState {
    /// Whether the panel is open.
    pub open: bool,
    /// The lessons, in whose place the panel opens.
    pub lessons: Lessons,
    /// The actions that are left out.
    pub hidden: Hidden,
    /// The pane of plots, which opens in its place too.
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

impl Default for PanelState {
    fn default() -> Self {
        Self {
            open: false,
            lessons: Lessons::default(),
            hidden: Hidden::default(),
            plotting: PlotSettings::default(),
            row: 0,
            dark: None,
            typed: None,
            all_marked: false,
            material: None,
            frame_limit: 0,
            film: Ending::default(),
            film_seconds: DEFAULT_FILM_SECONDS,
            pane: 0,
            editor: Editor::default(),
        }
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
            RunAction::Solvers | RunAction::Solver(_) => self.refusal_of_solvers(),
            _ => None,
        }
    }

    /// Returns why a list is left out; `None` if it is not.
    pub fn refusal_of_list(&self, topic: Topic) -> Option<&'static str> {
        match topic {
            Topic::Scenes => None,
            Topic::Solvers { .. } | Topic::Beside { .. } => self.refusal_of_solvers(),
        }
    }

    fn refusal_of_solvers(&self) -> Option<&'static str> {
        self.solvers.then_some("This page has this solver alone.")
    }
}

/// Tool that edits the scene where the pointer clicks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    #[default]
    ThrowBall,
    ThrowBox,
    AddBall,
    AddBox,
    Particle,
    Spring,
    Rod,
    Rope,
    Delete,
}

/// Quantity of what a tool adds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Diameter of a ball, or edge of a box (m).
    Size,
    /// Speed of a throw (m/s).
    Speed,
    /// Mass of a body (kg).
    Mass,
    /// Mass of a particle (kg).
    PointMass,
    /// Stiffness of a spring (N/m).
    Stiffness,
}

impl Tool {
    /// All tools, in the order of their buttons.
    pub const ALL: [Self; 9] = [
        Self::ThrowBall,
        Self::ThrowBox,
        Self::AddBall,
        Self::AddBox,
        Self::Particle,
        Self::Spring,
        Self::Rod,
        Self::Rope,
        Self::Delete,
    ];

    /// Returns the quantities that can be set for the tool.
    pub fn measures(self) -> &'static [Measure] {
        match self {
            Self::ThrowBall | Self::ThrowBox => &[Measure::Size, Measure::Speed, Measure::Mass],
            Self::AddBall | Self::AddBox => &[Measure::Size, Measure::Mass],
            Self::Particle => &[Measure::PointMass],
            Self::Spring => &[Measure::Stiffness],
            Self::Rod | Self::Rope | Self::Delete => &[],
        }
    }

    /// Returns whether the tool throws, by a drag the faster.
    pub fn throws(self) -> bool {
        matches!(self, Self::ThrowBall | Self::ThrowBox)
    }

    /// Returns whether the tool joins two particles by a drag.
    pub fn joins(self) -> bool {
        matches!(self, Self::Spring | Self::Rod | Self::Rope)
    }
}

/// State of the tools.
#[derive(Default)]
pub struct Editor {
    /// Whether the tools are shown, and act where the mouse is pressed.
    pub open: bool,
    /// The chosen tool.
    pub tool: Tool,
    /// Values of the quantities that fit the scene, and those that are set.
    values: Option<[[f64; 2]; 5]>,
}

impl Editor {
    /// Shows the tools, or hides them.
    pub fn toggle(&mut self, runs: &Runs) {
        self.open = !self.open;
        self.fit(runs);
    }

    /// Gives all quantities values that fit the scene, unless they have some.
    pub fn fit(&mut self, runs: &Runs) {
        let fit = || fitting(runs).map(|value| [value; 2]);
        self.values.get_or_insert_with(fit);
    }

    /// Forgets all values, because the scene is another one.
    pub fn forget(&mut self, runs: &Runs) {
        self.values = self.open.then(|| fitting(runs).map(|value| [value; 2]));
    }

    /// Returns the value that is set for a quantity.
    pub fn value(&self, measure: Measure) -> f64 {
        self.both(measure)[1]
    }

    /// Returns the value of a quantity that fits the scene, and that which is set.
    pub fn both(&self, measure: Measure) -> [f64; 2] {
        self.values.map_or([1.0; 2], |all| all[measure as usize])
    }

    /// Sets the value of a quantity.
    pub fn set(&mut self, measure: Measure, value: f64) {
        if let Some(all) = &mut self.values {
            all[measure as usize][1] = value;
        }
    }
}

/// Returns values of all quantities that fit the scene.
fn fitting(runs: &Runs) -> [f64; 5] {
    let view = runs.panes[0].show.presentation.viewpoint;
    let distance = (view.eye - view.target).norm();
    let network = runs.first().model().network();
    let all = network.map_or(&[][..], Network::masses).iter().enumerate();
    let carried = |i: &usize| network.is_some_and(|network| network.body_of(*i).is_some());
    let free: Vec<_> = all.filter(|(i, _)| !carried(i)).map(|(_, m)| *m).collect();
    let centers = network.into_iter().flat_map(Network::bodies);
    let bodies = centers.map(|body| network.map_or(0.0, |network| network.masses()[body.center()]));
    let (count, points) = (free.len(), free.iter().sum::<f64>());
    let total = points + bodies.sum::<f64>();
    let point = if count == 0 {
        0.1 * total
    } else {
        points / count as f64
    };
    let stiffness = network.and_then(|network| Some(network.springs().next()?.law.stiffness));
    let values = [
        0.035 * distance,
        1.3 * distance,
        if points > 0.0 {
            0.05 * total
        } else {
            0.5 * total
        },
        point,
        stiffness.unwrap_or(400.0 * point),
    ];
    values.map(|value| short(value.clamp(1e-6, 1e6), 1))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::session::session;

    #[test]
    fn what_is_hidden_is_refused_and_nothing_changes() {
        let mut session = session(&["t", "0.01"]);
        session.panel.hidden = Hidden {
            panel: true,
            solvers: true,
            lessons: true,
        };
        for action in [
            RunAction::Panel,
            RunAction::Lessons,
            RunAction::Solvers,
            RunAction::Solver(3),
        ] {
            session.readings.message = None;
            assert!(!session.act(action, 0));
            let said = session.readings.message.take().unwrap();
            assert!(said.starts_with("This page has"), "{said}");
        }
        session.toggle_list(Topic::Beside { pane: 0 });
        assert!(session.list.is_none() && !session.panel.open && !session.panel.lessons.open);
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
