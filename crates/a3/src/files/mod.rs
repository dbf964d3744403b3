//! Files that are read and written: scenes, checkpoints, exports, films, and states of other
//! programs.

pub mod checkpoint;
pub mod ending;
#[cfg(not(target_arch = "wasm32"))]
pub mod export;
#[cfg(all(feature = "window", not(target_arch = "wasm32")))]
pub mod film;
#[cfg(not(target_arch = "wasm32"))]
pub mod frames;
pub mod lessons;
#[cfg_attr(target_arch = "wasm32", path = "download.rs")]
pub mod output;
pub mod scene_file;
pub mod setup;
#[cfg(not(target_arch = "wasm32"))]
pub mod states;
