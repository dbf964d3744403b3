//! The commands of the program, a module each.

#[cfg(feature = "window")]
pub mod answer;
pub mod chart;
pub mod choose;
pub mod judge;
pub mod list;
pub mod manual;
mod picture;
#[cfg(feature = "window")]
pub mod render;
pub mod simplify;
pub mod simulate;
pub mod solvers;
pub mod stability;
pub mod sweep;
