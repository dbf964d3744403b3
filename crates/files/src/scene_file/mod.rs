//! Scenes by name or from files: TOML, JSON, or a mesh alone.

mod files;
mod hung;
mod source;

pub use files::Hash;
pub use source::Source;
