//! Readings for the text over the picture, beside those of the runs themselves.

use super::timeline::TimelinePosition;

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
