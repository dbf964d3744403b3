//! A session: what its runs share.

use std::path::PathBuf;
use web_time::{Duration, Instant};

use a3_core::{Path, Simulation};
use a3_render::Camera;
use a3_scenes::{Defaults, Setup};

use super::followed::Followed;
use super::history::History;
use super::list::List;
use super::meter::Meter;
use super::origin::Origin;
use super::pane::Pane;
use super::readings::Readings;
use super::reference::ReferenceRun;
use super::timeline::Timeline;
use super::tuning::{PanelState, Tuning};
use crate::failure::Failure;
use crate::scene_file::Source;
use crate::show::{Manner, Show};

/// Time that a message stays.
const MESSAGE_TIME: Duration = Duration::from_secs(4);

/// How a session begins.
#[derive(Clone, Copy, Default)]
pub struct Beginning {
    /// How the runs are shown.
    pub manner: Manner,
    /// Whether they are paused.
    pub paused: bool,
}

/// One run on the screen, or several of one scene side by side.
pub struct Session {
    /// The runs, at least one.
    pub panes: Vec<Pane>,
    /// The camera, which all panes share.
    pub camera: Camera,
    /// What the camera goes along with.
    pub(super) followed: Option<Followed>,
    /// What can be undone.
    pub history: History,
    /// Number and path of the obstacle that is being pushed, before the push.
    pub(super) pushed: Option<(usize, Path)>,
    /// Values for the text over the picture.
    pub readings: Readings,
    /// State of the panel.
    pub panel: PanelState,
    /// How the scene is run unless one says otherwise.
    pub defaults: Defaults,
    /// Changes that the panel made to the scene.
    pub tuning: Tuning,
    /// The list that is open to choose from.
    pub list: Option<List>,
    /// The checkpoint that was written or opened last.
    pub kept: Option<PathBuf>,
    /// The scenes that were asked for or opened, to come back to, the last one first.
    pub(super) asked: Vec<Origin>,
    /// The name or the file that the session began with.
    pub(super) begun: String,
    /// The scene that is shown.
    pub(super) shown: Origin,
    /// Files that were opened in earlier windows, the last one first.
    pub recent: Vec<PathBuf>,
    /// Number of the scene that is shown: the user's files come first, then those of the table.
    pub(super) scene_number: usize,
    /// The run that the errors are taken from, if there are several panes.
    pub(super) reference: Option<ReferenceRun>,
    /// Simulated time that the panes have been brought to (s): each is less than a step behind.
    pub(super) clock: f64,
    /// The last seconds of all runs.
    pub(super) timeline: Timeline,
    /// Number of steps and real time when the states were last read.
    pub(super) read: Option<(u64, Instant)>,
    /// Time spent since the readings were last taken.
    pub(super) meter: Meter,
    /// End of the message that is shown, unless it stays.
    message_ends: Option<Instant>,
}

impl Session {
    /// A session on these runs, at least one, of the scene from `origin`, which was built as
    /// `setup`.
    pub fn new(
        origin: Origin,
        setup: Setup,
        simulations: Vec<Simulation>,
        beginning: &Beginning,
    ) -> Result<Self, Failure> {
        let panes: Vec<_> = simulations
            .into_iter()
            .map(|run| {
                let presentation = setup.presentation.clone();
                let show = Show::new(presentation, beginning.manner);
                Pane::new(run, show)
            })
            .collect();
        Ok(Self {
            camera: panes[0].show.camera(),
            readings: Readings {
                paused: beginning.paused,
                ..Readings::default()
            },
            panel: PanelState::default(),
            defaults: setup.defaults,
            tuning: Tuning::of(setup.scene),
            list: None,
            followed: None,
            history: History::default(),
            pushed: None,
            recent: vec![],
            kept: None,
            shown: origin.clone(),
            scene_number: a3_scenes::SCENES
                .iter()
                .position(|entry| entry.name == origin.source.typed)
                .unwrap_or(0),
            begun: origin.source.typed.clone(),
            asked: vec![origin],
            reference: ReferenceRun::new(&panes)?,
            clock: 0.0,
            timeline: Timeline::default(),
            read: None,
            meter: Meter::new(),
            message_ends: None,
            panes,
        })
    }

    /// The first run, for what is the same in all of them.
    pub fn first(&self) -> &Simulation {
        &self.panes[0].simulation
    }

    /// The name or the file of the scene that is shown.
    pub fn shown(&self) -> &Source {
        &self.shown.source
    }

    /// The origin of the scene that is shown.
    pub fn origin(&self) -> &Origin {
        &self.shown
    }

    /// Simulated time that the runs have been brought to (s).
    pub fn clock(&self) -> f64 {
        self.clock
    }

    /// Whether the next frame will look different by itself.
    pub fn animated(&self) -> bool {
        !self.readings.paused && self.panes.iter().any(Pane::alive)
    }

    /// Highlights and lists the springs of a particle, or of none.
    pub fn show_springs_of(&mut self, particle: Option<usize>) {
        for pane in &mut self.panes {
            pane.show.springs_of = particle;
        }
    }

    /// Shows a message for a few seconds.
    pub fn say(&mut self, message: impl Into<String>) {
        self.readings.message = Some(message.into());
        self.message_ends = Some(Instant::now() + MESSAGE_TIME);
    }

    /// Shows a message until there is another one.
    pub fn warn(&mut self, message: impl Into<String>) {
        self.readings.message = Some(message.into());
        self.message_ends = None;
    }

    /// Takes down a message whose time is over, and returns when the one that is shown ends.
    pub fn message_ends(&mut self) -> Option<Instant> {
        if self.message_ends.is_some_and(|end| end <= Instant::now()) {
            self.message_ends = None;
            self.readings.message = None;
        }
        self.message_ends
    }
}
