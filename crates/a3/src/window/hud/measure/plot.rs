//! The places of the runs of a diagram on the screen, and the run under the pointer.

use a3_plot::{Axis, Measurement, Problem, WorkPrecision};
use egui::{Pos2, Rect, pos2, vec2};

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
