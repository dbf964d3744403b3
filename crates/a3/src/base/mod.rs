//! Foundations of the program: failures and their exit codes, the terminal, signals, progress of
//! long runs, processor time, and the ranges of steps and tolerances.

pub mod bounds;
#[cfg(target_arch = "wasm32")]
pub mod browser;
pub mod failure;
#[cfg(not(target_arch = "wasm32"))]
pub mod fault;
pub mod holding;
#[cfg(not(target_arch = "wasm32"))]
pub mod interrupt;
pub mod monitor;
pub mod processor;
pub mod progress;
pub mod quantity;
pub mod report;
pub mod rounding;
#[cfg_attr(target_arch = "wasm32", path = "console.rs")]
pub mod terminal;
#[cfg(not(target_arch = "wasm32"))]
pub mod verdict;
pub mod visible;
