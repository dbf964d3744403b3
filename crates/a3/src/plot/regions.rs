//! Regions of stability: a panel a method, in the plane of h λ, with the eigenvalues of a problem times the step.

use std::collections::HashSet;
use std::f64::consts::TAU;

use super::axis::{self, Axis};
use super::contour;
use super::figure::{Figure, stroke};
use super::layout::{self, Level, Sign};
use super::look;
use super::rect::{Point, Rect};
use super::text::{GREY, Text};

/// One method at one step.
pub struct Panel {
    pub letter: char,
    /// The method, and its step. No-break spaces keep together what belongs together, here and below.
    pub title: String,
    /// Such as the largest stable step, predicted and observed.
    pub subtitle: String,
    /// The growth of the method's step at z = h λ: its spectral radius, from the real and the imaginary part of z. It is symmetric
    /// in the latter.
    pub radius: Box<dyn Fn(f64, f64) -> f64>,
    /// h λ, real and imaginary parts, for each eigenvalue λ of the problem.
    pub eigenvalues: Vec<Point>,
}

/// The whole chart.
pub struct Chart {
    pub title: String,
    pub subtitle: String,
    pub panels: Vec<Panel>,
}

const FOOT: &str = "h in s, λ in 1/s, so h λ has no unit. Real parts are growth or decay, imaginary parts oscillation; what lies in the region does not grow.";
const INSIDE: &str = "#222222";
const OUTSIDE: &str = "#d0021b";

/// The part of the plane that a panel shows at least: ends on the real axis, and the end of the imaginary one.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Extent {
    real: [f64; 2],
    imaginary: f64,
}

impl Extent {
    fn with(self, [re, im]: Point) -> Self {
        let [low, high] = self.real;
        Self {
            real: [low.min(re), high.max(re)],
            imaginary: self.imaginary.max(im.abs()),
        }
    }

    fn with_all(self, other: Self) -> Self {
        self.with([other.real[0], other.imaginary])
            .with([other.real[1], 0.0])
    }

    /// How long 1 is on a panel that just shows this, with a margin.
    fn unit(self, width: f64, height: f64) -> f64 {
        let [low, high] = self.real;
        (width / (high - low)).min(height / (2.0 * self.imaginary)) / 1.12
    }

    fn size(self) -> f64 {
        (self.real[1] - self.real[0]).max(2.0 * self.imaginary)
    }
}

impl Panel {
    fn is_stable(&self, [re, im]: Point) -> bool {
        (self.radius)(re, im) <= 1.0 + 1e-9
    }

    /// Around the region's edge, where that has an end, and the eigenvalues, unless they are far off.
    fn extent(&self) -> Extent {
        const FAR: f64 = 16.0;
        let start = Extent {
            real: [-0.5, 0.5],
            imaginary: 0.5,
        };
        let window = Rect::new(-FAR, -FAR, FAR, FAR);
        let ends = contour::outlines(|z| self.is_stable(z), window, 320)
            .into_iter()
            .filter(|outline| outline.iter().flatten().all(|part| part.abs() < FAR - 0.15))
            .flatten()
            .fold(start, Extent::with);
        let limit = 8.0 * ends.size().max(2.0);
        let near = |z: &&Point| z.iter().all(|part| part.abs() <= limit);
        self.eigenvalues
            .iter()
            .filter(near)
            .copied()
            .fold(ends, Extent::with)
    }
}

impl Chart {
    /// Draws the chart on a sheet of this size.
    ///
    /// # Errors
    /// There is nothing to draw, or not the room for it.
    pub fn draw(&self, width: f64, height: f64) -> Result<Figure, String> {
        if self.panels.is_empty() {
            return Err("no method to draw".to_owned());
        }
        let extents = self.extents();
        layout::fit([width, height], |figure, level| {
            self.try_draw(figure, level, &extents)
        })
    }

    /// One for as many panels as possible: those that need between two fifths of it and all. Whether it is shared by the most.
    fn extents(&self) -> Vec<(Extent, bool)> {
        let own: Vec<_> = self.panels.iter().map(Panel::extent).collect();
        let mut sorted = own.clone();
        sorted.sort_by(|a, b| b.size().total_cmp(&a.size()));
        let mut groups: Vec<(Extent, f64, usize)> = vec![];
        for extent in sorted {
            match groups.last_mut() {
                Some((all, largest, count)) if extent.size() >= 0.4 * *largest => {
                    *all = all.with_all(extent);
                    *count += 1;
                }
                _ => groups.push((extent, extent.size(), 1)),
            }
        }
        let most = groups.iter().map(|group| group.2).max();
        let group = |own: &Extent| {
            let mut fitting = groups.iter().rev();
            let found = fitting.find(|(_, largest, _)| own.size() <= *largest);
            found.map_or((*own, false), |(all, _, count)| {
                (*all, Some(*count) == most)
            })
        };
        own.iter().map(group).collect()
    }

    fn try_draw(
        &self,
        mut figure: Figure,
        level: Level,
        extents: &[(Extent, bool)],
    ) -> Option<Figure> {
        let size = level.size;
        let mut left = layout::heads(&mut figure, [&self.title, &self.subtitle, FOOT], level);
        layout::legend(&mut figure, &mut left, &self.entries(size, extents), size);
        let inner = Rect::new(left.x0 + 1.6 * size, left.y0, left.x1, left.y1 - 1.5 * size);
        let (below, beside) = (
            Rect {
                x0: inner.x0,
                ..left
            },
            Rect {
                y1: inner.y1,
                ..left
            },
        );
        layout::label_below(&mut figure, below, "Re(h λ)", "", size);
        layout::label_left(&mut figure, beside, "Im(h λ)", "", size);
        let small = 0.85 * size;
        let room = |[w, h]: Point| [w - 2.4 * small, h - 4.6 * size];
        let merit = |cell: Point| {
            let [w, h] = room(cell);
            let unit = |(extent, _): &(Extent, bool)| extent.unit(w, h);
            extents.iter().map(unit).fold(f64::INFINITY, f64::min)
        };
        let (rooms, _) = layout::grid(self.panels.len(), inner, 1.2 * size, merit);
        let width = rooms[0].width();
        // As many lines above each panel as the longest words need, so that panels of a row are alike.
        let most = if level.full { 3 } else { 1 };
        let words = |panel: &Panel| {
            let mut lines = [(&panel.title, size), (&panel.subtitle, small)]
                .map(|(text, size)| layout::wrap(text, size, width));
            for lines in &mut lines {
                lines.truncate(most);
            }
            lines
        };
        let depth = |k: usize| self.panels.iter().map(|panel| words(panel)[k].len()).max();
        let depth = [0, 1].map(|k| depth(k).unwrap_or(0) as f64);
        let above = 1.2 * size * depth[0] + 1.2 * small * depth[1] + 0.3 * size;
        for ((panel, cell), (extent, is_common)) in self.panels.iter().zip(rooms).zip(extents) {
            let mut y = cell.y0;
            let [title, subtitle] = words(panel);
            for line in &title {
                figure.text([cell.x0, y + 0.8 * size], Text::new(line, size).bold());
                y += 1.2 * size;
            }
            for line in &subtitle {
                figure.text(
                    [cell.x0, y + 0.8 * small],
                    Text::new(line, small).colour(GREY),
                );
                y += 1.2 * small;
            }
            let area = Rect::new(
                cell.x0 + 2.4 * small,
                cell.y0 + above,
                cell.x1,
                cell.y1 - 1.3 * small,
            );
            if area.width() < 5.5 * size || area.height() < 5.0 * size {
                return None;
            }
            draw_panel(&mut figure, panel, area, *extent, small);
            if !is_common {
                let text = Text::new("own scale", small).colour(GREY);
                let at = [area.x0 + 0.4 * small, area.y0 + small];
                if area.holds(text.room(at)) {
                    figure.text(at, text);
                }
            }
        }
        Some(figure)
    }

    fn entries(&self, size: f64, extents: &[(Extent, bool)]) -> Vec<(String, Sign<'_>)> {
        let region: Sign = Box::new(move |figure, [x, y]| {
            let sample = Rect::new(
                x - 1.2 * size,
                y - 0.45 * size,
                x + 1.2 * size,
                y + 0.45 * size,
            );
            figure.rect(sample, &region_style(GREY, 0.1 * size));
        });
        let mark =
            |inside| -> Sign { Box::new(move |figure, at| dot(figure, at, 0.85 * size, inside)) };
        let mut entries = vec![
            ("stable region".to_owned(), region),
            ("eigenvalue times step".to_owned(), mark(true)),
            ("the same, unstable".to_owned(), mark(false)),
        ];
        let is_beyond = |(panel, (extent, _)): (&Panel, &(Extent, bool))| {
            panel.eigenvalues.iter().any(|z| extent.with(*z) != *extent)
        };
        if self.panels.iter().zip(extents).any(is_beyond) {
            let wedge: Sign = Box::new(move |figure, [x, y]| {
                beyond(figure, [x, y], [x - 1.0, y], 0.3 * size, GREY);
            });
            entries.push(("farther out".to_owned(), wedge));
        }
        entries
    }
}

fn region_style(colour: &str, width: f64) -> String {
    format!(
        "fill=\"{colour}\" fill-opacity=\"0.2\" {}",
        stroke(colour, width)
    )
}

fn draw_panel(figure: &mut Figure, panel: &Panel, area: Rect, extent: Extent, size: f64) {
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
    let outlines: Vec<Vec<_>> = contour::outlines(|z| panel.is_stable(z), window, 240)
        .into_iter()
        .map(|outline| outline.into_iter().map(place).collect())
        .collect();
    let colour = look::of(panel.letter).colour;
    figure.clipped(area, |figure| {
        if !outlines.is_empty() {
            figure.area(&outlines, &region_style(colour, 0.13 * size));
        }
        let zero = place([0.0, 0.0]);
        let style = stroke("#555555", 0.07 * size);
        figure.line(&[[area.x0, zero[1]], [area.x1, zero[1]]], &style);
        figure.line(&[[zero[0], area.y0], [zero[0], area.y1]], &style);
        // The more there are, the smaller; thousands may share a place.
        let small = size * (40.0 / panel.eigenvalues.len().max(40) as f64).powf(0.25);
        let mut seen = HashSet::new();
        for z in panel
            .eigenvalues
            .iter()
            .filter(|z| z.iter().all(|part| part.is_finite()))
        {
            let [px, py] = place(*z);
            let inside = panel.is_stable(*z);
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

/// A dot, or a cross where the method is unstable.
fn dot(figure: &mut Figure, [x, y]: Point, size: f64, inside: bool) {
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
fn beyond(figure: &mut Figure, [x, y]: Point, to: Point, r: f64, colour: &str) {
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
