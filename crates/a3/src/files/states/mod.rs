//! States of other programs: positions, and perhaps velocities, at times, as CSV, JSON or `.npz`.

mod build;
mod columns;
mod csv;
mod digits;
mod json;
mod npy;
mod npz;
mod parse;
mod read;

pub use build::States;
pub use parse::parse;
pub use read::read;
