//! The window: events in, frames out.

mod graphics;
mod keyboard;
mod pick;
mod state;
mod status;
mod watch;

pub use state::{End, open};
