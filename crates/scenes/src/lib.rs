#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

#[macro_use]
mod fault;

mod assemble;
mod budget;
mod builtin;
mod description;
mod edit;
mod list;
mod material;
mod mesh;
mod parts;
mod reader;
mod resolution;
mod setup;
pub mod snapshot;
mod text;
mod wording;

pub use assemble::LAYERS as TANK_LAYERS;
pub use builtin::{SCENES, SceneEntry, find};
pub use description::*;
pub use edit::{Edit, Edited, Splice};
pub use fault::Fault;
pub use list::{List, parse_json};
pub use material::{MATERIALS, Material, Stuff};
pub use mesh::Mesh;
pub use parts::{Change as PartChange, Part, parts, without};
pub use reader::{Places, read};
pub use resolution::{Regridded, regridded};
pub use setup::{Defaults, Presentation, Setup, Surface, Viewpoint, surroundings};
pub use text::unmarked;
pub use wording::nearest;
