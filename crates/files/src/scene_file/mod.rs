//! Scenes by name or from files: TOML, JSON, or a mesh alone.

mod files;
mod hash;
mod hung;
mod mesh;
#[cfg_attr(target_arch = "wasm32", path = "read_page.rs")]
mod read;
mod source;

pub use hash::Hash;
pub use read::read;
pub use source::Source;
