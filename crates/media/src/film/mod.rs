//! Films: pictures of a run, frame by frame, as a GIF, an MP4 or numbered files.

mod begin;
mod gif;
mod mp4;
mod shoot;

pub use begin::{FilmOptions, begin, begin_new};
pub use shoot::{Film, shoot};
