//! Long runs, with a progress bar where there is a terminal.

#[cfg(not(target_arch = "wasm32"))]
mod bar;
mod march;
#[cfg(target_arch = "wasm32")]
mod page;

#[cfg(not(target_arch = "wasm32"))]
pub use bar::{Bar, advance};
pub use march::march;
#[cfg(target_arch = "wasm32")]
pub use page::advance;
