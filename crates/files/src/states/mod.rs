//! States of other programs: positions, and perhaps velocities, at times, as CSV, JSON or `.npz`.

mod build;
mod csv;
mod digits;
mod json;
mod npy;
mod npz;
mod read;

pub use build::States;
pub use read::parse;
pub use read::read;
