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

mod bounds;
mod checkpoint;
mod cli;
mod failure;
mod holding;
#[cfg(test)]
mod hostile;
mod lessons;
mod progress;
mod rounding;
mod scene_file;
mod setup;
mod summary;
mod surfaces;

// The window, and the page.
#[cfg(feature = "window")]
mod app;
#[cfg(feature = "window")]
mod begin;
#[cfg(feature = "window")]
mod command_line;
#[cfg(feature = "window")]
mod hud;
#[cfg(feature = "window")]
mod keep;
#[cfg(feature = "window")]
mod session;
#[cfg(feature = "window")]
mod settings;
#[cfg(feature = "window")]
mod show;

// The program.
#[cfg(not(target_arch = "wasm32"))]
mod chart;
#[cfg(not(target_arch = "wasm32"))]
mod choose;
#[cfg(all(feature = "window", not(target_arch = "wasm32")))]
mod compare;
#[cfg(not(target_arch = "wasm32"))]
mod export;
#[cfg(all(feature = "window", not(target_arch = "wasm32")))]
mod film;
#[cfg(not(target_arch = "wasm32"))]
mod frames;
#[cfg(all(feature = "window", not(target_arch = "wasm32")))]
mod headless;
#[cfg(not(target_arch = "wasm32"))]
mod interrupt;
#[cfg(not(target_arch = "wasm32"))]
mod list;
#[cfg(not(target_arch = "wasm32"))]
mod manual;
#[cfg(not(target_arch = "wasm32"))]
mod output;
#[cfg(all(feature = "window", not(target_arch = "wasm32")))]
mod painter;
#[cfg(not(target_arch = "wasm32"))]
mod program;
#[cfg(all(feature = "window", not(target_arch = "wasm32")))]
mod recorder;
#[cfg(all(feature = "window", not(target_arch = "wasm32")))]
mod render;
#[cfg(not(target_arch = "wasm32"))]
mod share;
#[cfg(not(target_arch = "wasm32"))]
mod simulate;
#[cfg(not(target_arch = "wasm32"))]
mod stability;
#[cfg(not(target_arch = "wasm32"))]
mod sweep;
#[cfg(not(target_arch = "wasm32"))]
mod verdict;
#[cfg(all(feature = "window", not(target_arch = "wasm32")))]
mod window;

// The page.
#[cfg(target_arch = "wasm32")]
mod browser;
#[cfg(target_arch = "wasm32")]
#[path = "browser/output.rs"]
mod output;
#[cfg(target_arch = "wasm32")]
pub mod page;

#[cfg(not(target_arch = "wasm32"))]
pub use program::main;
