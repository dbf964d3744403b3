//! What the program reads and writes, and what all its rooms share: failures and their exit codes,
//! the terminal, signals, progress of long runs, and the ranges of options.

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

pub mod arguments;
pub mod bounds;
#[cfg(target_arch = "wasm32")]
pub mod browser;
pub mod checkpoint;
pub mod ending;
pub mod failure;
#[cfg(not(target_arch = "wasm32"))]
pub mod frames;
pub mod holding;
#[cfg(not(target_arch = "wasm32"))]
pub mod keeper;
pub mod lessons;
pub mod monitor;
#[cfg_attr(target_arch = "wasm32", path = "page.rs")]
mod platform;
pub mod processor;
pub mod progress;
pub mod quantity;
pub mod report;
pub mod rounding;
#[cfg(not(target_arch = "wasm32"))]
pub mod rows;
pub mod scene_file;
pub mod setup;
#[cfg(not(target_arch = "wasm32"))]
pub mod states;
#[cfg(not(target_arch = "wasm32"))]
pub mod verdict;
pub mod visible;

pub use platform::*;
