//! Work-precision diagrams (Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I,
//! section II.10), with a panel for each problem, a curve for each method, and a point for each
//! run.

mod panel;
mod problem;

pub use problem::{Curve, Guide, Mark, Measurement, Problem};

use crate::axis::Axis;
use crate::error::Error;
use crate::figure::Figure;
use crate::geometry::Rect;
use crate::label::Label;
use crate::layout::{self, Level, Sign};
use crate::style::{CurveStyle, Filling};
use panel::{Drawing, front_pen, guide_pen, shade_paint};

/// A work-precision diagram. Accurate runs are on the left of it, and fast ones below.
#[derive(Clone, Debug, Default)]
pub struct WorkPrecision {
    /// The title.
    pub title: String,
    /// A line below the title; left out, like the foot, if there is no space for it.
    pub subtitle: String,
    /// The error that the horizontal axis shows, with its unit.
    pub x_label: String,
    /// The work that the vertical axis shows, with its unit.
    pub y_label: String,
    /// The problems, with a panel for each.
    pub problems: Vec<Problem>,
    /// An explanation below the panels.
    pub foot: String,
    /// What intervened in the runs with half-filled markers, for the legend.
    pub held: String,
}

impl WorkPrecision {
    /// Draws the diagram on a sheet of this width and height.
    ///
    /// # Errors
    /// [`Error::Empty`] if no run has a place on the axes; [`Error::Sheet`] or [`Error::TooSmall`]
    /// if the diagram does not fit on the sheet.
    pub fn draw(&self, width: f64, height: f64) -> Result<Figure, Error> {
        let Some(axes) = self.axes() else {
            let why = "no run to draw: each blew up or has no work";
            return Err(Error::Empty(why));
        };
        let words = [&*self.title, &self.subtitle, &self.foot];
        layout::fit([width, height], |figure, level| self.try_draw(figure, level, words, axes))
    }

    /// Draws the diagram without its title, subtitle and foot on a sheet of this width and height,
    /// with text of this size, or smaller if there is no room for it. Returns `None` if no run has
    /// a place on the axes, or if the diagram does not fit.
    #[must_use]
    pub fn draw_bare(&self, sheet: [f64; 2], text: f64) -> Option<Figure> {
        let axes = self.axes()?;
        layout::largest(sheet, text, |figure, level| self.try_draw(figure, level, [""; 3], axes))
    }

    /// Lists all runs that can be drawn.
    fn runs(&self) -> impl Iterator<Item = &Measurement> {
        let curves = self.problems.iter().flat_map(|problem| &problem.curves);
        curves.flat_map(|curve| &curve.runs).filter(|run| run.is_drawn())
    }

    /// Lists all runs of other programs that can be drawn.
    fn marks(&self) -> impl Iterator<Item = &Mark> {
        let marks = self.problems.iter().flat_map(|problem| &problem.marks);
        marks.filter(|mark| mark.is_drawn())
    }

    /// Returns the axes of error and of work, around all runs on all problems; `None` if no run has
    /// a place on them.
    fn axes(&self) -> Option<[Axis; 2]> {
        let range = |values: &mut dyn Iterator<Item = f64>| {
            let first = values.next()?;
            let join = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
            Some(values.fold((first, first), join))
        };
        let errors = &mut self
            .runs()
            .filter(|run| !run.is_lost() && run.error > 0.0)
            .map(|run| run.error)
            .chain(self.marks().map(|mark| mark.error));
        let (least, most) = range(errors)?;
        // Runs far below the resolution of the reference need no space, whereas a limit just left
        // of all runs is worth showing.
        let limits = self.problems.iter().map(Problem::trusted);
        let limits = &mut limits.filter(|limit| *limit > 0.0);
        let (lowest, _) = range(limits).unwrap_or((least, most));
        let least =
            if lowest > least / 30.0 { least.clamp(lowest / 30.0, lowest / 2.0) } else { least };
        let known = self.marks().filter_map(|mark| mark.work);
        let (low, high) = range(&mut self.runs().map(|run| run.work).chain(known))?;
        Some([Axis::log(least, most.max(least)), Axis::log(low, high)])
    }

    /// Draws the diagram at this level; `None` if its panels would be too small.
    fn try_draw(
        &self,
        mut figure: Figure,
        level: Level,
        words: [&str; 3],
        [x, y]: [Axis; 2],
    ) -> Option<Figure> {
        let size = level.size;
        let mut left = layout::headings(&mut figure, words, level);
        layout::legend(&mut figure, &mut left, &self.entries(size, &x), size);
        let numbers = layout::widest(&y.between(0.0, left.height()), size) + 0.6 * size;
        let x0 = left.x0 + 1.4 * size + numbers;
        let inner = Rect::new(x0, left.y0, left.x1 - size, left.y1 - 3.0 * size);
        let (below, beside) = (left.across(x0, left.x1), left.down_to(inner.y1));
        layout::label_below(&mut figure, below, &self.x_label, "more accurate", size);
        layout::label_left(&mut figure, beside, &self.y_label, "faster", size);
        let strip = if self.runs().any(Measurement::is_lost) { 3.4 * size } else { 0.0 };
        let merit = |[w, h]: [f64; 2]| ((w - strip) / 1.3).min(h - 1.5 * size);
        let (rooms, columns) = layout::grid(self.problems.len(), inner, 1.6 * size, merit);
        for (k, (problem, mut area)) in self.problems.iter().zip(rooms).enumerate() {
            // There are numbers below the last panel of each column, also where the last row has no
            // panel in that column.
            let is_last = k + columns >= self.problems.len();
            if is_last && k / columns != (self.problems.len() - 1) / columns {
                area.y1 -= 1.2 * size;
            }
            if !problem.title.is_empty() {
                let title = layout::elide(&problem.title, 1.1 * size, area.width());
                let label = Label::new(&title, 1.1 * size).bold();
                figure.text([area.x0, area.y0 + 0.85 * size], label);
                area.y0 += 1.5 * size;
            }
            let main = area.across(area.x0, area.x1 - strip);
            if main.width() < 9.0 * size || main.height() < 7.0 * size {
                return None;
            }
            let axes = [x.between(main.x0, main.x1), y.between(main.y1, main.y0)];
            // Lines and markers are finer in small panels.
            let fine = (main.width() / (22.0 * size)).clamp(0.6, 1.0) * size;
            let numbers = [is_last, k % columns == 0];
            Drawing::new(problem, axes, main, size, fine).draw(&mut figure, strip, numbers);
        }
        Some(figure)
    }

    /// Lists the entries of the legend: each method once, the front, and the shade if there is one.
    fn entries(&self, size: f64, x: &Axis) -> Vec<(String, Sign<'_>)> {
        let mut seen = vec![];
        let mut entries: Vec<(String, Sign)> = vec![];
        let curves = self.problems.iter().map(|it| it.curves.iter().enumerate());
        for (k, curve) in curves.flatten() {
            let is_drawn = curve.runs.iter().any(Measurement::is_drawn);
            if !is_drawn || seen.contains(&(curve.style, &curve.name)) {
                continue;
            }
            seen.push((curve.style, &curve.name));
            let style = curve.style;
            let sign: Sign = Box::new(move |figure, [x, y]| {
                let line = [[x - 1.7 * size, y], [x + 1.7 * size, y]];
                figure.line(&line, style.pen(0.13 * size));
                style.draw_marker(figure, [x, y], 0.4 * size, Filling::Full);
                // The line, the marker, and the name, which follows.
                let next = figure.shapes.len();
                figure.parts.push((next - 2..next + 1, k));
            });
            entries.push((curve.name.clone(), sign));
        }
        if self.runs().any(|run| run.held && !run.is_lost()) {
            let style = CurveStyle::default();
            let half: Sign = Box::new(move |figure, at| {
                style.draw_marker(figure, at, 0.4 * size, Filling::Half);
            });
            entries.push((self.held.clone(), half));
        }
        for guide in self.problems.iter().filter_map(|it| it.guide.as_ref()) {
            if entries.iter().all(|(name, _)| *name != guide.name) {
                let sign: Sign = Box::new(move |figure, [x, y]| {
                    let line = [[x - 1.7 * size, y], [x + 1.7 * size, y]];
                    figure.line(&line, guide_pen(0.13 * size));
                });
                entries.push((guide.name.clone(), sign));
            }
        }
        let front: Sign = Box::new(move |figure, [x, y]| {
            let line = [[x - 1.3 * size, y], [x + 1.3 * size, y]];
            figure.line(&line, front_pen(0.7 * size));
        });
        entries.push(("fastest for its error".to_owned(), front));
        if self.problems.iter().any(|it| x.is_inside(it.trusted())) {
            let shade: Sign = Box::new(move |figure, at| {
                let sample = Rect::spread(at, 1.6 * size, 0.5 * size);
                figure.rect(sample, shade_paint());
            });
            entries.push(("finer than reference".to_owned(), shade));
        }
        entries
    }
}
