//! Regions of stability: a panel a method, in the plane of h λ, with the eigenvalues of a problem times the step.

mod panel;

use super::figure::Figure;
use super::layout::{self, Level, Sign};
use super::rect::{Point, Rect};
use super::text::{GREY, Text};
use panel::{Extent, beyond, dot, region_style};

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
        let words = |panel: &Panel| {
            [(&panel.title, size), (&panel.subtitle, small)]
                .map(|(text, size)| layout::wrap(text, size, width))
        };
        let mut words: Vec<_> = self.panels.iter().map(words).collect();
        if level.full && words.iter().flatten().any(|lines| lines.len() > 3) {
            return None;
        }
        if !level.full {
            words
                .iter_mut()
                .flatten()
                .for_each(|lines| lines.truncate(1));
        }
        let depth = |k: usize| words.iter().map(|words| words[k].len()).max();
        let depth = [0, 1].map(|k| depth(k).unwrap_or(0) as f64);
        let above = 1.2 * size * depth[0] + 1.2 * small * depth[1] + 0.3 * size;
        for (k, (panel, cell)) in self.panels.iter().zip(rooms).enumerate() {
            let (extent, is_common) = extents[k];
            let [title, subtitle] = &words[k];
            let mut y = cell.y0;
            for line in title {
                figure.text([cell.x0, y + 0.8 * size], Text::new(line, size).bold());
                y += 1.2 * size;
            }
            for line in subtitle {
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
            if area.width() < 4.5 * size || area.height() < 4.5 * size {
                return None;
            }
            panel.draw(&mut figure, area, extent, small);
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
