//! The springs of a grid, in one pass over its rows, in the widest SIMD vectors of the processor.

mod force;
mod kernel;
mod lanes;
mod laws;
mod missing;
mod model;
mod offsets;
mod strips;
mod sweep;

pub use model::Sheet;

pub(crate) use kernel::SPRING_FORCES;
pub(crate) use laws::LAWS;
pub(crate) use strips::{Quantity, set};
pub(crate) use sweep::{Advance, begin};
