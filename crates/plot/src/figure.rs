//! Figures: sheets that remember where their labels are, as SVG, PDF and PNG.

use std::ops::Range;

use crate::axis::Axis;
use crate::error::Error;
use crate::geometry::{Point, Rect};
use crate::label::{GREY, Label};
use crate::paint::{Paint, Pen};
use crate::shape::Shape;
use crate::{pdf, raster, svg};

/// A drawing on a sheet, whose units are the pixels of an SVG.
#[derive(Debug)]
pub struct Figure {
    size: Point,
    /// The shapes, from the lowest one up.
    pub shapes: Vec<Shape>,
    /// The places of the shapes of curves among all, and the indices of the curves in their panels.
    pub parts: Vec<(Range<usize>, usize)>,
    /// The areas between the axes of the panels, and the axes across and up.
    pub panels: Vec<(Rect, [Axis; 2])>,
    /// The runs of a diagram, as indices of curve and run, and where their markers are.
    pub runs: Vec<([usize; 2], Point)>,
    /// The rectangles that labels occupy.
    labels: Vec<Rect>,
}

impl Figure {
    /// Creates an empty sheet of this width and height.
    pub(crate) fn new(size: Point) -> Self {
        Self { size, shapes: vec![], parts: vec![], panels: vec![], runs: vec![], labels: vec![] }
    }

    /// Returns the whole sheet.
    pub(crate) fn sheet(&self) -> Rect {
        Rect::new(0.0, 0.0, self.size[0], self.size[1])
    }

    /// Draws a line through points.
    pub(crate) fn line(&mut self, points: &[Point], pen: Pen) {
        self.shapes.push(Shape::Line(points.to_vec(), pen));
    }

    /// Paints the area inside outlines. An outline inside another one is a hole.
    pub(crate) fn area(&mut self, outlines: Vec<Vec<Point>>, paint: Paint) {
        self.shapes.push(Shape::Area(outlines, paint));
    }

    /// Paints a rectangle.
    pub(crate) fn rect(&mut self, r: Rect, paint: Paint) {
        self.area(vec![r.corners().to_vec()], paint);
    }

    /// Clips all that `draw` draws at the edges of `window`.
    pub(crate) fn clipped(&mut self, window: Rect, draw: impl FnOnce(&mut Self)) {
        let outside = std::mem::take(&mut self.shapes);
        draw(self);
        let inside = std::mem::replace(&mut self.shapes, outside);
        self.shapes.push(Shape::Clipped(window, inside));
    }

    /// Draws an arrow with its head at `to`.
    pub(crate) fn arrow(&mut self, from: Point, to: Point, width: f64) {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let length = dx.hypot(dy).max(1e-9);
        let (u, v) = (4.0 * width * dx / length, 4.0 * width * dy / length);
        let neck = [to[0] - u, to[1] - v];
        self.line(&[from, neck], Pen::new(GREY, width));
        let head = vec![
            to,
            [neck[0] - v / 2.0, neck[1] + u / 2.0],
            [neck[0] + v / 2.0, neck[1] - u / 2.0],
        ];
        self.area(vec![head], Paint::fill(GREY));
    }

    /// Writes a label at a point, and returns the rectangle that it occupies.
    pub(crate) fn text(&mut self, at: Point, label: Label) -> Rect {
        let room = label.room(at);
        if !label.text.is_empty() {
            self.labels.push(room);
            let shape = Shape::Text(at, label.text.to_owned(), label.look);
            self.shapes.push(shape);
        }
        room
    }

    /// Keeps labels out of a rectangle.
    pub(crate) fn reserve(&mut self, room: Rect) {
        self.labels.push(room);
    }

    /// Returns whether a rectangle is on the sheet and clear of labels.
    pub(crate) fn is_free(&self, room: Rect) -> bool {
        self.sheet().holds(room) && !self.labels.iter().any(|label| label.overlaps(room))
    }

    /// Returns whether all labels are on the sheet and none overlaps another.
    pub(crate) fn is_sound(&self) -> bool {
        let free = |(k, label): (usize, &Rect)| {
            let others = &self.labels[..k];
            self.sheet().holds(*label) && !others.iter().any(|other| other.overlaps(*label))
        };
        self.labels.iter().enumerate().all(free)
    }

    /// Returns the curve whose line or entry in the legend are nearest to a point, at most
    /// `reach` away.
    #[must_use]
    pub fn curve_at(&self, at: Point, reach: f64) -> Option<usize> {
        let near = self.parts.iter().flat_map(|(places, curve)| {
            let shapes = self.shapes[places.clone()].iter();
            shapes.map(|shape| (shape.distance(at), *curve))
        });
        let near = near.filter(|(distance, _)| *distance <= reach);
        near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, k)| k)
    }

    /// Returns the figure as an SVG file.
    #[must_use]
    pub fn svg(&self) -> String {
        svg::file(self.size, &self.shapes)
    }

    /// Returns the figure as a PDF file with one page, whose size is that of the sheet at 96 units
    /// an inch.
    #[must_use]
    pub fn pdf(&self) -> Vec<u8> {
        pdf::file(self.size, &self.shapes)
    }

    /// Returns the figure as a PNG file, with `scale` pixels for each unit of the sheet.
    ///
    /// # Errors
    /// [`Error::Pixels`] if the picture would be too large.
    pub fn png(&self, scale: f64) -> Result<Vec<u8>, Error> {
        raster::file(self.size, &self.shapes, scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sheet_sees_texts_that_overlap() {
        let mut figure = Figure::new([100.0, 50.0]);
        figure.text([10.0, 20.0], Label::new("first", 10.0));
        assert!(figure.is_sound());
        figure.text([25.0, 25.0], Label::new("second", 10.0));
        assert!(!figure.is_sound());
        let mut figure = Figure::new([100.0, 50.0]);
        figure.text([80.0, 20.0], Label::new("too long", 10.0));
        assert!(!figure.is_sound());
    }

    #[test]
    #[cfg_attr(miri, ignore = "takes hours there")]
    fn texts_are_measured_as_they_are_drawn() {
        let mut figure = Figure::new([400.0, 100.0]);
        let room = figure.text([20.0, 60.0], Label::new("Wäg & <λ> 10^{−3}", 40.0));
        let picture = image::load_from_memory(&figure.png(1.0).unwrap()).unwrap().to_luma8();
        let dark = picture.enumerate_pixels().filter(|(_, _, p)| p.0[0] < 128);
        let ink = dark.fold(Rect::new(400.0, 100.0, 0.0, 0.0), |r, (x, y, _)| {
            let (x, y) = (f64::from(x), f64::from(y));
            Rect::new(r.x0.min(x), r.y0.min(y), r.x1.max(x + 1.0), r.y1.max(y + 1.0))
        });
        assert!(room.holds(ink), "{ink:?} in {room:?}");
        assert!(ink.width() > 0.93 * room.width(), "{ink:?} in {room:?}");
    }
}
