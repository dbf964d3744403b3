//! Runs as pictures, films, and files of other programs.

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

#[cfg(not(target_arch = "wasm32"))]
pub mod export;
#[cfg(all(feature = "pictures", not(target_arch = "wasm32")))]
pub mod film;
#[cfg(all(feature = "pictures", not(target_arch = "wasm32")))]
pub mod painter;
#[cfg(feature = "pictures")]
pub mod show;
pub mod surfaces;
