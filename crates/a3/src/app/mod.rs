//! The window: events in, frames out. Nothing else knows winit.

mod events;
mod filming;
mod frame;
mod graphics;
mod hover;
mod keyboard;
mod mouse;
mod pick;
mod pointer;
mod remember;
mod start;
mod state;
mod status;
mod watch;

pub use start::{End, open};
