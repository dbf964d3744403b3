//! Charts for a paper, as SVG and PNG: lines of text and numbers in, a picture out. Knows nothing of simulation.

mod axis;
mod contour;
mod figure;
mod layout;
mod look;
pub mod precision;
pub mod regions;
#[cfg(test)]
mod tests;

pub use figure::png;
