//! Restitution: the speed after an impact, and the time of a touch within a step.

use nalgebra::Vector3;

use crate::path::Pose;

/// Halvings of a step that locate a touch.
const HALVINGS: usize = 52;

/// Speed (m/s) away from a surface after an impact at the speed `approach` (m/s).
///
/// Under an acceleration `press` (m/s2) towards the surface, what rebounds with the speed u comes
/// back after 2 u / press. Where that is sooner than `shortest` (s), the impact is inelastic: the
/// sum of ever shorter rebounds is finite, and what lies still is not thrown up.
pub(super) fn rebound_speed(restitution: f64, approach: f64, press: f64, shortest: f64) -> f64 {
    let speed = restitution * approach.max(0.0);
    if 2.0 * speed > press * shortest {
        speed
    } else {
        0.0
    }
}

/// Course of a particle in a step of h (s): the cubic with the positions (m) and velocities (m/s)
/// at both ends.
pub(super) struct Course {
    pub x: [Vector3<f64>; 2],
    pub v: [Vector3<f64>; 2],
    pub h: f64,
}

impl Course {
    /// Position at a share s of the step (m).
    pub fn position(&self, s: f64) -> Vector3<f64> {
        let ([x0, x1], [v0, v1]) = (self.x, self.v.map(|v| v * self.h));
        let left = 1.0 - s;
        let line = x0 + (x1 - x0) * s;
        line + (v0 * left - v1 * s + (x1 - x0) * (s - left)) * (s * left)
    }

    /// Velocity at a share s of the step (m/s).
    pub fn velocity(&self, s: f64) -> Vector3<f64> {
        let ([x0, x1], [v0, v1]) = (self.x, self.v);
        let left = 1.0 - s;
        let mean = (x1 - x0) / self.h;
        v0 * left + v1 * s + (mean * 2.0 - v0 - v1) * (3.0 * s * left)
    }
}

/// Share of a step just after it takes a particle inside an obstacle, unless it begins inside.
pub(super) fn first_inside(is_inside: impl Fn(f64) -> bool) -> Option<f64> {
    if is_inside(0.0) {
        return None;
    }
    let (mut before, mut after) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (before + after);
        if is_inside(middle) {
            after = middle;
        } else {
            before = middle;
        }
    }
    Some(after)
}

/// Change of a particle's velocity by a rebound (m/s), and what is left of the step then (s).
pub(super) struct Rebound {
    pub change: Vector3<f64>,
    pub left: f64,
}

/// Velocity of a point of an obstacle, seen from its place, in a pose.
pub(super) fn velocity(pose: &Pose, point: Vector3<f64>) -> Vector3<f64> {
    let along = pose.place.velocity;
    let turned = pose.orientation;
    turned.map_or(along, |turned| along + turned.spin.cross(&point))
}

/// Part of a vector at right angles to a unit normal.
pub(super) fn across(a: Vector3<f64>, normal: Vector3<f64>) -> Vector3<f64> {
    a - normal * a.dot(&normal)
}

pub(super) fn vector(a: &[f64], n: usize, i: usize) -> Vector3<f64> {
    Vector3::new(a[i], a[n + i], a[2 * n + i])
}

pub(super) fn set(a: &mut [f64], n: usize, i: usize, to: Vector3<f64>) {
    for axis in 0..3 {
        a[axis * n + i] = to[axis];
    }
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
        assert_eq!(first_inside(|s| s > 0.25), Some(0.25 + 2f64.powi(-52)));
    }
}
