//! The tools that edit the scene (key F2): their palette, and what they do.

mod act;
mod palette;

pub use act::{Aim, click, join};
pub use palette::show;

#[cfg(test)]
mod deletion;
#[cfg(test)]
mod tests;
