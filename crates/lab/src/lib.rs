//! What is measured of scenes and methods, as values with their tables, pictures and data.

#![forbid(unsafe_code)]
// What is public here serves the crates of the program; the library `a3` exports what is for
// others.
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
pub mod figure_file;
pub mod judge;
pub mod motion;
pub mod simplify;
pub mod stability;
