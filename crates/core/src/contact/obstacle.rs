//! Obstacles: a shape on a path, with friction and restitution; and the course of a particle.

use nalgebra::Vector3;

use crate::error::{Error, at_least, share};
use crate::geometry::Shape;
use crate::path::{Path, Pose, Turn};

/// Difference of two times, over their size, that is a rounding error.
const SAME_TIME: f64 = 4.0 * f64::EPSILON;

/// Body that particles stay out of, still or moving.
///
/// ```
/// use a3_core::contact::{Obstacle, Shape};
/// use a3_core::{Path, Vector3};
///
/// let ball = Obstacle {
///     friction: 0.5,
///     ..Obstacle::smooth(Shape::Sphere { radius: 1.0 }, Path::Still(Vector3::zeros()))
/// };
/// assert_eq!(ball.depth(0.0, Vector3::new(0.0, 0.75, 0.0)), 0.25);
/// assert_eq!(ball.depth(0.0, Vector3::new(0.0, 3.0, 0.0)), -2.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// Shape in the obstacle's own frame, before it turned.
    pub shape: Shape,
    /// Position over time: of the centre of a sphere or a box; of a floor, of any point of its
    /// surface.
    pub path: Path,
    /// Rotation about its place, if it has one. Floors do not turn.
    pub turn: Option<Turn>,
    /// Coefficient mu of Coulomb friction; 0 is a smooth surface.
    pub friction: f64,
    /// Coefficient e of restitution, from 0 to 1: the speed along the normal after an impact, over
    /// that before it.
    pub restitution: f64,
    /// Thickness of its surface where surfaces touch (m).
    pub thickness: f64,
}

impl Obstacle {
    /// Creates a smooth obstacle of that shape on that path.
    #[must_use]
    pub fn smooth(shape: Shape, path: Path) -> Self {
        Self { shape, path, turn: None, friction: 0.0, restitution: 0.0, thickness: 0.0 }
    }

    /// Returns the place and orientation at time t (s), which determine the positions of the
    /// obstacle's points.
    #[must_use]
    pub fn at(&self, t: f64) -> Pose {
        Pose { place: self.path.at(t), orientation: self.turn.map(|turn| turn.orientation(t)) }
    }

    /// Lists the times at which its motion begins or ends (s). Some may be infinite or occur twice.
    pub(crate) fn known_times(&self) -> impl Iterator<Item = f64> {
        let of_turn = self.turn.into_iter().flat_map(|turn| turn.known_times());
        self.path.known_times().into_iter().chain(of_turn)
    }

    /// Returns the place and orientation at both ends of a step (s): where a motion begins or ends
    /// at one, with the velocities on the side of the step.
    pub(super) fn at_ends(&self, [begin, end]: [f64; 2]) -> [Pose; 2] {
        let near = |t: f64| {
            let mut known = self.known_times();
            known.find(|known| (known - t).abs() <= SAME_TIME * t.abs())
        };
        [
            self.at(near(begin).map_or(begin, |known| known.max(begin))),
            self.at(near(end).map_or(end, |known| known.min(end).next_down())),
        ]
    }

    /// Returns the depth (m) of a place (m) inside at time t (s); below 0 outside.
    #[must_use]
    pub fn depth(&self, t: f64, place: Vector3<f64>) -> f64 {
        let pose = self.at(t);
        let seen = pose.inwards(place - pose.place.position);
        -self.shape.separation(seen).distance
    }

    /// Returns whether it neither moves nor turns.
    #[must_use]
    pub fn is_still(&self) -> bool {
        matches!(self.path, Path::Still(_)) && self.turn.is_none()
    }

    /// Returns whether it has flat faces and does not move.
    pub(crate) fn is_flat(&self) -> bool {
        self.is_still() && self.shape.is_faceted()
    }

    /// Returns the height (m) of its highest point over the plane through x (m) with this normal,
    /// at the beginning.
    pub(crate) fn rise(&self, x: &Vector3<f64>, normal: &Vector3<f64>) -> f64 {
        let pose = self.at(0.0);
        let place = (pose.place.position - x).dot(normal);
        if self.shape == Shape::Floor {
            let is_level = *normal == Vector3::y();
            return if is_level { place } else { f64::INFINITY };
        }
        let simplices = self.shape.simplices();
        let heights = (simplices.points.iter()).map(|point| pose.outwards(*point).dot(normal));
        place + simplices.radius + heights.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Checks the numbers of the obstacle.
    ///
    /// # Errors
    /// The shape has no size, the friction is negative, or the restitution is not from 0 to 1; or a
    /// number is not finite.
    pub(crate) fn check(&self) -> Result<(), Error> {
        self.shape.check()?;
        at_least(0.0, "the friction of an obstacle", self.friction)?;
        share("the restitution of an obstacle", self.restitution)?;
        at_least(0.0, "the thickness of an obstacle", self.thickness)
    }
}

/// Returns the velocity (m/s) of a point of an obstacle, relative to its place, in a pose.
pub(super) fn velocity(pose: &Pose, point: Vector3<f64>) -> Vector3<f64> {
    let along = pose.place.velocity;
    let turned = pose.orientation;
    turned.map_or(along, |turned| along + turned.spin.cross(&point))
}

/// Course of a particle in a step of h (s): the cubic with the positions (m) and velocities (m/s)
/// at both ends.
#[derive(Debug)]
pub(crate) struct Course {
    pub x: [Vector3<f64>; 2],
    pub v: [Vector3<f64>; 2],
    pub h: f64,
}

impl Course {
    /// Returns the position at a share s of the step (m).
    pub fn position(&self, s: f64) -> Vector3<f64> {
        let ([x0, x1], [v0, v1]) = (self.x, self.v.map(|v| v * self.h));
        let left = 1.0 - s;
        let line = x0 + (x1 - x0) * s;
        line + (v0 * left - v1 * s + (x1 - x0) * (s - left)) * (s * left)
    }

    /// Returns the velocity at a share s of the step (m/s).
    pub fn velocity(&self, s: f64) -> Vector3<f64> {
        let ([x0, x1], [v0, v1]) = (self.x, self.v);
        let left = 1.0 - s;
        let mean = (x1 - x0) / self.h;
        v0 * left + v1 * s + (mean * 2.0 - v0 - v1) * (3.0 * s * left)
    }
}

/// Share of the size of a box within which its face lies against another obstacle.
const AGAINST_SHARE: f64 = 1e-9;

/// Number of lengths, each half of the one before, by which a face is tried to reach on.
const TRIED_LENGTHS: u32 = 4;

/// Returns the obstacles as single particles meet them, if that differs: a box that stands on a
/// floor or lies against another box, and does not move, reaches on into it. Nothing that lies on
/// the one then slips into the other along the face between them, and no seam stops it.
pub(crate) fn reaching_on(all: &[Obstacle]) -> Option<Vec<Obstacle>> {
    let reached: Vec<_> = (0..all.len()).map(|k| reach_on(all, k)).collect();
    if reached.iter().all(Option::is_none) {
        return None;
    }
    let both = all.iter().zip(reached);
    Some(both.map(|(own, reached)| reached.unwrap_or_else(|| own.clone())).collect())
}

/// Returns box k, if faces of it lie against other obstacles, with those faces inside these.
fn reach_on(all: &[Obstacle], k: usize) -> Option<Obstacle> {
    let (Shape::Box { half_extents, axes }, Path::Still(center)) = (&all[k].shape, &all[k].path)
    else {
        return None;
    };
    let others = all.iter().enumerate();
    let is_solid = |other: &Obstacle| matches!(other.shape, Shape::Floor | Shape::Box { .. });
    let others = others.filter(|(j, other)| *j != k && other.is_still() && is_solid(other));
    let others: Vec<_> = others.map(|(_, other)| other).collect();
    if !all[k].is_still() || others.is_empty() {
        return None;
    }
    let none = AGAINST_SHARE * half_extents.max();
    let (mut low, mut high) = (*half_extents, *half_extents);
    for axis in 0..3 {
        for (ends, sign) in [(&mut low, -1.0), (&mut high, 1.0)] {
            let outwards = axes[axis] * sign;
            let [a, b] = [1, 2].map(|next| {
                let across = (axis + next) % 3;
                axes[across] * half_extents[across]
            });
            let corners = [a + b, a - b, b - a, -a - b];
            let holds = |other: &Obstacle, reach: f64| {
                let face = center + outwards * (half_extents[axis] + reach);
                corners.iter().all(|corner| other.depth(0.0, face + corner) >= -none)
            };
            let against = others.iter().filter(|other| holds(other, 0.0));
            let lengths = (0..TRIED_LENGTHS).map(|k| 2.0 * half_extents[axis] / f64::from(1 << k));
            let reached =
                against.filter_map(|other| lengths.clone().find(|reach| holds(other, *reach)));
            ends[axis] += reached.fold(0.0, f64::max);
        }
    }
    let middle =
        (0..3).fold(*center, |middle, axis| middle + axes[axis] * (0.5 * (high[axis] - low[axis])));
    (low + high != half_extents * 2.0).then(|| Obstacle {
        shape: Shape::Box { half_extents: (low + high) * 0.5, axes: *axes },
        path: Path::Still(middle),
        ..all[k].clone()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_course_is_the_cubic_and_its_slope() {
        let v = |x: f64| Vector3::new(x, -2.0 * x, 0.5);
        // x(t) = t3 - 2 t2 + 3 t + 1 from t = 1 to 1.5.
        let (position, speed) = (
            |t: f64| t * t * t - 2.0 * t * t + 3.0 * t + 1.0,
            |t: f64| 3.0 * t * t - 4.0 * t + 3.0,
        );
        let slope = |x: f64| Vector3::new(x, -2.0 * x, 0.0);
        let course = Course {
            x: [1.0, 1.5].map(|t| v(position(t))),
            v: [1.0, 1.5].map(|t| slope(speed(t))),
            h: 0.5,
        };
        for s in [0.0, 0.2, 0.7, 1.0] {
            let t = 1.0 + 0.5 * s;
            assert!((course.position(s) - v(position(t))).norm() < 1e-14);
            assert!((course.velocity(s) - slope(speed(t))).norm() < 1e-13);
        }
    }
}
