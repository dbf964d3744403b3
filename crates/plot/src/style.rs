//! Styles of curves: a colour, a dash and a marker, so that curves can be distinguished without
//! colour.

use std::f64::consts::TAU;

use crate::figure::Figure;
use crate::geometry::Point;
use crate::paint::{Paint, Pen};

/// The colour, dash and marker of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveStyle {
    /// The colour, as `#` and six hexadecimal digits, such as `#0072b2`.
    pub colour: &'static str,
    /// The lengths of dashes and gaps in turn, in widths of the line; empty for a solid line.
    pub dash: &'static [f64],
    /// The shape of the markers.
    pub marker: Marker,
}

/// The shape of a marker. Rotations are given in turns, clockwise from the vertical.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Marker {
    /// A regular polygon with a number of corners, rotated.
    Polygon(u8, f64),
    /// A star with a number of corners, and the ratio of its inner to its outer radius.
    Star(u8, f64),
    /// Four beams, rotated.
    Cross(f64),
}

impl Default for CurveStyle {
    /// Creates a solid grey line with octagons.
    fn default() -> Self {
        Self::new("#777777", &[], Marker::Polygon(8, 0.0))
    }
}

/// The filled part of a marker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Filling {
    /// All of it.
    Full,
    /// Half of it, for a run in which something other than the method intervened.
    Half,
    /// None of it, for a run that blew up.
    None,
}

impl CurveStyle {
    /// Creates a style.
    #[must_use]
    pub const fn new(colour: &'static str, dash: &'static [f64], marker: Marker) -> Self {
        Self { colour, dash, marker }
    }

    /// Returns the pen of a line in this style.
    #[must_use]
    pub fn pen(self, width: f64) -> Pen {
        let dash = self.dash.iter().map(|d| d * width).collect();
        Pen::new(self.colour, width).dashed(dash)
    }

    /// Draws a marker.
    pub(crate) fn draw_marker(
        self,
        figure: &mut Figure,
        centre: Point,
        radius: f64,
        filling: Filling,
    ) {
        let (colour, line) = (self.colour, 0.22 * radius);
        let outline = self.outline(centre, radius);
        let open = Paint::fill("#ffffff").outlined(Pen::new(colour, 1.3 * line));
        match filling {
            Filling::Full => {
                let paint = Paint::fill(colour).outlined(Pen::new("#ffffff", line));
                figure.area(vec![outline], paint);
            }
            Filling::None => figure.area(vec![outline], open),
            Filling::Half => {
                // The left half: points of the outline on the right are moved to the middle.
                let left = outline.iter().map(|[x, y]| [x.min(centre[0]), *y]);
                let left: Vec<_> = left.collect();
                figure.area(vec![outline], open);
                figure.area(vec![left], Paint::fill(colour));
            }
        }
    }

    /// Returns the corners of a marker of a radius around a centre. The marker is seen as a whole
    /// from its centre.
    pub(crate) fn outline(self, [x, y]: [f64; 2], r: f64) -> Vec<[f64; 2]> {
        let at = |turn: f64, r: f64| [x + r * (TAU * turn).sin(), y - r * (TAU * turn).cos()];
        match self.marker {
            Marker::Polygon(n, turn) => {
                // Polygons appear equally large with any number of corners.
                let r = r * match n {
                    3 => 1.25,
                    4 => 1.15,
                    _ => 1.0,
                };
                (0..n).map(|k| at(turn + f64::from(k) / f64::from(n), r)).collect()
            }
            Marker::Star(n, dent) => (0..2 * n)
                .map(|k| {
                    at(
                        f64::from(k) / f64::from(2 * n),
                        1.35 * r * if k % 2 == 0 { 1.0 } else { dent },
                    )
                })
                .collect(),
            Marker::Cross(turn) => (0..4)
                .flat_map(|k| {
                    let beam = turn + f64::from(k) / 4.0;
                    [
                        at(beam - 0.052, 1.2 * r),
                        at(beam + 0.052, 1.2 * r),
                        at(beam + 0.125, 0.54 * r),
                    ]
                })
                .collect(),
        }
    }
}
