//! Panels: the shade, the curves and the front of a problem, with names where there is space.

use std::cmp::Reverse;

use super::problem::{Curve, Mark, Measurement, Problem};
use crate::axis::Axis;
use crate::figure::Figure;
use crate::geometry::{Point, Rect};
use crate::label::{Anchor, GREY, Label};
use crate::layout;
use crate::paint::{Paint, Pen};
use crate::style::{CurveStyle, Filling, Marker};

/// Opacity of a band of errors.
const BAND_OPACITY: f64 = 0.25;

/// Returns the paint of errors below the resolution of the reference.
pub fn shade_paint() -> Paint {
    Paint::fill("#e6eaf0")
}

/// Returns the pen of the front.
pub fn front_pen(width: f64) -> Pen {
    Pen::new("#f8dd86", width).round()
}

/// Returns the pen of a guide.
pub fn guide_pen(width: f64) -> Pen {
    Pen::new("#222222", width).dashed(vec![5.0, 3.0])
}

/// A panel in progress.
pub struct Drawing<'a> {
    problem: &'a Problem,
    axes: [Axis; 2],
    /// The area between the axes.
    main: Rect,
    /// The size of text.
    size: f64,
    /// The size of lines and markers, given as the size of matching text.
    fine: f64,
    /// The rectangles that markers occupy.
    taken: Vec<Rect>,
    /// The line segments drawn so far.
    lines: Vec<[Point; 2]>,
}

impl<'a> Drawing<'a> {
    pub fn new(problem: &'a Problem, axes: [Axis; 2], main: Rect, size: f64, fine: f64) -> Self {
        Self { problem, axes, main, size, fine, taken: vec![], lines: vec![] }
    }

    /// Returns the point of a run.
    fn at(&self, run: &Measurement) -> Point {
        [self.axes[0].at(run.error.max(f64::MIN_POSITIVE)), self.axes[1].at(run.work)]
    }

    /// Draws the panel, with a strip of this width for runs that blew up; `numbers` tells whether
    /// the x and y axes are labelled.
    pub fn draw(&mut self, figure: &mut Figure, strip: f64, numbers: [bool; 2]) {
        let (main, size) = (self.main, self.size);
        let limit = self.problem.trusted();
        let known = (limit > 0.0).then(|| self.axes[0].at(limit));
        let shade = main.across(main.x0, known.unwrap_or(main.x0));
        figure.rect(shade, shade_paint());
        let strip = main.across(main.x1, main.x1 + strip);
        if strip.width() > 0.0 {
            figure.rect(strip, Paint::fill("#fbefec"));
            if numbers[0] {
                let label = Label::new("blew up", size).colour("#8c2d19").anchor(Anchor::Middle);
                figure.text([strip.centre()[0], main.y1 + 1.15 * size], label);
            }
        }
        layout::axes(figure, main, [&self.axes[0], &self.axes[1]], size, numbers);
        let front: Vec<_> = (self.problem.front().into_iter())
            .map(|[c, r]| (c, &self.problem.curves[c].runs[r]))
            .collect();
        let line: Vec<_> = front.iter().map(|(_, run)| self.at(run)).collect();
        figure.line(&line, front_pen(0.9 * self.fine));
        self.keep_clear(&line);
        self.curves(figure);
        self.marks(figure);
        self.guide(figure);
        self.blown_up(figure, strip);
        if limit > 0.0 {
            self.explain_shade(figure, shade);
        }
        self.still(figure);
        self.name_front(figure, &front);
        self.name_steps(figure, &front);
    }

    /// Keeps names away from a line.
    fn keep_clear(&mut self, line: &[Point]) {
        let pieces = line.windows(2).map(|pair| [pair[0], pair[1]]);
        self.lines.extend(pieces);
    }

    /// Draws the spread of errors along a curve as a band: along the least errors, and back along
    /// the largest.
    fn band(&self, figure: &mut Figure, curve: &Curve) {
        let mut outline = vec![];
        let mut back = vec![];
        for run in curve.joined() {
            let Some([least, most]) = run.spread.filter(|ends| ends[1].is_finite()) else {
                continue;
            };
            let at = |error: f64| {
                let across = self.axes[0].at(error.max(f64::MIN_POSITIVE));
                [across, self.axes[1].at(run.work)]
            };
            outline.push(at(least));
            back.push(at(most));
        }
        outline.extend(back.into_iter().rev());
        if outline.len() > 2 {
            let paint = Paint::fill(curve.style.colour).opacity(BAND_OPACITY);
            figure.area(vec![outline], paint);
        }
    }

    /// Draws the curves and their markers.
    fn curves(&mut self, figure: &mut Figure) {
        let radius = 0.38 * self.fine;
        for (k, curve) in self.problem.curves.iter().enumerate() {
            let first = figure.shapes.len();
            self.band(figure, curve);
            let style = curve.style;
            let line: Vec<_> = curve.joined().iter().map(|run| self.at(run)).collect();
            figure.line(&line, style.pen(0.14 * self.fine));
            self.keep_clear(&line);
            let runs = curve.runs.iter().enumerate();
            for (r, run) in runs.filter(|(_, run)| run.is_drawn() && !run.is_lost()) {
                let point = self.at(run);
                figure.runs.push(([k, r], point));
                let filling = if run.held { Filling::Half } else { Filling::Full };
                style.draw_marker(figure, point, radius, filling);
                self.taken.push(Rect::around(point, 1.2 * radius));
            }
            figure.parts.push((first..figure.shapes.len(), k));
        }
    }

    /// Draws the guide, if there is one.
    fn guide(&mut self, figure: &mut Figure) {
        let points = self.problem.guide.iter().flat_map(|it| &it.points);
        let line: Vec<_> =
            points.map(|[error, work]| [self.axes[0].at(*error), self.axes[1].at(*work)]).collect();
        figure.line(&line, guide_pen(0.14 * self.fine));
        self.keep_clear(&line);
    }

    /// Draws runs that blew up as open markers beside the chart, next to each other if one would
    /// hide another.
    fn blown_up(&mut self, figure: &mut Figure, strip: Rect) {
        let radius = 0.36 * self.fine.min(0.9 * self.size);
        let mut taken: Vec<Rect> = vec![];
        for (k, curve) in self.problem.curves.iter().enumerate() {
            let (style, first) = (curve.style, figure.shapes.len());
            let runs = curve.runs.iter().enumerate();
            for (r, run) in runs.filter(|(_, run)| run.is_drawn() && run.is_lost()) {
                let [middle, y] = [strip.centre()[0], self.axes[1].at(run.work)];
                let aside = [0.0, -1.0, 1.0].map(|k| [middle + 2.6 * k * radius, y]);
                let room = |point: &Point| Rect::around(*point, radius);
                let free = |point: &&Point| !taken.iter().any(|other| other.overlaps(room(point)));
                let point = *aside.iter().find(free).unwrap_or(&aside[0]);
                taken.push(room(&point));
                figure.runs.push(([k, r], point));
                style.draw_marker(figure, point, radius, Filling::None);
            }
            figure.parts.push((first..figure.shapes.len(), k));
        }
    }

    /// Draws the runs of other programs: as stars or, without their work, as lines, with their
    /// names.
    fn marks(&mut self, figure: &mut Figure) {
        let (size, radius) = (self.size, 0.55 * self.fine);
        let style = CurveStyle::new("#000000", &[], Marker::Star(5, 0.45));
        let drawn = || self.problem.marks.iter().filter(|mark| mark.is_drawn());
        let places: Vec<_> = drawn().map(|mark| self.place_of(mark)).collect();
        for (x, y) in &places {
            if let Some(y) = y {
                style.draw_marker(figure, [*x, *y], radius, Filling::Full);
                self.taken.push(Rect::around([*x, *y], radius));
            } else {
                let ends = [[*x, self.main.y0], [*x, self.main.y1]];
                figure.line(&ends, Pen::new("#000000", 0.1 * self.fine));
                self.lines.push(ends);
            }
        }
        for (mark, (x, y)) in drawn().zip(places) {
            let label = Label::new(&mark.name, size).bold();
            let width = label.room([0.0, 0.0]).width();
            if let Some(y) = y {
                let sides = [0.8 * size, -0.8 * size - width, -width / 2.0];
                let offsets = [0.35, -0.9, 1.6, -2.1, 2.8].into_iter();
                let places = offsets.flat_map(|dy| sides.map(|dx| [x + dx, y + dy * size]));
                self.place(figure, label, places);
            } else {
                let places = (0..120).map(|k| {
                    let side = if k % 2 == 0 { -0.4 } else { 1.1 };
                    let down = (0.6 + 0.3 * f64::from(k)) * size;
                    [x + side * size, self.main.y0 + width + down]
                });
                self.place(figure, label.turned(), places);
            }
        }
    }

    /// Returns the place of a run of another program across, and up if its work is known.
    fn place_of(&self, mark: &Mark) -> (f64, Option<f64>) {
        let up = mark.work.map(|work| self.axes[1].at(work));
        (self.axes[0].at(mark.error), up)
    }

    /// Draws the error of a run in which nothing moves, as a line with a label.
    fn still(&self, figure: &mut Figure) {
        let is_seen = |still: &f64| self.axes[0].is_inside(*still);
        let Some(still) = self.problem.still.filter(is_seen) else {
            return;
        };
        let x = self.axes[0].at(still);
        let ends = [[x, self.main.y0], [x, self.main.y1]];
        let pen = Pen::new(GREY, 0.08 * self.fine).dashed(vec![4.0, 3.0]);
        figure.line(&ends, pen);
        let size = 0.85 * self.size;
        let label = Label::new("nothing moves", size).colour(GREY).turned();
        let places = (0..120).map(|k| {
            let side = if k % 2 == 0 { 1.1 } else { -0.4 };
            let up = (0.6 + 0.3 * f64::from(k)) * size;
            [x + side * size, self.main.y1 - up]
        });
        self.place(figure, label, places);
    }

    /// Returns whether a label at this place would cover nothing.
    fn is_clear(&self, figure: &Figure, room: Rect) -> bool {
        self.main.holds(room)
            && figure.is_free(room)
            && !self.taken.iter().any(|other| other.overlaps(room))
            && !self.lines.iter().any(|[a, b]| room.meets(*a, *b))
    }

    /// Writes the label at the first of the points where it covers nothing. Returns whether there
    /// is one.
    fn place(
        &self,
        figure: &mut Figure,
        label: Label,
        mut points: impl Iterator<Item = Point>,
    ) -> bool {
        let found = points.find(|at| self.is_clear(figure, label.room(*at)));
        if let Some(at) = found {
            figure.text(at, label);
        }
        found.is_some()
    }

    /// Explains the shade, in text read from below, if it is wide enough. The legend explains it
    /// too.
    fn explain_shade(&self, figure: &mut Figure, shade: Rect) {
        let size = 0.85 * self.size;
        for text in ["finer than the reference can tell", "reference unsure"] {
            let label = Label::new(text, size).colour(GREY).turned();
            let places = (0..240).map(|k| {
                let (column, row) = (f64::from(k / 30), f64::from(k % 30));
                let (right, up) = ((1.1 + column) * size, (0.6 + 0.6 * row) * size);
                [shade.x0 + right, shade.y1 - up]
            });
            let fitting = places.filter(|at| shade.holds(label.room(*at)));
            if self.place(figure, label, fitting) {
                return;
            }
        }
    }

    /// Names each method once, at its longest run on the front, on the side of the front that is
    /// free of curves.
    fn name_front(&self, figure: &mut Figure, front: &[(usize, &Measurement)]) {
        let size = self.size;
        let mut parts: Vec<_> = front.chunk_by(|a, b| a.0 == b.0).collect();
        parts.sort_by_key(|part| Reverse(part.len()));
        let mut named = vec![];
        for part in parts {
            if named.contains(&part[0].0) {
                continue;
            }
            named.push(part[0].0);
            let curve = &self.problem.curves[part[0].0];
            let mut runs: Vec<_> = (0..part.len()).collect();
            runs.sort_by_key(|k| k.abs_diff(part.len() / 2));
            let label = Label::new(&curve.name, size).colour(curve.style.colour).bold();
            let places = |label: Label| {
                let room = label.room([0.0, 0.0]);
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
                        let middle = x + (offset[0] + 0.6) * size - room.width() / 2.0;
                        found.push([middle, y + (offset[1] + 0.3) * size]);
                    }
                }
                found.into_iter()
            };
            self.place(figure, label, places(label));
        }
    }

    /// Writes the labels of the runs on the front where they cover nothing.
    fn name_steps(&self, figure: &mut Figure, front: &[(usize, &Measurement)]) {
        let size = 0.8 * self.size;
        for (_, run) in front {
            let [x, y] = self.at(run);
            let label = Label::new(run.label.as_deref().unwrap_or_default(), size).colour(GREY);
            let length = label.room([0.0, 0.0]).width();
            let places = [
                [-0.7 * size - length, 1.0 * size],
                [-length / 2.0, 1.5 * size],
                [0.8 * size, -0.4 * size],
            ];
            let places = places.into_iter().map(|[dx, dy]| [x + dx, y + dy]);
            self.place(figure, label, places);
        }
    }
}
