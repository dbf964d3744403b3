//! The window and the page: sessions, the text over their pictures, and the input of the user.

#[cfg(any(target_arch = "wasm32", test))]
pub mod address;
pub mod app;
pub mod begin;
pub mod command_line;
#[cfg(not(target_arch = "wasm32"))]
pub mod compare;
#[cfg(not(target_arch = "wasm32"))]
mod headless;
pub mod hud;
mod keep;
#[cfg(not(target_arch = "wasm32"))]
mod open;
#[cfg(not(target_arch = "wasm32"))]
mod recorder;
pub mod session;
pub mod settings;

#[cfg(not(target_arch = "wasm32"))]
pub use open::open;
