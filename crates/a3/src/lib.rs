//! a3: mass-spring systems in a window, on a page and without either. The window, pictures and
//! films are the feature `window`.

#![forbid(unsafe_code)]
// Some builds leave parts of shared modules unused; the native build with the window reports dead
// code.
#![cfg_attr(
    any(not(feature = "window"), target_arch = "wasm32"),
    allow(dead_code, unused_imports)
)]
// Functions that cannot fail on a page have the signatures of the native ones, which can.
#![cfg_attr(
    target_arch = "wasm32",
    allow(clippy::unused_self, clippy::unnecessary_wraps)
)]

mod base;
mod cli;
#[cfg(not(target_arch = "wasm32"))]
mod commands;
mod draw;
#[cfg(not(target_arch = "wasm32"))]
pub mod embedded;
mod files;
#[cfg(test)]
mod hostile;
#[cfg(target_arch = "wasm32")]
pub mod page;
#[cfg(not(target_arch = "wasm32"))]
mod program;
#[cfg(feature = "window")]
mod window;

pub use base::{failure::Failure, input_error::InputError};
#[cfg(not(target_arch = "wasm32"))]
pub use program::{main, run};
