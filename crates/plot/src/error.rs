//! What can go wrong with a chart.

use std::fmt;

/// The reason why there is no chart, or no picture of it.
#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    /// A chart without anything to draw, and what it lacks.
    Empty(&'static str),
    /// The width and height of a sheet that is too large for any chart, or has no area.
    Sheet([f64; 2]),
    /// The width and height of a sheet too small for the chart, and those of a larger one of the
    /// same shape that would do, if there is any.
    TooSmall {
        /// The sheet that was asked for.
        sheet: [f64; 2],
        /// The sheet that would do.
        enough: Option<[f64; 2]>,
    },
    /// What was wrong with the pixels of a picture.
    Pixels(String),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Empty(what) => f.write_str(what),
            Self::Sheet([w, h]) => {
                write!(f, "{w} x {h}: a chart is 1 to 20000 units wide and high")
            }
            Self::TooSmall {
                sheet: [w, h],
                enough,
            } => {
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
