//! What is measured of scenes and methods, as values with their tables, pictures and data.

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

pub mod chart;
pub mod choose;
pub mod compare;
pub mod judge;
pub mod motion;
pub mod simplify;
pub mod stability;
