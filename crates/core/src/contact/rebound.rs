//! Laws of an impact, for all that touches: restitution, Coulomb friction, and the separation that
//! bodies get back; and the course of a particle up to it.

use nalgebra::Vector3;

/// Fraction of the missing separation of bodies that is restored in a step. Nothing else would
/// restore what they lose in each step under pressure.
pub(super) const RESTORED_SHARE: f64 = 0.1;

/// Returns the change of a relative velocity (m/s) by an impact after which it has this speed (m/s)
/// along the normal. Coulomb friction stops the slip, as far as the change along the normal allows.
pub(super) fn change_in_impact(
    relative: Vector3<f64>,
    normal: Vector3<f64>,
    speed: f64,
    friction: f64,
) -> Vector3<f64> {
    let along = speed - relative.dot(&normal);
    normal * along - limited_to(across(relative, normal), friction * along)
}

/// Returns the component of a vector perpendicular to a unit normal.
pub(super) fn across(a: Vector3<f64>, normal: Vector3<f64>) -> Vector3<f64> {
    a - normal * a.dot(&normal)
}

/// Limits a slip to the length `most`.
pub(super) fn limited_to(slip: Vector3<f64>, most: f64) -> Vector3<f64> {
    let length = slip.norm();
    if length > most {
        slip * (most / length)
    } else {
        slip
    }
}

/// Returns the shortest time (s) in which a rebound comes back under an acceleration `press` (m/s2)
/// towards the surface: `time`, or that from a height (m), below which rebounds are left out.
pub(crate) fn shortest_rebound(press: f64, [height, time]: [f64; 2]) -> f64 {
    if press > 0.0 {
        (8.0 * height / press).sqrt().max(time)
    } else {
        time
    }
}

/// Returns the speed (m/s) away from a surface after an impact at the speed `approach` (m/s).
///
/// Under an acceleration `press` (m/s2) towards the surface, a particle that rebounds at the speed
/// u comes back after 2 u / press. If that is sooner than `shortest` (s), the impact is inelastic:
/// so a sequence of ever shorter rebounds ends, and a particle at rest is not thrown up.
pub(crate) fn rebound_speed(restitution: f64, approach: f64, press: f64, shortest: f64) -> f64 {
    let speed = restitution * approach.max(0.0);
    if 2.0 * speed > press * shortest {
        speed
    } else {
        0.0
    }
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
