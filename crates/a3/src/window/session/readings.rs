//! Readings for the text over the picture, beside those of the runs themselves.

use web_time::{Duration, Instant};

use super::reference::ReferenceRun;
use super::timeline::TimelinePosition;

/// Time that a message stays.
const MESSAGE_DURATION: Duration = Duration::from_secs(4);

/// What is said of a film that is being made.
#[derive(Clone, Debug)]
pub struct FilmProgress {
    /// Whether it is of the session from now on, until it is stopped.
    pub live: bool,
    /// What is said of it.
    pub said: String,
}

/// A box that is drawn to pin what is in it, or to let go of it.
#[derive(Clone, Copy, Debug)]
pub struct Selection {
    /// Opposite corners (points).
    pub corners: [[f32; 2]; 2],
    /// Number of particles in it.
    pub count: usize,
    /// Whether they will be pinned, or free.
    pub pinned: bool,
}

/// Values that the text shows, taken twice a second or when something happens.
#[derive(Clone, Debug, Default)]
pub struct Readings {
    /// Whether the runs are paused.
    pub paused: bool,
    /// Whether the help is shown.
    pub help: bool,
    /// Simulated time over real time.
    pub factor: f32,
    /// Frames per second.
    pub rate: f32,
    /// Time a frame spends on steps (ms).
    pub simulating: f32,
    /// Time a frame spends on drawing and on waiting for the screen (ms).
    pub drawing: f32,
    /// Message about what just happened, shown for a few seconds.
    pub message: Option<String>,
    /// End of the message that is shown, unless it stays.
    pub message_ends: Option<Instant>,
    /// The box that is being drawn.
    pub selection: Option<Selection>,
    /// A film that is being made.
    pub film: Option<FilmProgress>,
    /// Whether there is a window, with keys to press.
    pub in_window: bool,
    /// Reason why the panes' errors are not known, if they are not.
    pub no_error: Option<&'static str>,
    /// Time past which they say little (s), where small differences grow by themselves.
    pub predictable: Option<f64>,
    /// Slow motion: simulated time goes by at 1 / 2^slowness of real time.
    pub slowness: i32,
    /// Position on the timeline after going back, unless it is the newest moment.
    pub rewound: Option<TimelinePosition>,
}

impl Readings {
    /// Shows a message for a few seconds.
    pub fn say(&mut self, message: impl Into<String>) {
        self.message = Some(message.into());
        self.message_ends = Some(Instant::now() + MESSAGE_DURATION);
    }

    /// Shows a message until there is another one.
    pub fn warn(&mut self, message: impl Into<String>) {
        self.message = Some(message.into());
        self.message_ends = None;
    }

    /// Takes down a message whose time is over, and returns when the one that is shown ends.
    pub fn message_ends(&mut self) -> Option<Instant> {
        if self.message_ends.is_some_and(|end| end <= Instant::now()) {
            self.message_ends = None;
            self.message = None;
        }
        self.message_ends
    }

    /// Takes what the reference, if there is one, tells of the panes' errors.
    pub(super) fn read_reference(&mut self, reference: Option<&ReferenceRun>) {
        self.no_error = reference.and_then(ReferenceRun::stopped);
        self.predictable = reference.and_then(ReferenceRun::predictable);
    }
}
