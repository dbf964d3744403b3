//! Shapes on a sheet.

use crate::geometry::{Point, Rect};
use crate::label::{Label, Look};
use crate::paint::{Paint, Pen};

/// A shape on a sheet, whose units count from its upper left corner.
#[derive(Debug)]
pub enum Shape {
    /// A line through points.
    Line(Vec<Point>, Pen),
    /// The area inside outlines. An outline inside another one is a hole.
    Area(Vec<Vec<Point>>, Paint),
    /// A label with its base line at a point, in which `10^{-3}` stands for a superscript.
    Text(Point, String, Look),
    /// Shapes that are clipped at the edges of a window.
    Clipped(Rect, Vec<Shape>),
}

impl Shape {
    /// Returns the distance of a point from a line, or from the middle line of a label.
    pub(crate) fn distance(&self, [x, y]: Point) -> f64 {
        let middle;
        let line = match self {
            Self::Line(points, _) => &points[..],
            Self::Text(at, text, look) => {
                let room = Label { text, look: *look }.room(*at);
                middle = [room.x0, room.x1].map(|x| [x, room.centre()[1]]);
                &middle
            }
            _ => &[],
        };
        let beside = |ends: &[Point]| {
            let [dx, dy] = [0, 1].map(|k| ends[1][k] - ends[0][k]);
            let (x, y) = (x - ends[0][0], y - ends[0][1]);
            let share = (x * dx + y * dy) / (dx * dx + dy * dy).max(1e-12);
            let share = share.clamp(0.0, 1.0);
            (x - share * dx).hypot(y - share * dy)
        };
        line.windows(2).map(beside).fold(f64::INFINITY, f64::min)
    }
}
