#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod axis;
mod contour;
mod error;
mod figure;
mod geometry;
mod glyphs;
mod label;
mod layout;
mod lines;
mod paint;
mod pdf;
mod raster;
mod shape;
mod stability;
mod style;
mod svg;
// Whole charts take hours under Miri.
#[cfg(all(test, not(miri)))]
mod tests;
mod work_precision;

pub use axis::Axis;
pub use error::Error;
pub use figure::Figure;
pub use geometry::Rect;
pub use label::{Anchor, FONT, Look, pieces};
pub use lines::{Line, LineChart, LinePanel};
pub use paint::{Paint, Pen};
pub use shape::Shape;
pub use stability::{Region, StabilityRegions};
pub use style::{CurveStyle, Marker};
pub use work_precision::{Curve, Guide, Mark, Measurement, Problem, WorkPrecision};
