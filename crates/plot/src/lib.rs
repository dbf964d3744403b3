//! Charts for a paper, as SVG and PNG: text and numbers in, a picture out. Knows nothing of
//! simulation.
//!
//! Two kinds of chart compare numerical methods: a [`WorkPrecision`] diagram shows what each
//! method needs for each error, and [`StabilityRegions`] show where each is stable. Each is plain
//! data with a method `draw`, which lays the chart out on a sheet of any size so that no text
//! covers another, or says what size would do. [`Axis`] serves charts that are drawn elsewhere.
//!
//! ```
//! use a3_plot::{Curve, Measurement, Problem, CurveStyle, WorkPrecision};
//!
//! let run = |step: f64, error: f64| Measurement {
//!     error,
//!     work: 4.0 / step,
//!     lost: false,
//!     label: Some(format!("step {step} s")),
//! };
//! let chart = WorkPrecision {
//!     title: "Classical RK4 on an oscillator".into(),
//!     subtitle: "One second of motion at three steps".into(),
//!     x_label: "largest error (m)".into(),
//!     y_label: "force evaluations".into(),
//!     problems: vec![Problem {
//!         title: String::new(),
//!         curves: vec![Curve {
//!             style: CurveStyle::default(),
//!             name: "RK4".into(),
//!             runs: vec![run(0.1, 8e-7), run(0.05, 5e-8), run(0.025, 3e-9)],
//!         }],
//!         floor: Some(1e-12),
//!     }],
//!     foot: String::new(),
//! };
//! let figure = chart.draw(800.0, 600.0)?;
//! assert!(figure.svg().starts_with("<svg"));
//! assert!(figure.png(1.0)?.starts_with(b"\x89PNG"));
//! # Ok::<(), a3_plot::Error>(())
//! ```

#![forbid(unsafe_code)]

mod axis;
mod contour;
mod error;
mod figure;
mod geometry;
mod label;
mod layout;
mod stability;
mod style;
#[cfg(test)]
mod tests;
mod work_precision;

pub use axis::{Axis, Tick};
pub use error::Error;
pub use figure::Figure;
pub use stability::{Region, StabilityRegions};
pub use style::{CurveStyle, Marker};
pub use work_precision::{Curve, Measurement, Problem, WorkPrecision};

/// The example of the README, compiled as a test of documentation.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
