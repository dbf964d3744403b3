//! What each method looks like, on every chart. Its family shows three times: in the hue, the dash and the kind of marker.
//! Colours after Okabe and Ito, and Tol: told apart with any kind of colour vision.

use std::f64::consts::TAU;

use super::figure::{Figure, stroke};
use super::rect::Point;

/// Colour, dash and marker of a method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    pub colour: &'static str,
    /// Lengths of dash and gap, in widths of the line.
    dash: &'static [f64],
    shape: Shape,
}

/// Corners on a circle, and a turn in turns.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    Polygon(u8, f64),
    /// Corners, and where the dents are between centre and corners.
    Star(u8, f64),
    /// Four beams.
    Cross(f64),
}

const EXPLICIT: &[f64] = &[];
const SYMPLECTIC: &[f64] = &[7.0, 2.5];
const ADAPTIVE: &[f64] = &[1.5, 1.8];
const IMPLICIT: &[f64] = &[7.0, 2.0, 1.5, 2.0];

/// The look of a method by its letter. What has none is grey.
pub fn of(letter: char) -> Look {
    use Shape::{Cross, Polygon, Star};
    let (colour, dash, shape) = match letter {
        'e' => ("#d55e00", EXPLICIT, Polygon(32, 0.0)),
        't' => ("#e69f00", EXPLICIT, Polygon(4, 0.125)),
        'm' => ("#8c8a2b", EXPLICIT, Polygon(4, 0.0)),
        'r' => ("#882255", EXPLICIT, Polygon(5, 0.0)),
        's' => ("#3f9fdc", SYMPLECTIC, Polygon(3, 0.5)),
        'v' => ("#0072b2", SYMPLECTIC, Polygon(3, 0.0)),
        'p' => ("#332288", SYMPLECTIC, Polygon(3, 0.25)),
        'f' => ("#cc79a7", ADAPTIVE, Star(4, 0.4)),
        'a' => ("#a03494", ADAPTIVE, Star(5, 0.42)),
        'x' => ("#000000", ADAPTIVE, Star(6, 0.45)),
        'i' => ("#35a596", IMPLICIT, Cross(0.0)),
        'b' => ("#009e73", IMPLICIT, Cross(0.125)),
        'n' => ("#117733", IMPLICIT, Polygon(6, 0.0)),
        _ => ("#777777", EXPLICIT, Polygon(8, 0.0)),
    };
    Look {
        colour,
        dash,
        shape,
    }
}

impl Look {
    /// A line of this method, as attributes of SVG.
    pub fn stroke(self, width: f64) -> String {
        let dash: Vec<_> = self
            .dash
            .iter()
            .map(|d| format!("{:.2}", d * width))
            .collect();
        let dash = if dash.is_empty() {
            String::new()
        } else {
            format!(" stroke-dasharray=\"{}\"", dash.join(" "))
        };
        stroke(self.colour, width) + &dash
    }

    /// A marker of this method: filled, or open for a run that was lost.
    pub fn marker(self, figure: &mut Figure, centre: Point, radius: f64, open: bool) {
        let (colour, line) = (self.colour, 0.22 * radius);
        let style = if open {
            format!("fill=\"#ffffff\" {}", stroke(colour, 1.3 * line))
        } else {
            format!("fill=\"{colour}\" {}", stroke("#ffffff", line))
        };
        figure.area(&[self.outline(centre, radius)], &style);
    }

    fn outline(self, [x, y]: Point, r: f64) -> Vec<Point> {
        let at = |turn: f64, r: f64| [x + r * (TAU * turn).sin(), y - r * (TAU * turn).cos()];
        match self.shape {
            Shape::Polygon(n, turn) => {
                // Of the same weight to the eye, whatever the number of corners.
                let r = r * match n {
                    3 => 1.25,
                    4 => 1.15,
                    _ => 1.0,
                };
                (0..n)
                    .map(|k| at(turn + f64::from(k) / f64::from(n), r))
                    .collect()
            }
            Shape::Star(n, dent) => (0..2 * n)
                .map(|k| {
                    at(
                        f64::from(k) / f64::from(2 * n),
                        1.35 * r * if k % 2 == 0 { 1.0 } else { dent },
                    )
                })
                .collect(),
            Shape::Cross(turn) => (0..4)
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
