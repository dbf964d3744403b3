//! Shapes on a sheet.

use crate::geometry::{Point, Rect};
use crate::label::Look;
use crate::paint::{Paint, Pen};

/// A shape on a sheet.
#[derive(Debug)]
pub enum Shape {
    /// A line through points.
    Line(Vec<Point>, Pen),
    /// The area inside outlines. An outline inside another one is a hole.
    Area(Vec<Vec<Point>>, Paint),
    /// A label at a point.
    Text(Point, String, Look),
    /// Shapes that are clipped at the edges of a window.
    Clipped(Rect, Vec<Shape>),
}
