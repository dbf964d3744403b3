//! The errors of charts.

use std::fmt;

/// The reason why there is no chart, or no picture of it.
#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    /// The chart has nothing to draw, and why.
    Empty(&'static str),
    /// The width and height of a sheet are not between 1 and 20000 units.
    Sheet([f64; 2]),
    /// The sheet is too small for the chart.
    TooSmall {
        /// Requested width and height.
        sheet: [f64; 2],
        /// Width and height of a sheet of the same shape that is large enough, if there is one.
        enough: Option<[f64; 2]>,
    },
    /// The picture cannot be rasterised, and why.
    Pixels(String),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Empty(what) => f.write_str(what),
            Self::Sheet([w, h]) => {
                write!(f, "{w} x {h}: a chart is 1 to 20000 units wide and high")
            }
            Self::TooSmall { sheet: [w, h], enough } => {
                write!(f, "{w} x {h}: too small for this chart; ")?;
                match enough {
                    Some([w, h]) => write!(f, "{w} x {h} would do"),
                    None => f.write_str("fewer panels would do"),
                }
            }
            Self::Pixels(why) => f.write_str(why),
        }
    }
}

impl std::error::Error for Error {}
