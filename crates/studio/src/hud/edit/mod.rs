//! The tools that edit the scene (key F2): their palette, and what they do.

mod act;
mod palette;

pub use act::{Aim, Throw, click, join, throw};
pub use palette::show;

#[cfg(test)]
mod deletion;
#[cfg(test)]
mod tests;
