//! a3: mass-spring systems in a window, on a page and without either. The window, pictures and
//! films are the feature `window`.

#![forbid(unsafe_code)]
// Parts of modules that several builds share are for one of them alone; the program with its
// window finds what is dead.
#![cfg_attr(
    any(not(feature = "window"), target_arch = "wasm32"),
    allow(dead_code, unused_imports)
)]
// What a page does at once has the form of what may fail elsewhere.
#![cfg_attr(
    target_arch = "wasm32",
    allow(clippy::unused_self, clippy::unnecessary_wraps)
)]

mod base;
mod cli;
#[cfg(not(target_arch = "wasm32"))]
mod commands;
mod draw;
mod files;
#[cfg(test)]
mod hostile;
#[cfg(target_arch = "wasm32")]
pub mod page;
#[cfg(not(target_arch = "wasm32"))]
mod program;
#[cfg(feature = "window")]
mod window;

#[cfg(not(target_arch = "wasm32"))]
pub use program::main;
