#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod budget;
mod build;
mod builtin;
mod check;
mod description;
mod fault;
mod listed;
mod mesh;
mod numbers;
mod setup;
mod snapshot;
mod surface;

pub use build::LAYERS as TANK_LAYERS;
pub use builtin::{SCENES, SceneEntry, find};
pub use description::*;
pub use fault::Fault;
pub use mesh::Mesh;
pub use setup::{Defaults, Presentation, Setup, Viewpoint};
pub use surface::Surface;
