//! The interface of all film formats.

use a3_files::failure::Failure;
use a3_files::frames::FrameTimes;

/// A film that is being written. Frames are rows from the top, four bytes a pixel.
pub trait Film: Send {
    /// Adds a frame.
    fn add(&mut self, pixels: &[u8]) -> Result<(), Failure>;

    /// Completes the film after its last frame.
    fn finish(self: Box<Self>) -> Result<(), Failure>;
}

/// A film, and the times of its frames.
pub type TimedFilm = (FrameTimes, Box<dyn Film>);
