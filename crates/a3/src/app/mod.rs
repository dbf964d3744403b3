//! The window: events in, frames out. Nothing else knows winit.

mod events;
#[cfg(not(target_arch = "wasm32"))]
mod filming;
mod frame;
mod graphics;
mod hover;
mod keyboard;
mod layer;
mod mouse;
mod pick;
#[cfg_attr(not(target_arch = "wasm32"), path = "native.rs")]
#[cfg_attr(target_arch = "wasm32", path = "page.rs")]
mod platform;
mod pointer;
mod remember;
mod start;
mod state;
mod status;
#[cfg(not(target_arch = "wasm32"))]
mod watch;

#[cfg(target_arch = "wasm32")]
pub use platform::{Event, send};
#[cfg(target_arch = "wasm32")]
pub use start::spawn;
#[cfg(not(target_arch = "wasm32"))]
pub use start::{End, open};
