//! Line charts: curves or points between linear axes, in panels below one another.

use crate::axis::Axis;
use crate::error::Error;
use crate::figure::Figure;
use crate::geometry::{Point, Rect};
use crate::label::{Anchor, GREY, Label};
use crate::layout::{self, Level, Sign};
use crate::paint::Paint;
use crate::style::{CurveStyle, Filling};

/// A chart of lines.
///
/// ```
/// use a3_plot::{CurveStyle, Line, LineChart, LinePanel};
///
/// let wave = |k: u32| [0.1 * f64::from(k), (0.1 * f64::from(k)).sin()];
/// let chart = LineChart {
///     title: "A sine".into(),
///     panels: vec![LinePanel {
///         x_label: "time (s)".into(),
///         y_label: "x (m)".into(),
///         lines: vec![Line {
///             name: "x".into(),
///             style: CurveStyle::default(),
///             pieces: vec![(0..100).map(wave).collect()],
///             dots: false,
///         }],
///         ..LinePanel::default()
///     }],
///     ..LineChart::default()
/// };
/// assert!(chart.draw(600.0, 400.0)?.svg().contains("time (s)"));
/// // A sheet that is too small is an error that says how large it has to be.
/// assert!(chart.draw(60.0, 40.0).is_err());
/// # Ok::<(), a3_plot::Error>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct LineChart {
    /// The title.
    pub title: String,
    /// A line below the title; left out, like the foot, if there is no space for it.
    pub subtitle: String,
    /// The panels, from above. If all have the same horizontal label, it is written once.
    pub panels: Vec<LinePanel>,
    /// An explanation below the panels.
    pub foot: String,
}

/// A panel of a chart of lines.
#[derive(Clone, Debug, Default)]
pub struct LinePanel {
    /// What the horizontal axis shows, with its unit.
    pub x_label: String,
    /// What the vertical axis shows, with its unit.
    pub y_label: String,
    /// The ends of the horizontal axis; `None` if they are around all points.
    pub ends: Option<[f64; 2]>,
    /// The curves.
    pub lines: Vec<Line>,
}

/// A curve or a set of points.
#[derive(Clone, Debug, Default)]
pub struct Line {
    /// The name, for the legend.
    pub name: String,
    /// The style.
    pub style: CurveStyle,
    /// The pieces of the curve, between which there are gaps, each as points [x, y].
    pub pieces: Vec<Vec<Point>>,
    /// Whether the points are dots that no line joins.
    pub dots: bool,
}

impl Line {
    /// Returns all points.
    pub fn points(&self) -> impl Iterator<Item = &Point> {
        self.pieces.iter().flatten()
    }
}

impl LinePanel {
    /// Returns the axes: across and up. Long numbers on those for a narrow space are shortened.
    fn axes(&self, short: bool) -> [Axis; 2] {
        let all = |k: usize| self.lines.iter().flat_map(Line::points).map(move |p| p[k]);
        let x = self.ends.map_or_else(|| Axis::around(all(0)), Axis::linear);
        [x, Axis::around(all(1))].map(|mut axis| {
            axis.short = short;
            axis
        })
    }
}

impl LineChart {
    /// Draws the chart on a sheet of this width and height.
    ///
    /// # Errors
    /// [`Error::Empty`] if there is no point; [`Error::Sheet`] or [`Error::TooSmall`] if the chart
    /// does not fit on the sheet.
    pub fn draw(&self, width: f64, height: f64) -> Result<Figure, Error> {
        let lines = self.panels.iter().flat_map(|panel| &panel.lines);
        if lines.flat_map(Line::points).next().is_none() {
            return Err(Error::Empty("no value to draw"));
        }
        layout::fit([width, height], |figure, level| self.try_draw(figure, level))
    }

    /// Draws the panels, as many as fit from above, on a sheet of this width and height for a
    /// narrow space: with text of this size, and above each panel its vertical label and, if asked
    /// for, the names of its curves, instead of a title, a legend and a foot.
    #[must_use]
    pub fn draw_compact(&self, [width, height]: [f64; 2], size: f64, named: bool) -> Figure {
        let mut figure = Figure::new([width, height]);
        let count = ((height - 1.5 * size) / (5.0 * size)).max(0.0) as usize;
        let shown = &self.panels[..count.min(self.panels.len())];
        let high = (height - 1.5 * size) / shown.len() as f64;
        let inset = widest(shown, high - 2.0 * size, size, true).max(3.4 * size) + 0.4 * size;
        for (k, panel) in shown.iter().enumerate() {
            let top = k as f64 * high + 1.5 * size;
            let area = Rect::new(inset, top, width - 0.2 * size, top + high - 2.0 * size);
            let line = top - 0.4 * size;
            let mut right = area.x1;
            let is_named = |line: &&Line| named && !line.name.is_empty();
            for curve in panel.lines.iter().rev().filter(is_named) {
                let name = Label::new(&curve.name, size).colour(curve.style.colour);
                let name = figure.text([right, line], name.anchor(Anchor::End));
                let [from, to] = [1.5, 0.3].map(|gap| [name.x0 - gap * size, line - 0.3 * size]);
                figure.line(&[from, to], curve.style.pen(0.13 * size));
                right = from[0] - 0.4 * size;
            }
            let words = layout::elide(&panel.y_label, size, right);
            figure.text([0.0, line], Label::new(&words, size).colour(GREY));
            let is_last = k + 1 == shown.len();
            if is_last {
                let place = [area.x1, area.y1 + 1.15 * size];
                let label = Label::new(&panel.x_label, size).anchor(Anchor::End);
                figure.text(place, label.colour(GREY));
            }
            panel.draw(&mut figure, area, size, is_last, true);
        }
        figure
    }

    /// Draws the chart at this level; `None` if its panels would be too small.
    fn try_draw(&self, mut figure: Figure, level: Level) -> Option<Figure> {
        let size = level.size;
        let words = [&*self.title, &self.subtitle, &self.foot];
        let mut left = layout::headings(&mut figure, words, level);
        layout::legend(&mut figure, &mut left, &self.entries(size), size);
        let first = self.panels.first()?;
        let is_shared = self.panels.iter().all(|it| it.x_label == first.x_label);
        let below = |k: usize| !is_shared || k + 1 == self.panels.len();
        let count = self.panels.len() as f64;
        let labels = (0..self.panels.len()).filter(|k| below(*k)).count() as f64;
        // Below the last panel, or below each, are numbers and a label.
        let under = 3.0 * size;
        let height = (left.height() - labels * under) / count;
        let inset = 2.0 * size + widest(&self.panels, height - size, size, false);
        if height < 5.0 * size || left.width() - inset < 9.0 * size {
            return None;
        }
        let mut top = left.y0;
        for (k, panel) in self.panels.iter().enumerate() {
            let room = Rect::new(left.x0, top, left.x1 - size, top + height - size);
            let area = Rect { x0: room.x0 + inset, ..room };
            top += height;
            layout::label_left(&mut figure, room, &panel.y_label, "", size);
            panel.draw(&mut figure, area, size, below(k), false);
            if below(k) {
                top += under;
                let place = Rect { y1: top - 0.4 * size, ..area };
                layout::label_below(&mut figure, place, &panel.x_label, "", size);
            }
        }
        Some(figure)
    }

    /// Lists the entries of the legend: each curve once. A single one needs none.
    fn entries(&self, size: f64) -> Vec<(String, Sign<'_>)> {
        let mut seen: Vec<&Line> = vec![];
        for line in self.panels.iter().flat_map(|panel| &panel.lines) {
            let is_new = |other: &&Line| other.name != line.name || other.style != line.style;
            if seen.iter().all(is_new) {
                seen.push(line);
            }
        }
        let entry = |line: &'_ Line| -> (String, Sign<'static>) {
            let (style, dots) = (line.style, line.dots);
            let sign: Sign = Box::new(move |figure, [x, y]| {
                if dots {
                    style.draw_marker(figure, [x, y], 0.4 * size, Filling::Full);
                } else {
                    let ends = [[x - 1.7 * size, y], [x + 1.7 * size, y]];
                    figure.line(&ends, style.pen(0.13 * size));
                }
            });
            (line.name.clone(), sign)
        };
        seen.into_iter().map(entry).collect()
    }
}

/// Returns the width of the widest number on the left of panels of this height.
fn widest(panels: &[LinePanel], height: f64, size: f64, short: bool) -> f64 {
    let numbers = panels.iter().map(|panel| {
        let [_, y] = panel.axes(short);
        layout::widest(&y.between(0.0, height), size)
    });
    numbers.fold(0.0, f64::max)
}

impl LinePanel {
    /// Draws the panel; `below` tells whether there are numbers below it, and `short` whether long
    /// ones are shortened and dots are larger.
    fn draw(&self, figure: &mut Figure, area: Rect, size: f64, below: bool, short: bool) {
        let [x, y] = self.axes(short);
        let [x, y] = [x.between(area.x0, area.x1), y.between(area.y1, area.y0)];
        layout::axes(figure, area, [&x, &y], size, [below, true]);
        let at = |[a, b]: &Point| [x.at(*a), y.at(*b)];
        figure.clipped(area, |figure| {
            for line in &self.lines {
                for piece in &line.pieces {
                    let points: Vec<_> = piece.iter().map(at).collect();
                    if !line.dots {
                        figure.line(&points, line.style.pen(0.13 * size).round());
                        continue;
                    }
                    let side = if short { 0.32 } else { 0.2 } * size;
                    for point in points {
                        let paint = Paint::fill(line.style.colour);
                        let outline = CurveStyle::default().outline(point, 0.7 * side);
                        figure.area(vec![outline], paint);
                    }
                }
            }
        });
    }
}
