//! Particles, pins, constraints, and only those forces that a scene asks for.

mod attraction;
mod bodies;
mod build;
mod crossings;
mod elements;
mod energies;
mod evaluation;
mod holding;
mod matrix;
mod mechanics;
mod particles;
mod parts;
mod reading;
mod rigid;
mod scratch;
mod springs;
mod strain;
mod surfaces;
mod sweep;
mod tearing;

pub(crate) use attraction::{attract, let_go, mass_behind};
pub(crate) use energies::{add_wind, energy_of_errors, is_conservative};
pub(crate) use holding::{contradiction, is_nearly_singular};
pub use parts::Network;
pub use surfaces::Touch;
