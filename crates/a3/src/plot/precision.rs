//! Work against precision: a panel a problem, a curve a method, a point a run.

use super::axis::{self, Axis};
use super::figure::{Anchor, Figure, GREY, Point, Rect, Text};
use super::layout::{self, Level, Sign};
use super::look;

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

    /// Curve and run of those that no run beats in both error and work, from the smallest error up.
    pub fn front(&self) -> Vec<[usize; 2]> {
        let mut runs: Vec<_> = (self.curves.iter().enumerate())
            .flat_map(|(c, curve)| {
                curve
                    .runs
                    .iter()
                    .enumerate()
                    .map(move |(r, run)| ([c, r], run))
            })
            .filter(|(_, run)| run.is_drawn() && !run.is_lost() && run.error > self.trusted())
            .collect();
        runs.sort_by(|(_, a), (_, b)| a.error.total_cmp(&b.error).then(a.work.total_cmp(&b.work)));
        let mut least = f64::INFINITY;
        runs.retain(|(_, run)| {
            let better = run.work < least;
            least = least.min(run.work);
            better
        });
        runs.into_iter().map(|(place, _)| place).collect()
    }
}

const FRONT: &str = "stroke=\"#f8dd86\" stroke-linecap=\"round\"";

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
        layout::legend(&mut figure, &mut left, &self.entries(size), size);
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
        let [columns, rows] = layout::grid(self.panels.len(), inner, 1.25);
        let gap = 1.6 * size;
        let cell = [
            (inner.width() + gap) / columns as f64 - gap,
            (inner.height() + gap) / rows as f64 - gap,
        ];
        let strip = if self.runs().any(Run::is_lost) {
            3.0 * size
        } else {
            0.0
        };
        for (k, panel) in self.panels.iter().enumerate() {
            let (column, row) = (k % columns, k / columns);
            let x0 = inner.x0 + column as f64 * (cell[0] + gap);
            let y0 = inner.y0 + row as f64 * (cell[1] + gap);
            let mut area = Rect::new(x0, y0, x0 + cell[0], y0 + cell[1]);
            // Below the last panel of a column there are numbers, even where the last row ends before.
            let is_last = k + columns >= self.panels.len();
            if is_last && row + 1 < rows {
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
            Drawing {
                panel,
                axes,
                main,
                strip,
                size,
                taken: vec![],
                lines: vec![],
            }
            .draw(&mut figure, [is_last, column == 0]);
        }
        Some(figure)
    }

    /// The legend: each method once, the front, and what else needs a word.
    fn entries(&self, size: f64) -> Vec<(String, Sign<'_>)> {
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
                    &[[x - 1.4 * size, y], [x + 1.4 * size, y]],
                    &look.stroke(0.13 * size),
                );
                look.marker(figure, [x, y], 0.4 * size, false);
            });
            entries.push((curve.name.clone(), sign));
        }
        let front: Sign = Box::new(move |figure, [x, y]| {
            let line = [[x - 1.1 * size, y], [x + 1.1 * size, y]];
            figure.line(
                &line,
                &format!("{FRONT} stroke-width=\"{:.2}\"", 0.7 * size),
            );
        });
        entries.push(("fastest for its error".to_owned(), front));
        entries
    }
}

/// A panel while it is drawn.
struct Drawing<'a> {
    panel: &'a Panel,
    axes: [Axis; 2],
    main: Rect,
    /// The width of the place for runs that were lost.
    strip: f64,
    size: f64,
    /// Where markers are.
    taken: Vec<Rect>,
    lines: Vec<[Point; 2]>,
}

impl Drawing<'_> {
    fn at(&self, run: &Run) -> Point {
        [
            self.axes[0].at(run.error.max(f64::MIN_POSITIVE)),
            self.axes[1].at(run.work),
        ]
    }

    fn draw(&mut self, figure: &mut Figure, numbers: [bool; 2]) {
        let (main, size) = (self.main, self.size);
        let limit = self.panel.trusted();
        let shade = Rect {
            x1: if limit > 0.0 {
                self.axes[0].at(limit)
            } else {
                main.x0
            },
            ..main
        };
        figure.rect(shade, "fill=\"#e9ecf1\"");
        let strip = Rect {
            x0: main.x1,
            x1: main.x1 + self.strip,
            ..main
        };
        if self.strip > 0.0 {
            figure.rect(strip, "fill=\"#fbefec\"");
            if numbers[0] {
                let text = Text::new("blew up", size)
                    .colour("#8c2d19")
                    .anchor(Anchor::Middle);
                figure.text([strip.centre()[0], main.y1 + 1.15 * size], text);
            }
        }
        axis::draw(figure, main, [&self.axes[0], &self.axes[1]], size, numbers);
        let front: Vec<_> = (self.panel.front().into_iter())
            .map(|[c, r]| (c, &self.panel.curves[c].runs[r]))
            .collect();
        let line: Vec<_> = front.iter().map(|(_, run)| self.at(run)).collect();
        figure.line(
            &line,
            &format!("{FRONT} stroke-width=\"{:.2}\"", 0.9 * size),
        );
        self.curves(figure);
        self.lost(figure, strip);
        self.explain_shade(figure, shade);
        self.name_front(figure, &front);
        self.name_steps(figure, &front);
    }

    fn curves(&mut self, figure: &mut Figure) {
        let radius = 0.36 * self.size;
        for curve in &self.panel.curves {
            let look = look::of(curve.letter);
            let mut runs: Vec<_> = curve
                .runs
                .iter()
                .filter(|run| run.is_drawn() && !run.is_lost())
                .collect();
            runs.sort_by(|a, b| a.work.total_cmp(&b.work));
            let points: Vec<_> = runs.into_iter().map(|run| self.at(run)).collect();
            figure.line(&points, &look.stroke(0.13 * self.size));
            self.lines
                .extend(points.windows(2).map(|pair| [pair[0], pair[1]]));
            for point in points {
                look.marker(figure, point, radius, false);
                self.taken.push(Rect::around(point, 1.2 * radius));
            }
        }
    }

    /// Runs that were lost: open markers beside the chart, side by side where they would hide each other.
    fn lost(&mut self, figure: &mut Figure, strip: Rect) {
        let radius = 0.32 * self.size;
        let mut taken: Vec<Rect> = vec![];
        for curve in &self.panel.curves {
            let look = look::of(curve.letter);
            for run in curve
                .runs
                .iter()
                .filter(|run| run.is_drawn() && run.is_lost())
            {
                let [middle, y] = [strip.centre()[0], self.axes[1].at(run.work)];
                let aside = [0.0, -1.0, 1.0].map(|k| [middle + 2.6 * k * radius, y]);
                let room = |point: &Point| Rect::around(*point, radius);
                let free = |point: &&Point| !taken.iter().any(|other| other.overlaps(room(point)));
                let point = *aside.iter().find(free).unwrap_or(&aside[0]);
                taken.push(room(&point));
                look.marker(figure, point, radius, true);
            }
        }
    }

    /// Whether a text there would cover nothing.
    fn is_clear(&self, figure: &Figure, room: Rect) -> bool {
        self.main.holds(room)
            && figure.free(room)
            && !self.taken.iter().any(|other| other.overlaps(room))
            && !self.lines.iter().any(|[a, b]| room.meets(*a, *b))
    }

    /// Writes the text at the first of the places where it is clear.
    fn place(
        &self,
        figure: &mut Figure,
        text: Text,
        mut places: impl Iterator<Item = Point>,
    ) -> bool {
        let found = places.find(|at| self.is_clear(figure, text.room(*at)));
        found.inspect(|at| drop(figure.text(*at, text))).is_some()
    }

    fn explain_shade(&self, figure: &mut Figure, shade: Rect) {
        let size = 0.85 * self.size;
        for words in [
            "finer than the reference can tell",
            "below the reference",
            "unsure",
        ] {
            let text = Text::new(words, size).colour(GREY);
            let flat =
                (1..40).map(|k| [shade.x0 + 0.5 * size, shade.y1 - f64::from(k) * 0.7 * size]);
            let fits = |at: &Point| shade.holds(text.room(*at));
            if self.place(figure, text, flat.filter(fits)) {
                return;
            }
            let text = text.turned();
            let across = (1..12).map(|k| shade.x0 + f64::from(k) * size);
            let up = |x| (1..30).map(move |k| [x, shade.y1 - f64::from(k) * 0.6 * size]);
            if self.place(
                figure,
                text,
                across.flat_map(up).filter(|at| shade.holds(text.room(*at))),
            ) {
                return;
            }
        }
    }

    /// Names each method where it is on the front, on the side where no curve can be.
    fn name_front(&self, figure: &mut Figure, front: &[(usize, &Run)]) {
        let size = self.size;
        for part in front.chunk_by(|a, b| a.0 == b.0) {
            let curve = &self.panel.curves[part[0].0];
            let mut runs: Vec<_> = (0..part.len()).collect();
            runs.sort_by_key(|k| k.abs_diff(part.len() / 2));
            let text = Text::new(&curve.name, size)
                .colour(look::of(curve.letter).colour)
                .bold();
            let places = |text: Text| {
                let room = text.room([0.0, 0.0]);
                let offsets = [
                    [-1.0, 1.1],
                    [-0.5, 1.5],
                    [-1.2, 0.4],
                    [-0.2, 2.0],
                    [-1.6, 1.6],
                    [-1.0, 2.6],
                    [-2.4, 1.0],
                ];
                let mut found = vec![];
                for offset in offsets {
                    for k in &runs {
                        let [x, y] = self.at(part[*k].1);
                        found.push([x + offset[0] * size - room.width(), y + offset[1] * size]);
                        found.push([
                            x + (offset[0] + 0.6) * size - room.width() / 2.0,
                            y + (offset[1] + 0.3) * size,
                        ]);
                    }
                }
                found.into_iter()
            };
            self.place(figure, text, places(text));
        }
    }

    /// The steps of the runs on the front, small, where they cover nothing.
    fn name_steps(&self, figure: &mut Figure, front: &[(usize, &Run)]) {
        let size = (0.75 * self.size).max(6.5);
        for (_, run) in front {
            let [x, y] = self.at(run);
            let text = Text::new(run.label.as_deref().unwrap_or_default(), size).colour(GREY);
            let length = text.room([0.0, 0.0]).width();
            let places = [
                [-0.7 * size - length, 1.0 * size],
                [-length / 2.0, 1.5 * size],
                [0.8 * size, -0.4 * size],
            ];
            self.place(
                figure,
                text,
                places.into_iter().map(|[dx, dy]| [x + dx, y + dy]),
            );
        }
    }
}
