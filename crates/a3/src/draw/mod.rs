//! Surfaces and pictures of a simulation.

#[cfg(all(feature = "window", not(target_arch = "wasm32")))]
pub mod painter;
#[cfg(feature = "window")]
pub mod show;
pub mod surfaces;
