//! Pieces of cylinders and balls, with the nodes of their quadrature.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use crate::geometry::normals;

/// Places between 0 and 1, and shares of the length: the Gauss quadrature of order 6.
const NODES: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Number of faces around the axis of a round part.
const AROUND: usize = 8;

/// Piece of a cylinder or of a ball, whose area is its height times its angle times the radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Round {
    /// Point on the axis at height 0 (m); of a ball, its middle.
    middle: Vector3<f64>,
    /// Unit vectors along the axis, and across it at the angles 0 and 90 degrees.
    axes: [Vector3<f64>; 3],
    radius: f64,
    /// Whether it is a piece of a ball.
    is_ball: bool,
    /// From where to where it reaches along the axis (m).
    heights: [f64; 2],
    /// From where to where it reaches around the axis (rad).
    angles: [f64; 2],
}

impl Round {
    /// Calls `visit` with each node of the quadrature, and its share of the area (m2) times the
    /// normal, which points outwards.
    pub fn nodes(&self, visit: &mut impl FnMut(Vector3<f64>, Vector3<f64>)) {
        let ([low, high], [from, to]) = (self.heights, self.angles);
        let area = self.radius * (high - low) * (to - from);
        for (along, share) in NODES {
            for (around, part) in NODES {
                let (height, angle) = (low + along * (high - low), from + around * (to - from));
                let (point, normal) = self.point(height, angle);
                visit(point, normal * (area * share * part));
            }
        }
    }

    /// Returns a ball that encloses the piece: its middle and radius (m).
    pub fn ball(&self) -> (Vector3<f64>, f64) {
        let [height, angle] = [self.heights, self.angles].map(|[a, b]| 0.5 * (a + b));
        let [along, around] = self.sides();
        (self.point(height, angle).0, along + 0.5 * around)
    }

    /// Returns the length of the longest side (m).
    pub fn length(&self) -> f64 {
        let [along, around] = self.sides();
        along.max(around)
    }

    /// Returns both halves, cut across the longest side.
    pub fn halves(self) -> [Self; 2] {
        let [along, around] = self.sides();
        let halves = |[a, b]: [f64; 2]| [[a, 0.5 * (a + b)], [0.5 * (a + b), b]];
        if along > around {
            halves(self.heights).map(|heights| Self { heights, ..self })
        } else {
            halves(self.angles).map(|angles| Self { angles, ..self })
        }
    }

    /// Returns the point at a height (m) and an angle (rad), and the normal there.
    fn point(&self, height: f64, angle: f64) -> (Vector3<f64>, Vector3<f64>) {
        let [axis, side, other] = self.axes;
        let outwards = side * libm::cos(angle) + other * libm::sin(angle);
        if !self.is_ball {
            return (
                self.middle + axis * height + outwards * self.radius,
                outwards,
            );
        }
        let normal = axis * (height / self.radius) + outwards * (self.across(height) / self.radius);
        (self.middle + normal * self.radius, normal)
    }

    /// Returns the distance from the axis at a height (m).
    fn across(&self, height: f64) -> f64 {
        if self.is_ball {
            (self.radius * self.radius - height * height)
                .max(0.0)
                .sqrt()
        } else {
            self.radius
        }
    }

    /// Returns the lengths along and around the axis (m).
    fn sides(&self) -> [f64; 2] {
        let [low, high] = self.heights;
        let along = if self.is_ball {
            let angle = |height: f64| libm::atan2(height, self.across(height));
            self.radius * (angle(high) - angle(low))
        } else {
            high - low
        };
        let widest = self.across(low).max(self.across(high));
        [along, widest * (self.angles[1] - self.angles[0])]
    }
}

/// Lists the faces of a capsule between the middles of its ends, or of a sphere.
pub(super) fn round([first, last]: [Vector3<f64>; 2], radius: f64) -> impl Iterator<Item = Round> {
    let length = (last - first).norm();
    let axis = if length > 0.0 {
        (last - first) / length
    } else {
        Vector3::y()
    };
    let [side, other] = normals(axis);
    let half = 0.5 * length;
    let pieces = [
        (first, true, [-radius, 0.0]),
        (first, false, [0.0, half]),
        (first, false, [half, length]),
        (last, true, [0.0, radius]),
    ];
    let pieces = pieces.into_iter().filter(|(_, _, [low, high])| low < high);
    let around = move |(middle, is_ball, heights)| {
        let angle = |k: usize| TAU * k as f64 / AROUND as f64;
        (0..AROUND).map(move |k| Round {
            middle,
            axes: [axis, side, other],
            radius,
            is_ball,
            heights,
            angles: [angle(k), angle(k + 1)],
        })
    };
    pieces.flat_map(around)
}
