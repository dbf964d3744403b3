//! A work-precision diagram on the screen: the places of the runs, and the values of the run under
//! the pointer.

use a3_plot::{Axis, Curve, CurveStyle, Measurement, Problem, WorkPrecision};
use egui::epaint::{Mesh, PathStroke, Vertex, WHITE_UV};
use egui::{
    Align2, Color32, CursorIcon, FontId, Id, Painter, Pos2, Rect, Sense, Shape, Stroke, StrokeKind,
    Ui, pos2, vec2,
};

use super::super::charts::{GRID, GROUND, colour, dashes};
use super::super::style::{FAINT, TEXT};
use super::super::words::digits;
use super::super::{axes, charts};
use crate::session::{Diagram, MeasureRequest, MethodSetting};

/// Colours of errors that the reference cannot tell from 0, and of the front.
const SHADE: Color32 = Color32::from_rgb(226, 231, 239);
const FRONT: Color32 = Color32::from_rgb(248, 221, 134);
/// Radius of a marker (points).
const MARKER: f32 = 4.2;
/// Height of a line of the legend (points).
const LEGEND_LINE: f32 = 18.0;
/// Share of its opacity that a curve keeps while another one is under the pointer.
const FADED: f32 = 0.22;

/// Draws a diagram with its legend in a room. Runs of the panes have rings. Returns the request of
/// the mouse.
pub fn show(
    ui: &Ui,
    room: Rect,
    diagram: &Diagram,
    shown: &[MethodSetting],
) -> Option<MeasureRequest> {
    let response = ui.interact(room, Id::unique("diagram"), Sense::click());
    let painter = ui.painter();
    let entries = entries(painter, &diagram.chart, room.width());
    let lines = entries
        .last()
        .map_or(0.0, |(at, ..)| at.y + 2.0 * LEGEND_LINE);
    let legend = Rect::from_min_max(pos2(room.left(), room.bottom() - lines), room.max);
    let plot = Plot::new(&diagram.chart, room.with_max_y(legend.top() - 6.0))?;
    let pointer = response.hover_pos();
    let named = |at: Pos2| {
        let under = |(place, size, _): &&(Pos2, egui::Vec2, usize)| {
            Rect::from_min_size(legend.min + place.to_vec2(), *size).contains(at)
        };
        entries.iter().find(under).map(|(.., curve)| *curve)
    };
    let point = pointer.and_then(|at| plot.point_under(at)).copied();
    let curve = pointer.and_then(|at| plot.curve_under(at).or_else(|| named(at)));
    ground(painter, &plot, &diagram.chart);
    let order = (0..plot.problem.curves.len()).filter(|k| Some(*k) != curve);
    for k in order.chain(curve) {
        let faded = curve.is_some_and(|curve| curve != k);
        draw_curve(painter, &plot, k, if faded { FADED } else { 1.0 });
    }
    for (place, _, k) in &entries {
        let faded = curve.is_some_and(|curve| curve != *k);
        let of = &plot.problem.curves[*k];
        entry(
            painter,
            legend.min + place.to_vec2(),
            of,
            if faded { FADED } else { 1.0 },
        );
    }
    signs(painter, &plot, legend);
    for place in &plot.points {
        let (method, control) = diagram.runs[place.curve][place.run];
        let is_shown = |(m, c): &MethodSetting| {
            m.name == method.name && (c.value() / control.value() - 1.0).abs() < 0.02
        };
        if shown.iter().any(is_shown) {
            painter.circle_stroke(place.at, 8.5, Stroke::new(1.8, TEXT));
        }
    }
    let pointed = point?;
    ui.set_cursor_icon(CursorIcon::PointingHand);
    painter.circle_stroke(
        pointed.at,
        8.0,
        Stroke::new(1.5, colour(plot.problem.curves[pointed.curve].style)),
    );
    note_run(painter, room, &plot, &pointed, &diagram.chart);
    let Point { curve, run, .. } = pointed;
    response
        .clicked()
        .then_some(MeasureRequest::RunBeside { curve, run })
}

/// Draws the axes, the shade and the front.
fn ground(painter: &Painter, plot: &Plot, chart: &WorkPrecision) {
    let (area, [x, y]) = (plot.area, plot.axes);
    painter.rect_filled(area, 0.0, GROUND);
    let trusted = plot.problem.trusted();
    if x.is_inside(trusted) {
        painter.rect_filled(area.with_max_x(x.at(trusted) as f32), 0.0, SHADE);
    }
    GRID.draw(painter, area, [x, y], Some(""));
    let frame = Stroke::new(1.0, FAINT.gamma_multiply(0.6));
    painter.rect_stroke(area, 0.0, frame, StrokeKind::Middle);
    let say = |at, align, words: &str| {
        painter.text(at, align, words, FontId::proportional(11.5), FAINT);
    };
    let above = pos2(area.left() - 34.0, area.top() - 4.0);
    say(above, Align2::LEFT_BOTTOM, &chart.y_label);
    let below = pos2(area.right(), area.bottom() + 18.0);
    say(below, Align2::RIGHT_TOP, &chart.x_label);
    let left = pos2(area.left() - 20.0, area.bottom() + 18.0);
    say(left, Align2::LEFT_TOP, "more accurate");
    let tip = left + vec2(-3.0, 7.5);
    painter.arrow(tip, vec2(-13.0, 0.0), Stroke::new(1.0, FAINT));
    if let Some(lost) = plot.points.iter().find(|point| point.lost) {
        let top = pos2(lost.at.x, area.top() - 4.0);
        say(top, Align2::CENTER_BOTTOM, "blew up");
        let stroke = Stroke::new(0.5, GRID.colour);
        painter.vline(area.right() + 5.0, area.y_range(), stroke);
    }
    let front: Vec<_> = plot.problem.front().into_iter().collect();
    let places = front.iter().map(|[curve, run]| {
        let run = &plot.problem.curves[*curve].runs[*run];
        plot.at(run)
    });
    painter.add(Shape::line(places.collect(), Stroke::new(9.0, FRONT)));
}

/// Draws the line and the markers of a curve.
fn draw_curve(painter: &Painter, plot: &Plot, k: usize, opacity: f32) {
    let style = plot.problem.curves[k].style;
    line(painter, plot.line(k), style, opacity);
    for point in plot.points.iter().filter(|point| point.curve == k) {
        let held = plot.problem.curves[k].runs[point.run].held;
        marker(painter, point.at, style, opacity, !point.lost && !held);
    }
}

/// Draws a line in a style.
fn line(painter: &Painter, places: Vec<Pos2>, style: CurveStyle, opacity: f32) {
    let stroke = Stroke::new(1.6, colour(style).gamma_multiply(opacity));
    axes::line(painter, places, stroke, &dashes(style, 1.6));
}

/// Draws a marker, filled or open.
fn marker(painter: &Painter, at: Pos2, style: CurveStyle, opacity: f32, filled: bool) {
    let colour = colour(style).gamma_multiply(opacity);
    let outline = style.outline([at.x.into(), at.y.into()], MARKER.into());
    let corners: Vec<_> = outline
        .iter()
        .map(|[x, y]| pos2(*x as f32, *y as f32))
        .collect();
    // All of a marker is seen from its centre, so triangles from there fill it.
    let fill = if filled { colour } else { GROUND };
    let vertex = |pos| Vertex {
        pos,
        uv: WHITE_UV,
        color: fill,
    };
    let mut mesh = Mesh::default();
    mesh.vertices.push(vertex(at));
    mesh.vertices.extend(corners.iter().copied().map(vertex));
    let count = corners.len() as u32;
    for k in 0..count {
        mesh.add_triangle(0, 1 + k, 1 + (k + 1) % count);
    }
    painter.add(Shape::mesh(mesh));
    let edge = PathStroke::new(1.0, colour);
    painter.add(Shape::closed_line(corners, edge));
}

/// Returns the places of the entries of the legend below one another in a width, their sizes, and
/// the indices of their curves.
fn entries(painter: &Painter, chart: &WorkPrecision, width: f32) -> Vec<(Pos2, egui::Vec2, usize)> {
    let mut at = Pos2::ZERO;
    let curves = chart.problems.iter().take(1).flat_map(|it| &it.curves);
    let drawn = curves
        .enumerate()
        .filter(|(_, curve)| curve.runs.iter().any(a3_plot::Measurement::is_drawn));
    let mut all = vec![];
    for (k, curve) in drawn {
        let font = FontId::proportional(12.0);
        let words = painter.layout_no_wrap(curve.name.clone(), font, TEXT);
        let size = vec2(words.size().x + 34.0, LEGEND_LINE);
        if at.x > 0.0 && at.x + size.x > width {
            at = pos2(0.0, at.y + LEGEND_LINE);
        }
        all.push((at, size, k));
        at.x += size.x + 14.0;
    }
    all
}

/// Draws the meaning of the front and of the shade on the last line of the legend.
fn signs(painter: &Painter, plot: &Plot, legend: Rect) {
    let y = legend.bottom() - 0.5 * LEGEND_LINE;
    let is_shaded = plot.axes[0].is_inside(plot.problem.trusted());
    let mut left = legend.left() + 2.0;
    for (words, colour, high, there) in [
        ("fastest for its error", FRONT, 8.0, true),
        ("finer than the reference", SHADE, 12.0, is_shaded),
    ] {
        if there {
            let sample = Rect::from_center_size(pos2(left + 12.0, y), vec2(24.0, high));
            painter.rect_filled(sample, 0.0, colour);
            let at = pos2(left + 30.0, y);
            let font = FontId::proportional(12.0);
            let said = painter.text(at, Align2::LEFT_CENTER, words, font, TEXT);
            left = said.right() + 16.0;
        }
    }
}

/// Draws an entry of the legend.
fn entry(painter: &Painter, at: Pos2, curve: &Curve, opacity: f32) {
    let y = at.y + 0.5 * LEGEND_LINE;
    let ends = [pos2(at.x + 2.0, y), pos2(at.x + 26.0, y)];
    line(painter, ends.into(), curve.style, opacity);
    marker(painter, pos2(at.x + 14.0, y), curve.style, opacity, true);
    let place = pos2(at.x + 32.0, y);
    let font = FontId::proportional(12.0);
    let colour = TEXT.gamma_multiply(opacity.max(0.5));
    painter.text(place, Align2::LEFT_CENTER, &curve.name, font, colour);
}

/// Writes the method, the step, the error and the cost of a run beside its point, within a room.
fn note_run(painter: &Painter, room: Rect, plot: &Plot, point: &Point, chart: &WorkPrecision) {
    let curve = &plot.problem.curves[point.curve];
    let run = &curve.runs[point.run];
    let error = if point.lost {
        "it blew up".into()
    } else {
        // The unit is between the last brackets of the label.
        let unit = chart.x_label.rsplit_once('(').map_or("", |(_, unit)| unit);
        format!("error {} {}", digits(run.error), unit.trim_end_matches(')'))
    };
    let is_timed = chart.y_label.starts_with("computing");
    let cost = if is_timed {
        format!("{} ms per simulated second", digits(1e3 * run.work))
    } else {
        format!("{} evaluations per simulated second", digits(run.work))
    };
    let setting = run.label.clone().unwrap_or_default();
    let lines = [
        (curve.name.clone(), 13.0, TEXT),
        (setting, 12.5, TEXT),
        (error, 12.5, TEXT),
        (cost, 12.5, TEXT),
        ("click: run it beside".into(), 11.5, FAINT),
    ];
    charts::note(painter, room, point.at, colour(curve.style), lines.into());
}

/// Largest distance of the pointer from the point that it shows (points).
const POINT_REACH: f32 = 12.0;
/// Largest distance of the pointer from the curve that it shows (points).
const CURVE_REACH: f32 = 7.0;
/// Room for the numbers on the left of the axes and below them, for their labels, and for runs that
/// blew up on the right (points).
const ROOM: [f32; 4] = [42.0, 34.0, 18.0, 40.0];

/// Place of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Index of its curve.
    pub curve: usize,
    /// Index among the runs of the curve.
    pub run: usize,
    pub at: Pos2,
    /// Whether the run blew up: it is beside the chart, at the work until its end.
    pub lost: bool,
}

/// A diagram in its room on the screen.
pub struct Plot<'a> {
    pub problem: &'a Problem,
    /// The area between the axes.
    pub area: Rect,
    /// The axes of error and work.
    pub axes: [Axis; 2],
    pub points: Vec<Point>,
}

impl<'a> Plot<'a> {
    /// Lays out the first panel of a diagram in a room; `None` if there is nothing to draw, or not
    /// enough room.
    pub fn new(chart: &'a WorkPrecision, room: Rect) -> Option<Self> {
        let problem = chart.problems.first()?;
        let [x, y] = chart.axes()?;
        let runs = problem.curves.iter().flat_map(|curve| &curve.runs);
        let any_lost = runs.clone().any(|run| run.is_drawn() && run.is_lost());
        let [left, below, above, beside] = ROOM;
        let area = Rect::from_min_max(
            room.min + vec2(left, above),
            room.max - vec2(if any_lost { beside } else { 8.0 }, below),
        );
        if area.width() < 60.0 || area.height() < 60.0 {
            return None;
        }
        let axes = [
            x.between(area.left().into(), area.right().into()),
            y.between(area.bottom().into(), area.top().into()),
        ];
        let mut plot = Self {
            problem,
            area,
            axes,
            points: vec![],
        };
        for (curve, of) in problem.curves.iter().enumerate() {
            for (run, measured) in of.runs.iter().enumerate() {
                if measured.is_drawn() {
                    plot.points.push(Point {
                        curve,
                        run,
                        at: plot.at(measured),
                        lost: measured.is_lost(),
                    });
                }
            }
        }
        Some(plot)
    }

    /// Returns the place of a run.
    pub fn at(&self, run: &Measurement) -> Pos2 {
        let [x, y] = self.axes;
        let height = y.at(run.work) as f32;
        if run.is_lost() {
            return pos2(self.area.right() + 0.5 * ROOM[3], height);
        }
        pos2(x.at(run.error.max(f64::MIN_POSITIVE)) as f32, height)
    }

    /// Returns the places of the runs that the line of a curve joins.
    pub fn line(&self, curve: usize) -> Vec<Pos2> {
        let joined = self.problem.curves[curve].joined();
        joined.into_iter().map(|run| self.at(run)).collect()
    }

    /// Returns the point under the pointer: the nearest within reach.
    pub fn point_under(&self, pointer: Pos2) -> Option<&Point> {
        let distance = |point: &&Point| point.at.distance(pointer);
        let nearest = self.points.iter();
        let nearest = nearest.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.filter(|point| distance(point) <= POINT_REACH)
    }

    /// Returns the curve under the pointer: that of the point there, or else the nearest within
    /// reach.
    pub fn curve_under(&self, pointer: Pos2) -> Option<usize> {
        if let Some(point) = self.point_under(pointer) {
            return Some(point.curve);
        }
        let distance = |curve: &usize| {
            let line = self.line(*curve);
            let each = line.windows(2).map(|ends| from_segment(pointer, ends));
            each.fold(f32::INFINITY, f32::min)
        };
        let nearest = (0..self.problem.curves.len())
            .map(|curve| (curve, distance(&curve)))
            .min_by(|(_, a), (_, b)| a.total_cmp(b));
        nearest
            .filter(|(_, distance)| *distance <= CURVE_REACH)
            .map(|(curve, _)| curve)
    }
}

/// Returns the distance of a point from the line between two ends.
fn from_segment(point: Pos2, ends: &[Pos2]) -> f32 {
    let [from, way] = [ends[0], (ends[1] - ends[0]).to_pos2()];
    let way = way.to_vec2();
    let share = (point - from).dot(way) / way.length_sq().max(1e-12);
    (from + share.clamp(0.0, 1.0) * way).distance(point)
}

#[cfg(test)]
mod tests {
    use a3_plot::{Curve, CurveStyle};

    use super::*;

    /// Returns two curves: one of two runs, a decade apart in error and two in work; the other of
    /// one run, and one that blew up.
    fn chart() -> WorkPrecision {
        let run = |error, work, lost| Measurement {
            error,
            work,
            lost,
            ..Measurement::default()
        };
        let curve = |runs| Curve {
            style: CurveStyle::default(),
            name: String::new(),
            runs,
        };
        WorkPrecision {
            problems: vec![Problem {
                curves: vec![
                    curve(vec![run(1e-2, 1e3, false), run(1e-3, 1e5, false)]),
                    curve(vec![run(1e-1, 1e5, false), run(f64::INFINITY, 1e4, true)]),
                ],
                ..Problem::default()
            }],
            ..WorkPrecision::default()
        }
    }

    fn room() -> Rect {
        Rect::from_min_size(pos2(100.0, 50.0), vec2(500.0, 400.0))
    }

    #[test]
    fn points_are_where_their_errors_and_their_work_are() {
        let chart = chart();
        let plot = Plot::new(&chart, room()).unwrap();
        let at: Vec<_> = plot.points.iter().map(|point| point.at).collect();
        // Equal factors are equal distances; accurate runs are on the left, fast ones below.
        let decade = at[2].x - at[0].x;
        assert!(decade > 50.0 && (at[0].x - at[1].x - decade).abs() < 1e-3);
        assert!(at[0].y > at[1].y && (at[1].y - at[2].y).abs() < 1e-3);
        let middle = 0.5 * (at[0].y + at[1].y);
        assert!(plot.points[3].lost && (at[3].y - middle).abs() < 1e-3);
        assert!(at[3].x > plot.area.right() && at[3].x < room().right());
        assert!(at[..3].iter().all(|at| plot.area.contains(*at)));
        assert!(
            Plot::new(
                &chart,
                Rect::from_min_size(pos2(0.0, 0.0), vec2(90.0, 90.0))
            )
            .is_none()
        );
        assert!(Plot::new(&WorkPrecision::default(), room()).is_none());
    }

    #[test]
    fn the_nearest_point_and_curve_are_under_the_pointer() {
        let chart = chart();
        let plot = Plot::new(&chart, room()).unwrap();
        for point in &plot.points {
            for way in [vec2(0.0, 0.0), vec2(8.0, 0.0), vec2(-5.0, 8.0)] {
                let under = plot.point_under(point.at + way);
                assert_eq!(under, Some(point));
                assert_eq!(plot.curve_under(point.at + way), Some(point.curve));
            }
            assert_eq!(plot.point_under(point.at + vec2(0.0, -13.0)), None);
        }
        // On the line, and beside it.
        let [a, b] = [0, 1].map(|k| plot.points[k].at);
        let (middle, across) = (a + 0.5 * (b - a), (b - a).rot90().normalized());
        for (distance, curve) in [(0.0, Some(0)), (6.0, Some(0)), (-6.0, Some(0)), (9.0, None)] {
            let at = middle + distance * across;
            assert_eq!((plot.point_under(at), plot.curve_under(at)), (None, curve));
        }
        // The line ends at its last point.
        assert_eq!(plot.curve_under(b + 20.0 * (b - a).normalized()), None);
        // A single run has no line.
        assert!(plot.line(1).len() == 1);
    }
}
