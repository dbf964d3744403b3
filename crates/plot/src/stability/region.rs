//! Panels: the region of a method, and the part of the plane that is shown.

use std::collections::HashSet;
use std::f64::consts::TAU;

use crate::axis::Axis;
use crate::contour;
use crate::figure::Figure;
use crate::geometry::{Point, Rect};
use crate::layout;
use crate::paint::{Paint, Pen};
use crate::style::CurveStyle;

/// The colour of eigenvalues in the region.
const INSIDE: &str = "#222222";
/// The colour of eigenvalues outside the region that grow slowly.
const SLOW: &str = "#c77700";
/// The colour of other eigenvalues outside the region.
const OUTSIDE: &str = "#d0021b";

/// Behaviour of a mode from step to step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fate {
    /// It does not grow.
    Bounded,
    /// It grows slowly.
    Slow,
    /// It grows fast.
    Fast,
}

impl Fate {
    /// Returns the colour of the symbol.
    fn colour(self) -> &'static str {
        match self {
            Self::Bounded => INSIDE,
            Self::Slow => SLOW,
            Self::Fast => OUTSIDE,
        }
    }
}

/// The stability region of a method, with the eigenvalues of a problem times a step: one panel.
pub struct Region {
    /// The style of the method; only the colour is used.
    pub style: CurveStyle,
    /// The method and its step. Lines do not break at no-break spaces, here and in the subtitle.
    pub title: String,
    /// A note, such as the largest stable step.
    pub subtitle: String,
    /// The growth of one step at z = h λ, as a function of the real and the imaginary part of z:
    /// the spectral radius. It must be symmetric in the imaginary part. Where it is at most 1, the
    /// method is stable.
    pub radius: Box<dyn Fn(f64, f64) -> f64>,
    /// The largest growth of one step that counts as slow.
    pub slow: f64,
    /// The real and the imaginary part of h λ for each eigenvalue λ of the problem.
    pub eigenvalues: Vec<[f64; 2]>,
}

/// The part of the plane that a panel has to show. It is symmetric about the real axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extent {
    /// The ends on the real axis.
    real: [f64; 2],
    /// The greatest imaginary part.
    imaginary: f64,
}

impl Extent {
    /// Returns the extent that also contains a point and its mirror image.
    pub fn with(self, [re, im]: Point) -> Self {
        let [low, high] = self.real;
        Self { real: [low.min(re), high.max(re)], imaginary: self.imaginary.max(im.abs()) }
    }

    /// Returns the extent that also contains all of another.
    pub fn with_all(self, other: Self) -> Self {
        self.with([other.real[0], other.imaginary]).with([other.real[1], 0.0])
    }

    /// Returns the length of 1 in a panel of this width and height that shows the extent with a
    /// margin.
    pub fn unit(self, width: f64, height: f64) -> f64 {
        let [low, high] = self.real;
        (width / (high - low)).min(height / (2.0 * self.imaginary)) / 1.12
    }

    /// Returns the part of the extent within the square around 0 with that half side.
    pub fn within(self, largest: f64) -> Self {
        Self {
            real: self.real.map(|end| end.clamp(-largest, largest)),
            imaginary: self.imaginary.min(largest),
        }
    }

    /// Returns the longer side.
    pub fn size(self) -> f64 {
        (self.real[1] - self.real[0]).max(2.0 * self.imaginary)
    }
}

impl Region {
    /// Returns whether the method is stable at h λ.
    fn is_stable(&self, z: Point) -> bool {
        self.fate(z) == Fate::Bounded
    }

    /// Returns the behaviour of a mode at h λ.
    fn fate(&self, [re, im]: Point) -> Fate {
        match (self.radius)(re, im) {
            bounded if bounded <= 1.0 + 1e-9 => Fate::Bounded,
            slow if slow <= self.slow => Fate::Slow,
            _ => Fate::Fast,
        }
    }

    /// Returns the extent around the boundary of the region, as far as it is bounded, and around
    /// the eigenvalues, unless they are far away.
    pub(super) fn extent(&self) -> Extent {
        const WINDOW_HALF: f64 = 16.0;
        let start = Extent { real: [-0.5, 0.5], imaginary: 0.5 };
        let window = Rect::new(-WINDOW_HALF, -WINDOW_HALF, WINDOW_HALF, WINDOW_HALF);
        let outlines = contour::outlines(|z| self.is_stable(z), window, 320);
        let ends = |outline: &&Vec<Point>| {
            outline.iter().flatten().all(|part| part.abs() < WINDOW_HALF - 0.15)
        };
        let edge = outlines.iter().filter(ends).flatten().copied().fold(start, Extent::with);
        // An unbounded region may be shown smaller, because there is less to see at its boundary.
        let far = if outlines.iter().all(|outline| ends(&outline)) { 3.0 } else { 8.0 };
        let limit = far * edge.size().max(2.0);
        let near = |z: &&Point| z.iter().all(|part| part.abs() <= limit);
        self.eigenvalues.iter().filter(near).copied().fold(edge, Extent::with)
    }

    /// Draws grid, region and eigenvalues, with labels of this size.
    pub(super) fn draw(&self, figure: &mut Figure, area: Rect, extent: Extent, size: f64) {
        let middle = f64::midpoint(extent.real[0], extent.real[1]);
        let unit = extent.unit(area.width(), area.height());
        let (dx, dy) = (area.width() / unit / 2.0, area.height() / unit / 2.0);
        let x = Axis::linear([middle - dx, middle + dx]).between(area.x0, area.x1);
        let y = Axis::linear([-dy, dy]).between(area.y1, area.y0);
        layout::axes(figure, area, [&x, &y], size, [true, true]);
        let at = |[re, im]: Point| {
            [area.centre()[0] + (re - middle) * unit, area.centre()[1] - im * unit]
        };
        // The plane is sampled slightly beyond the edges, so that the outline along the end of the
        // sample is clipped.
        let window = Rect::new(middle - 1.04 * dx, -1.04 * dy, middle + 1.04 * dx, 1.04 * dy);
        let outlines: Vec<Vec<_>> = contour::outlines(|z| self.is_stable(z), window, 240)
            .into_iter()
            .map(|outline| outline.into_iter().map(at).collect())
            .collect();
        let colour = self.style.colour;
        figure.clipped(area, |figure| {
            if !outlines.is_empty() {
                figure.area(outlines, region_paint(colour, 0.13 * size));
            }
            let zero = at([0.0, 0.0]);
            let pen = Pen::new("#555555", 0.07 * size);
            figure.line(&[[area.x0, zero[1]], [area.x1, zero[1]]], pen.clone());
            figure.line(&[[zero[0], area.y0], [zero[0], area.y1]], pen);
            // The more dots there are, the smaller they are; those that would coincide are drawn
            // once.
            let small = size * (40.0 / self.eigenvalues.len().max(40) as f64).powf(0.25);
            let mut seen = HashSet::new();
            for z in self.eigenvalues.iter().filter(|z| z.iter().all(|part| part.is_finite())) {
                let [px, py] = at(*z);
                let fate = self.fate(*z);
                if !seen.insert(((px * 4.0) as i64, (py * 4.0) as i64, fate)) {
                    continue;
                }
                let (edge, colour) = (0.5 * size, fate.colour());
                let edge_point = [
                    px.clamp(area.x0 + edge, area.x1 - edge),
                    py.clamp(area.y0 + edge, area.y1 - edge),
                ];
                if (px - edge_point[0]).hypot(py - edge_point[1]) > 1.5 * edge {
                    beyond(figure, edge_point, [px, py], 0.7 * edge, colour);
                } else {
                    sign(figure, [px, py], small, fate);
                }
            }
        });
    }
}

/// Returns the paint of a region of this colour.
pub fn region_paint(colour: &'static str, width: f64) -> Paint {
    let inside = Paint::fill(colour).opacity(0.2);
    inside.outlined(Pen::new(colour, width))
}

/// Draws an eigenvalue: a dot in the region; outside it a ring if it grows slowly, else a cross.
pub fn sign(figure: &mut Figure, [x, y]: Point, size: f64, fate: Fate) {
    let circle = |r: f64| -> Vec<Point> {
        let corner = |k: u8| (f64::from(k) * TAU / 12.0).sin_cos();
        let at = |(sin, cos): (f64, f64)| [x + r * size * cos, y + r * size * sin];
        (0..=12).map(corner).map(at).collect()
    };
    let pen = Pen::new(fate.colour(), 0.15 * size);
    match fate {
        Fate::Bounded => figure.area(vec![circle(0.2)], Paint::fill(INSIDE)),
        Fate::Slow => figure.line(&circle(0.24), pen),
        Fate::Fast => {
            let r = 0.26 * size;
            figure.line(&[[x - r, y - r], [x + r, y + r]], pen.clone());
            figure.line(&[[x - r, y + r], [x + r, y - r]], pen);
        }
    }
}

/// Draws a wedge at a point that points towards another one outside the panel.
pub fn beyond(figure: &mut Figure, [x, y]: Point, to: Point, r: f64, colour: &'static str) {
    let (dx, dy) = (to[0] - x, to[1] - y);
    let length = dx.hypot(dy);
    let (u, v) = (r * dx / length, r * dy / length);
    let wedge = vec![[x + u, y + v], [x - u - v, y - v + u], [x - u + v, y - v - u]];
    figure.area(vec![wedge], Paint::fill(colour));
}
