//! Regions of stability: a panel a method, in the plane of h λ, with the eigenvalues of a problem times the step.

use std::collections::HashSet;

use super::axis::{self, Axis};
use super::contour;
use super::figure::{Figure, GREY, Point, Rect, Text};
use super::layout::{self, Level, Sign};
use super::look;

/// One method at one step.
pub struct Panel {
    pub letter: char,
    /// The method, and its step.
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

const FOOT: &str = "h in s, λ in 1/s, h λ without unit. Of λ is shown what moves: real parts are decay, imaginary parts are frequency.";
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

    /// One for all panels, but for those that would need a much larger one, or be lost in it.
    fn extents(&self) -> Vec<(Extent, bool)> {
        let own: Vec<_> = self.panels.iter().map(Panel::extent).collect();
        let mut sizes: Vec<_> = own.iter().map(|extent| extent.size()).collect();
        sizes.sort_by(f64::total_cmp);
        let median = sizes[(sizes.len() - 1) / 2];
        let is_common = |extent: &Extent| (median / 3.0..=2.5 * median).contains(&extent.size());
        let common = own
            .iter()
            .copied()
            .filter(is_common)
            .reduce(Extent::with_all);
        let choose = |own: Extent| match common {
            Some(common) if is_common(&own) => (common, true),
            _ => (own, false),
        };
        own.into_iter().map(choose).collect()
    }

    fn try_draw(
        &self,
        mut figure: Figure,
        level: Level,
        extents: &[(Extent, bool)],
    ) -> Option<Figure> {
        let size = level.size;
        let mut left = layout::heads(&mut figure, [&self.title, &self.subtitle, FOOT], level);
        layout::legend(&mut figure, &mut left, &self.entries(size), size);
        let inner = Rect::new(left.x0 + 1.6 * size, left.y0, left.x1, left.y1 - 1.5 * size);
        layout::label_below(
            &mut figure,
            Rect {
                x0: inner.x0,
                ..left
            },
            "Re(h λ)",
            "",
            size,
        );
        layout::label_left(
            &mut figure,
            Rect {
                y1: inner.y1,
                ..left
            },
            "Im(h λ)",
            "",
            size,
        );
        let [columns, rows] = layout::grid(self.panels.len(), inner, 1.15);
        let gap = 1.2 * size;
        let cell = [
            (inner.width() + gap) / columns as f64 - gap,
            (inner.height() + gap) / rows as f64 - gap,
        ];
        // As many lines below the titles as the longest needs, so that panels of a row are alike.
        let small = 0.85 * size;
        let most = if level.full { 3 } else { 1 };
        let lines = |panel: &Panel| layout::wrap(&panel.subtitle, small, cell[0]);
        let depth = self
            .panels
            .iter()
            .map(|panel| lines(panel).len())
            .max()
            .unwrap_or(0)
            .min(most);
        for (k, panel) in self.panels.iter().enumerate() {
            let x0 = inner.x0 + (k % columns) as f64 * (cell[0] + gap);
            let mut y = inner.y0 + (k / columns) as f64 * (cell[1] + gap);
            let bottom = y + cell[1] - 1.3 * small;
            let title = layout::elide(&panel.title, size, cell[0]);
            figure.text([x0, y + 0.8 * size], Text::new(&title, size).bold());
            y += 1.25 * size;
            for line in lines(panel).iter().take(depth) {
                figure.text([x0, y + 0.75 * small], Text::new(line, small).colour(GREY));
                y += 1.15 * small;
            }
            y += depth as f64 * 1.15 * small - lines(panel).len().min(depth) as f64 * 1.15 * small;
            let area = Rect::new(x0 + 2.2 * small, y + 0.3 * size, x0 + cell[0], bottom);
            if area.width() < 5.5 * size || area.height() < 5.0 * size {
                return None;
            }
            let (extent, is_common) = extents[k];
            draw_panel(&mut figure, panel, area, extent, small);
            if !is_common {
                let text = Text::new("other scale", small).colour(GREY);
                let at = [area.x0 + 0.4 * small, area.y0 + small];
                if area.holds(text.room(at)) {
                    figure.text(at, text);
                }
            }
        }
        Some(figure)
    }

    fn entries(&self, size: f64) -> Vec<(String, Sign<'_>)> {
        let colour = look::of(self.panels.first().map_or('e', |panel| panel.letter)).colour;
        let region: Sign = Box::new(move |figure, [x, y]| {
            let sample = Rect::new(
                x - 1.2 * size,
                y - 0.45 * size,
                x + 1.2 * size,
                y + 0.45 * size,
            );
            figure.rect(sample, &region_style(colour, 0.1 * size));
        });
        let mark =
            |inside| -> Sign { Box::new(move |figure, at| dot(figure, at, 0.85 * size, inside)) };
        vec![
            (
                "stable region: no step of the method grows".to_owned(),
                region,
            ),
            ("eigenvalue times step, stable".to_owned(), mark(true)),
            ("unstable".to_owned(), mark(false)),
        ]
    }
}

fn region_style(colour: &str, width: f64) -> String {
    format!(
        "fill=\"{colour}\" fill-opacity=\"0.2\" stroke=\"{colour}\" stroke-width=\"{width:.2}\""
    )
}

fn draw_panel(figure: &mut Figure, panel: &Panel, area: Rect, extent: Extent, size: f64) {
    // A margin around what has to be seen, then whatever else the panel's shape has room for.
    let middle = f64::midpoint(extent.real[0], extent.real[1]);
    let (wide, high) = (
        1.12 * (extent.real[1] - extent.real[0]),
        1.12 * 2.0 * extent.imaginary,
    );
    let unit = (area.width() / wide).min(area.height() / high);
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
        let style = format!("stroke=\"#555555\" stroke-width=\"{:.2}\"", 0.07 * size);
        figure.line(&[[area.x0, zero[1]], [area.x1, zero[1]]], &style);
        figure.line(&[[zero[0], area.y0], [zero[0], area.y1]], &style);
        // Thousands may share a place.
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
            let edge = 0.5 * size;
            let at = [
                px.clamp(area.x0 + edge, area.x1 - edge),
                py.clamp(area.y0 + edge, area.y1 - edge),
            ];
            if (px - at[0]).hypot(py - at[1]) > 1.5 * edge {
                beyond(
                    figure,
                    at,
                    [px, py],
                    0.7 * edge,
                    if inside { INSIDE } else { OUTSIDE },
                );
            } else {
                dot(figure, [px, py], size, inside);
            }
        }
    });
}

/// A dot, or a cross where the method is unstable.
fn dot(figure: &mut Figure, [x, y]: Point, size: f64, inside: bool) {
    if inside {
        let round: Vec<_> = (0..12)
            .map(|k| f64::from(k) * std::f64::consts::TAU / 12.0)
            .collect();
        let round: Vec<_> = round
            .into_iter()
            .map(|a| [x + 0.2 * size * a.cos(), y + 0.2 * size * a.sin()])
            .collect();
        figure.area(
            &[round],
            &format!(
                "fill=\"{INSIDE}\" stroke=\"#ffffff\" stroke-width=\"{:.2}\"",
                0.05 * size
            ),
        );
    } else {
        let r = 0.26 * size;
        let style = format!(
            "stroke=\"{OUTSIDE}\" stroke-width=\"{:.2}\" stroke-linecap=\"round\"",
            0.15 * size
        );
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
