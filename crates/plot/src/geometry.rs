//! Points and rectangles on the sheet.

/// A horizontal and a vertical coordinate; the latter points down on the sheet.
pub type Point = [f64; 2];

/// An axis-aligned rectangle on a sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// The left edge.
    pub x0: f64,
    /// The upper edge.
    pub y0: f64,
    /// The right edge.
    pub x1: f64,
    /// The lower edge.
    pub y1: f64,
}

impl Rect {
    pub(crate) fn new(x0: f64, y0: f64, x1: f64, y1: f64) -> Self {
        Self { x0, y0, x1, y1 }
    }

    /// Creates the square around a point whose half side is `r`.
    pub(crate) fn around(at: Point, r: f64) -> Self {
        Self::spread(at, r, r)
    }

    /// Creates the rectangle around a point whose half sides are these.
    pub(crate) fn spread([x, y]: Point, across: f64, up: f64) -> Self {
        Self::new(x - across, y - up, x + across, y + up)
    }

    /// Returns the rectangle with other left and right edges.
    pub(crate) fn across(self, x0: f64, x1: f64) -> Self {
        Self { x0, x1, ..self }
    }

    /// Returns the rectangle with another lower edge.
    pub(crate) fn down_to(self, y1: f64) -> Self {
        Self { y1, ..self }
    }

    pub(crate) fn width(self) -> f64 {
        self.x1 - self.x0
    }

    pub(crate) fn height(self) -> f64 {
        self.y1 - self.y0
    }

    pub(crate) fn centre(self) -> Point {
        [f64::midpoint(self.x0, self.x1), f64::midpoint(self.y0, self.y1)]
    }

    /// Returns whether the rectangles overlap in an area.
    pub(crate) fn overlaps(self, other: Self) -> bool {
        self.x0 < other.x1 && other.x0 < self.x1 && self.y0 < other.y1 && other.y0 < self.y1
    }

    /// Returns whether the other rectangle lies entirely in this one.
    pub(crate) fn holds(self, other: Self) -> bool {
        self.x0 <= other.x0 && other.x1 <= self.x1 && self.y0 <= other.y0 && other.y1 <= self.y1
    }

    /// Returns the corners, in order around the rectangle.
    pub(crate) fn corners(self) -> [Point; 4] {
        [[self.x0, self.y0], [self.x1, self.y0], [self.x1, self.y1], [self.x0, self.y1]]
    }

    /// Returns whether the line from a to b meets the rectangle (Liang and Barsky, 1984).
    pub(crate) fn meets(self, a: Point, b: Point) -> bool {
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for (start, end, lo, hi) in [(a[0], b[0], self.x0, self.x1), (a[1], b[1], self.y0, self.y1)]
        {
            let d = end - start;
            if d == 0.0 {
                if start < lo || start > hi {
                    return false;
                }
                continue;
            }
            let (near, far) = ((lo - start) / d, (hi - start) / d);
            from = from.max(near.min(far));
            to = to.min(near.max(far));
        }
        from <= to
    }
}
