//! Scenes by name, or from files: TOML, or the JSON of particles and springs.

mod files;
mod hash;
mod mesh;
mod source;

pub use source::Source;
