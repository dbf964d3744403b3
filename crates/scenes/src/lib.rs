#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod assemble;
mod budget;
mod builtin;
mod change;
mod check;
mod description;
mod edit;
mod fault;
mod likeness;
mod list;
mod listed;
mod material;
mod mesh;
mod parts;
mod reader;
mod renumber;
mod resolution;
mod setup;
pub mod snapshot;
mod splice;
mod surface;
mod text;
mod wording;

pub use assemble::LAYERS as TANK_LAYERS;
pub use builtin::{SCENES, SceneEntry, find};
pub use change::Change as PartChange;
pub use description::*;
pub use edit::{Edit, Edited};
pub use fault::Fault;
pub use likeness::nearest;
pub use list::List;
pub use listed::parse_json;
pub use material::{MATERIALS, Material, Stuff};
pub use mesh::Mesh;
pub use parts::{Part, parts, without};
pub use reader::{Places, read};
pub use resolution::{Regridded, regridded};
pub use setup::{Defaults, Presentation, Setup, Viewpoint, surroundings};
pub use splice::Splice;
pub use surface::Surface;
pub use text::unmarked;
