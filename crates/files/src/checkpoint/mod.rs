//! Checkpoints in files: all that a run needs to continue with the same bits, also after the
//! program was killed.

#[cfg(not(target_arch = "wasm32"))]
mod file;
#[cfg(not(target_arch = "wasm32"))]
mod keeper;
mod kept;
#[cfg(target_arch = "wasm32")]
mod page;

#[cfg(not(target_arch = "wasm32"))]
pub use keeper::Keeper;
pub use kept::{ENDING, Kept};
pub use kept::{Energy, Extremes};
