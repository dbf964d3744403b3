//! The window and the page: sessions, the text over their pictures, and the input of the user.

#![forbid(unsafe_code)]
// Public items here serve the other crates of the program. The library `a3` exports those that are
// documented for everyone.
#![allow(
    missing_docs,
    clippy::missing_errors_doc,
    clippy::missing_panics_doc,
    clippy::must_use_candidate,
    clippy::return_self_not_must_use
)]
// Functions that cannot fail on a page have the signatures of the native ones, which can.
#![cfg_attr(target_arch = "wasm32", allow(clippy::unused_self, clippy::unnecessary_wraps))]

pub mod address;
mod app;
mod command_line;
#[cfg(not(target_arch = "wasm32"))]
pub mod compare;
mod hud;
mod keep;
#[cfg(not(target_arch = "wasm32"))]
mod open;
#[cfg(not(target_arch = "wasm32"))]
mod recorder;
pub mod session;
mod settings;
#[cfg_attr(target_arch = "wasm32", path = "page_storage.rs")]
mod storage;

#[cfg(target_arch = "wasm32")]
pub use app::{Event, send, spawn};
#[cfg(not(target_arch = "wasm32"))]
pub use hud::caption;
#[cfg(not(target_arch = "wasm32"))]
pub use open::open;
pub use session::begin;
#[cfg(target_arch = "wasm32")]
pub use settings::Settings;
