//! Readings for the text over the picture, besides those of each run.

use web_time::{Duration, Instant};

use super::reference::ReferenceRun;
use super::timeline::TimelinePosition;

/// Time for which a message is shown.
const MESSAGE_DURATION: Duration = Duration::from_secs(4);

/// Progress of a film that is being made.
#[derive(Clone, Debug)]
pub struct FilmProgress {
    /// Whether the film is live: it records until it is stopped.
    pub live: bool,
    /// The progress in words.
    pub said: String,
}

/// A box drawn with the mouse, whose particles will be pinned or freed.
#[derive(Clone, Copy, Debug)]
pub struct Selection {
    /// Opposite corners (points).
    pub corners: [[f32; 2]; 2],
    /// Number of particles in the box.
    pub count: usize,
    /// Whether the particles will be pinned.
    pub pinned: bool,
}

/// Values that the text shows.
#[derive(Clone, Debug, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each is shown by itself")]
pub struct Readings {
    /// Whether the runs are paused.
    pub paused: bool,
    /// Whether the help is shown.
    pub help: bool,
    /// Whether the window asks if it should close.
    pub asks_to_quit: bool,
    /// Simulated time over real time.
    pub factor: f32,
    /// Frames per second.
    pub rate: f32,
    /// Computing time of the steps of a frame (ms).
    pub simulating: f32,
    /// Time for drawing a frame, and waiting for the screen (ms).
    pub drawing: f32,
    /// Message that is shown.
    pub message: Option<String>,
    /// Time when the message disappears; `None` if it stays.
    pub message_ends: Option<Instant>,
    /// Whether the message offers to bring surfaces apart.
    pub offers_apart: bool,
    /// The box that is being drawn.
    pub selection: Option<Selection>,
    /// Progress of the film, if one is being made.
    pub film: Option<FilmProgress>,
    /// Whether there is a window, with keys to press.
    pub in_window: bool,
    /// Reason why the errors of the panes are unknown, if they are.
    pub no_error: Option<&'static str>,
    /// Time past which the errors say little (s), if the scene is known to be chaotic.
    pub predictable: Option<f64>,
    /// Slow motion: simulated time advances at 1 / 2^slowness of real time.
    pub slowness: i32,
    /// Names of the parts that are left out of the scene.
    pub left_out: Vec<String>,
    /// Position on the timeline; `None` before there are two moments.
    pub timeline: Option<TimelinePosition>,
}

impl Readings {
    /// Shows a message, as a sentence, for a few seconds.
    pub fn say(&mut self, message: impl Into<String>) {
        self.warn(message);
        self.message_ends = Some(Instant::now() + MESSAGE_DURATION);
    }

    /// Shows a message, as a sentence, until the next one.
    pub fn warn(&mut self, message: impl Into<String>) {
        self.message = Some(sentence(message.into()));
        self.message_ends = None;
        self.offers_apart = false;
    }

    /// Shows a message that surfaces cross, until the next one, and offers to bring them apart.
    pub fn offer(&mut self, message: impl Into<String>) {
        self.warn(message);
        self.offers_apart = true;
    }

    /// Removes an expired message, and returns when the shown one expires.
    pub fn message_ends(&mut self) -> Option<Instant> {
        if self.message_ends.is_some_and(|end| end <= Instant::now()) {
            self.message_ends = None;
            self.message = None;
        }
        self.message_ends
    }

    /// Returns whether the runs are at an earlier moment of the timeline than the newest.
    pub fn rewound(&self) -> bool {
        self.timeline.is_some_and(|position| position.share < 1.0)
    }

    /// Updates what is known about the errors from the reference, if there is one.
    pub(super) fn read_reference(&mut self, reference: Option<&ReferenceRun>) {
        self.no_error = reference.and_then(ReferenceRun::stopped);
        self.predictable = reference.and_then(ReferenceRun::predictable);
    }
}

/// Makes a sentence of a message: with a capital, unless it begins with a file or another name, and
/// with a full stop.
fn sentence(mut message: String) -> String {
    let first = message.split(' ').next().unwrap_or_default();
    let first = first.trim_end_matches([':', ',']);
    if !first.is_empty() && first.chars().all(|c| c.is_ascii_lowercase()) {
        message[..1].make_ascii_uppercase();
    }
    if !message.ends_with(['.', '!', '?']) {
        message.push('.');
    }
    message
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_sentences_and_names_stay_as_they_are() {
        for (message, said) in [
            ("wrote a3-cloth-1.png", "Wrote a3-cloth-1.png."),
            ("own.toml:3: no such key", "own.toml:3: no such key."),
            ("undone: 20 pins", "Undone: 20 pins."),
            ("dopri5 fits no rods", "dopri5 fits no rods."),
            ("There is no wind here.", "There is no wind here."),
            ("3 pins", "3 pins."),
        ] {
            let mut readings = Readings::default();
            readings.say(message);
            assert_eq!(readings.message.as_deref(), Some(said));
        }
    }
}
