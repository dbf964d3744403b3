//! Scenes by name, or from files: TOML, the JSON of particles and springs, or a mesh alone.

mod files;
mod hash;
mod hung;
mod mesh;
mod source;

pub use source::Source;
