//! One panel: how much of the plane it shows, and what is there.

use std::collections::HashSet;
use std::f64::consts::TAU;

use super::Panel;
use crate::plot::axis::{self, Axis};
use crate::plot::figure::{Figure, stroke};
use crate::plot::rect::{Point, Rect};
use crate::plot::{contour, look};

const INSIDE: &str = "#222222";
const OUTSIDE: &str = "#d0021b";

/// The part of the plane that a panel shows at least: ends on the real axis, and the end of the imaginary one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    real: [f64; 2],
    imaginary: f64,
}

impl Extent {
    /// Around a point, and its mirror image, too.
    pub fn with(self, [re, im]: Point) -> Self {
        let [low, high] = self.real;
        Self {
            real: [low.min(re), high.max(re)],
            imaginary: self.imaginary.max(im.abs()),
        }
    }

    pub fn with_all(self, other: Self) -> Self {
        self.with([other.real[0], other.imaginary])
            .with([other.real[1], 0.0])
    }

    /// How long 1 is on a panel that just shows this, with a margin.
    pub fn unit(self, width: f64, height: f64) -> f64 {
        let [low, high] = self.real;
        (width / (high - low)).min(height / (2.0 * self.imaginary)) / 1.12
    }

    /// Its longer side.
    pub fn size(self) -> f64 {
        (self.real[1] - self.real[0]).max(2.0 * self.imaginary)
    }
}

impl Panel {
    fn is_stable(&self, [re, im]: Point) -> bool {
        (self.radius)(re, im) <= 1.0 + 1e-9
    }

    /// Around the region's edge, where that has an end, and the eigenvalues, unless they are far off.
    pub fn extent(&self) -> Extent {
        const FAR: f64 = 16.0;
        let start = Extent {
            real: [-0.5, 0.5],
            imaginary: 0.5,
        };
        let window = Rect::new(-FAR, -FAR, FAR, FAR);
        let outlines = contour::outlines(|z| self.is_stable(z), window, 320);
        let ends =
            |outline: &&Vec<Point>| outline.iter().flatten().all(|part| part.abs() < FAR - 0.15);
        let edge = outlines
            .iter()
            .filter(ends)
            .flatten()
            .copied()
            .fold(start, Extent::with);
        // A region without end may be shown smaller: there is less to see at its edge.
        let far = if outlines.iter().all(|outline| ends(&outline)) {
            3.0
        } else {
            8.0
        };
        let limit = far * edge.size().max(2.0);
        let near = |z: &&Point| z.iter().all(|part| part.abs() <= limit);
        self.eigenvalues
            .iter()
            .filter(near)
            .copied()
            .fold(edge, Extent::with)
    }

    /// Grid, region and eigenvalues, with numbers of this size.
    pub fn draw(&self, figure: &mut Figure, area: Rect, extent: Extent, size: f64) {
        let middle = f64::midpoint(extent.real[0], extent.real[1]);
        let unit = extent.unit(area.width(), area.height());
        let (dx, dy) = (area.width() / unit / 2.0, area.height() / unit / 2.0);
        let x = Axis::linear([middle - dx, middle + dx]).between(area.x0, area.x1);
        let y = Axis::linear([-dy, dy]).between(area.y1, area.y0);
        axis::draw(figure, area, [&x, &y], size, [true, true]);
        let place = |[re, im]: Point| {
            [
                area.centre()[0] + (re - middle) * unit,
                area.centre()[1] - im * unit,
            ]
        };
        // Sampled a little beyond the edges, so that the end of the sample is not drawn.
        let window = Rect::new(
            middle - 1.04 * dx,
            -1.04 * dy,
            middle + 1.04 * dx,
            1.04 * dy,
        );
        let outlines: Vec<Vec<_>> = contour::outlines(|z| self.is_stable(z), window, 240)
            .into_iter()
            .map(|outline| outline.into_iter().map(place).collect())
            .collect();
        let colour = look::of(self.letter).colour;
        figure.clipped(area, |figure| {
            if !outlines.is_empty() {
                figure.area(&outlines, &region_style(colour, 0.13 * size));
            }
            let zero = place([0.0, 0.0]);
            let style = stroke("#555555", 0.07 * size);
            figure.line(&[[area.x0, zero[1]], [area.x1, zero[1]]], &style);
            figure.line(&[[zero[0], area.y0], [zero[0], area.y1]], &style);
            // The more there are, the smaller; thousands may share a place.
            let small = size * (40.0 / self.eigenvalues.len().max(40) as f64).powf(0.25);
            let mut seen = HashSet::new();
            for z in self
                .eigenvalues
                .iter()
                .filter(|z| z.iter().all(|part| part.is_finite()))
            {
                let [px, py] = place(*z);
                let inside = self.is_stable(*z);
                if !seen.insert(((px * 4.0) as i64, (py * 4.0) as i64, inside)) {
                    continue;
                }
                let (edge, colour) = (0.5 * size, if inside { INSIDE } else { OUTSIDE });
                let at = [
                    px.clamp(area.x0 + edge, area.x1 - edge),
                    py.clamp(area.y0 + edge, area.y1 - edge),
                ];
                if (px - at[0]).hypot(py - at[1]) > 1.5 * edge {
                    beyond(figure, at, [px, py], 0.7 * edge, colour);
                } else {
                    dot(figure, [px, py], small, inside);
                }
            }
        });
    }
}

/// A region in this colour, as attributes of SVG.
pub fn region_style(colour: &str, width: f64) -> String {
    format!(
        "fill=\"{colour}\" fill-opacity=\"0.2\" {}",
        stroke(colour, width)
    )
}

/// A dot, or a cross where the method is unstable.
pub fn dot(figure: &mut Figure, [x, y]: Point, size: f64, inside: bool) {
    if inside {
        let corner = |k: u8| (f64::from(k) * TAU / 12.0).sin_cos();
        let round: Vec<_> = (0..12)
            .map(corner)
            .map(|(sin, cos)| [x + 0.2 * size * cos, y + 0.2 * size * sin])
            .collect();
        figure.area(&[round], &format!("fill=\"{INSIDE}\""));
    } else {
        let r = 0.26 * size;
        let style = stroke(OUTSIDE, 0.15 * size);
        figure.line(&[[x - r, y - r], [x + r, y + r]], &style);
        figure.line(&[[x - r, y + r], [x + r, y - r]], &style);
    }
}

/// A point outside the panel: a wedge at its edge.
pub fn beyond(figure: &mut Figure, [x, y]: Point, to: Point, r: f64, colour: &str) {
    let (dx, dy) = (to[0] - x, to[1] - y);
    let length = dx.hypot(dy);
    let (u, v) = (r * dx / length, r * dy / length);
    let wedge = [
        [x + u, y + v],
        [x - u - v, y - v + u],
        [x - u + v, y - v - u],
    ];
    figure.area(&[wedge], &format!("fill=\"{colour}\""));
}
