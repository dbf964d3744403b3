//! Exports: the states of a run, frame by frame, in files that other programs read.

mod begin;
mod csv;
mod geometry;
mod glb;
mod json;
mod npz;
mod obj;
mod usd;
mod vtu;

pub use begin::{begin, check_ending};
pub use geometry::Export;
