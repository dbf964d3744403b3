//! The window, from events to frames: the only module that uses winit.

mod adapter;
mod events;
#[cfg(not(target_arch = "wasm32"))]
mod filming;
mod frame;
mod graphics;
mod hover;
mod keyboard;
mod mouse;
#[cfg(not(target_arch = "wasm32"))]
mod native;
#[cfg(target_arch = "wasm32")]
mod page;
mod pick;
mod platform;
mod pointer;
mod screen;
mod start;
mod state;
mod status;
#[cfg_attr(target_arch = "wasm32", path = "no_tool.rs")]
mod tool;
mod touch;
#[cfg(not(target_arch = "wasm32"))]
mod watch;

#[cfg(target_arch = "wasm32")]
pub use platform::{Event, send};
#[cfg(target_arch = "wasm32")]
pub use start::spawn;
#[cfg(not(target_arch = "wasm32"))]
pub use start::{End, open};
