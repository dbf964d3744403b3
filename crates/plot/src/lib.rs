//! Charts for a paper, as SVG and PNG: lines of text and numbers in, a picture out. Knows nothing of simulation.

pub mod axis;
mod contour;
pub mod figure;
mod layout;
mod look;
pub mod precision;
mod rect;
pub mod regions;
#[cfg(test)]
mod tests;
mod text;
