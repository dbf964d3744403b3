//! The window, from events to frames: the only module that uses winit.

mod events;
mod graphics;
mod keyboard;
mod mouse;
mod pick;
#[cfg_attr(target_arch = "wasm32", path = "page.rs")]
mod platform;
mod pointer;
mod screen;
mod start;
mod state;
mod status;
mod touch;

#[cfg(target_arch = "wasm32")]
pub use platform::{Event, send};
#[cfg(target_arch = "wasm32")]
pub use start::spawn;
#[cfg(not(target_arch = "wasm32"))]
pub use start::{End, open};
