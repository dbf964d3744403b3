//! Work against precision: a panel a problem, a curve a method, a point a run.

mod panel;

use super::axis::{self, Axis};
use super::figure::{Figure, stroke};
use super::layout::{self, Level, Sign};
use super::look;
use super::rect::Rect;
use super::text::Text;
use panel::Drawing;

/// One run of a method.
#[derive(Clone, Debug)]
pub struct Run {
    /// As the horizontal axis has it.
    pub error: f64,
    /// As the vertical axis has it.
    pub work: f64,
    /// It blew up or failed: drawn beside the chart at its work, whatever its error.
    pub lost: bool,
    /// Its step or tolerance.
    pub label: Option<String>,
}

/// The runs of a method.
#[derive(Clone, Debug)]
pub struct Curve {
    pub letter: char,
    pub name: String,
    pub runs: Vec<Run>,
}

/// One problem.
#[derive(Clone, Debug)]
pub struct Panel {
    pub title: String,
    pub curves: Vec<Curve>,
    /// How far the reference may itself be off: errors below ten times this are shaded.
    pub floor: Option<f64>,
}

/// The whole chart.
#[derive(Clone, Debug)]
pub struct Chart {
    pub title: String,
    pub subtitle: String,
    pub x_label: String,
    pub y_label: String,
    pub panels: Vec<Panel>,
    pub foot: String,
}

impl Run {
    /// Has a place on the chart. An error of 0 has one at its left end.
    fn is_drawn(&self) -> bool {
        self.work.is_finite() && self.work > 0.0
    }

    fn is_lost(&self) -> bool {
        self.lost || !self.error.is_finite() || self.error < 0.0
    }
}

impl Panel {
    /// Errors below this say nothing.
    fn trusted(&self) -> f64 {
        self.floor
            .filter(|floor| floor.is_finite())
            .map_or(0.0, |floor| 10.0 * floor)
    }

    /// Curve and run of those that no run beats in both error and work, from the smallest error up: of the errors that the
    /// reference can tell, though it can tell that those below them are smaller.
    pub fn front(&self) -> Vec<[usize; 2]> {
        let mut runs: Vec<_> = (self.curves.iter().enumerate())
            .flat_map(|(c, curve)| {
                curve
                    .runs
                    .iter()
                    .enumerate()
                    .map(move |(r, run)| ([c, r], run))
            })
            .filter(|(_, run)| run.is_drawn() && !run.is_lost())
            .collect();
        runs.sort_by(|(_, a), (_, b)| a.error.total_cmp(&b.error).then(a.work.total_cmp(&b.work)));
        let mut least = f64::INFINITY;
        runs.retain(|(_, run)| {
            let better = run.work < least;
            least = least.min(run.work);
            better && run.error > self.trusted()
        });
        runs.into_iter().map(|(place, _)| place).collect()
    }
}

const FRONT: &str = "#f8dd86";
const ROUND: &str = " stroke-linecap=\"round\"";
const SHADE: &str = "fill=\"#e6eaf0\"";

impl Chart {
    /// Draws the chart on a sheet of this size.
    ///
    /// # Errors
    /// There is nothing to draw, or not the room for it.
    pub fn draw(&self, width: f64, height: f64) -> Result<Figure, String> {
        let Some(axes) = self.axes() else {
            return Err("no run to draw: each blew up or has no work".to_owned());
        };
        layout::fit([width, height], |figure, level| {
            self.try_draw(figure, level, axes)
        })
    }

    fn runs(&self) -> impl Iterator<Item = &Run> {
        let curves = self.panels.iter().flat_map(|panel| &panel.curves);
        curves
            .flat_map(|curve| &curve.runs)
            .filter(|run| run.is_drawn())
    }

    /// Around all runs of all panels.
    fn axes(&self) -> Option<[Axis; 2]> {
        let range = |values: &mut dyn Iterator<Item = f64>| {
            values.fold(None, |range, value| {
                Some(range.map_or((value, value), |(low, high): (f64, f64)| {
                    (low.min(value), high.max(value))
                }))
            })
        };
        let errors = &mut self
            .runs()
            .filter(|run| !run.is_lost() && run.error > 0.0)
            .map(|run| run.error);
        let (least, most) = range(errors)?;
        // Runs far below what the reference can tell need no room; a limit just left of all runs is worth showing.
        let limits = || {
            self.panels
                .iter()
                .map(Panel::trusted)
                .filter(|limit| *limit > 0.0)
        };
        let (lowest, _) = range(&mut limits()).unwrap_or((least, most));
        let least = if lowest > least / 30.0 {
            least.clamp(lowest / 30.0, lowest / 2.0)
        } else {
            least
        };
        let (low, high) = range(&mut self.runs().map(|run| run.work))?;
        Some([Axis::log(least, most.max(least)), Axis::log(low, high)])
    }

    fn try_draw(&self, mut figure: Figure, level: Level, [x, y]: [Axis; 2]) -> Option<Figure> {
        let size = level.size;
        let mut left = layout::heads(
            &mut figure,
            [&self.title, &self.subtitle, &self.foot],
            level,
        );
        layout::legend(&mut figure, &mut left, &self.entries(size, &x), size);
        let numbers = axis::widest(&y.between(0.0, left.height()), size) + 0.6 * size;
        let inner = Rect::new(
            left.x0 + 1.4 * size + numbers,
            left.y0,
            left.x1 - size,
            left.y1 - 3.0 * size,
        );
        layout::label_below(
            &mut figure,
            Rect {
                x0: inner.x0,
                ..left
            },
            &self.x_label,
            "more accurate",
            size,
        );
        layout::label_left(
            &mut figure,
            Rect {
                y1: inner.y1,
                ..left
            },
            &self.y_label,
            "faster",
            size,
        );
        let strip = if self.runs().any(Run::is_lost) {
            3.4 * size
        } else {
            0.0
        };
        let merit = |[w, h]: [f64; 2]| ((w - strip) / 1.3).min(h - 1.5 * size);
        let (rooms, columns) = layout::grid(self.panels.len(), inner, 1.6 * size, merit);
        for (k, (panel, mut area)) in self.panels.iter().zip(rooms).enumerate() {
            // Below the last panel of a column there are numbers, even where the last row ends before.
            let is_last = k + columns >= self.panels.len();
            if is_last && k / columns != (self.panels.len() - 1) / columns {
                area.y1 -= 1.2 * size;
            }
            if !panel.title.is_empty() {
                let title = layout::elide(&panel.title, 1.1 * size, area.width());
                figure.text(
                    [area.x0, area.y0 + 0.85 * size],
                    Text::new(&title, 1.1 * size).bold(),
                );
                area.y0 += 1.5 * size;
            }
            let main = Rect {
                x1: area.x1 - strip,
                ..area
            };
            if main.width() < 9.0 * size || main.height() < 7.0 * size {
                return None;
            }
            let axes = [x.between(main.x0, main.x1), y.between(main.y1, main.y0)];
            // Small panels have finer lines and markers.
            let fine = (main.width() / (22.0 * size)).clamp(0.6, 1.0) * size;
            Drawing::new(panel, axes, main, size, fine).draw(
                &mut figure,
                strip,
                [is_last, k % columns == 0],
            );
        }
        Some(figure)
    }

    /// The legend: each method once, the front, and what else needs a word.
    fn entries(&self, size: f64, x: &Axis) -> Vec<(String, Sign<'_>)> {
        let mut seen = vec![];
        let mut entries: Vec<(String, Sign)> = vec![];
        for curve in self.panels.iter().flat_map(|panel| &panel.curves) {
            if seen.contains(&(curve.letter, &curve.name)) {
                continue;
            }
            seen.push((curve.letter, &curve.name));
            let look = look::of(curve.letter);
            let sign: Sign = Box::new(move |figure, [x, y]| {
                figure.line(
                    &[[x - 1.7 * size, y], [x + 1.7 * size, y]],
                    &look.stroke(0.13 * size),
                );
                look.marker(figure, [x, y], 0.4 * size, false);
            });
            entries.push((curve.name.clone(), sign));
        }
        let front: Sign = Box::new(move |figure, [x, y]| {
            let line = [[x - 1.3 * size, y], [x + 1.3 * size, y]];
            figure.line(&line, &(stroke(FRONT, 0.7 * size) + ROUND));
        });
        entries.push(("fastest for its error".to_owned(), front));
        if self.panels.iter().any(|panel| x.is_inside(panel.trusted())) {
            let shade: Sign = Box::new(move |figure, [x, y]| {
                let sample = Rect::new(
                    x - 1.6 * size,
                    y - 0.5 * size,
                    x + 1.6 * size,
                    y + 0.5 * size,
                );
                figure.rect(sample, SHADE);
            });
            entries.push(("finer than reference".to_owned(), shade));
        }
        entries
    }
}
