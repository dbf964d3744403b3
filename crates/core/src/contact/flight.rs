//! Courses of vertices in a step, before and after impacts: parabolas.
//!
//! In a step of h, a vertex moves by the displacement that the method gives it, with the change of
//! its velocity spread evenly. This parabola is the course of a free fall by every method, also by
//! those of order 1, whose velocities belong to the middle of another step. An impact adds the
//! change of velocity from its time on, and leaves the accelerations as they are.

use nalgebra::Vector3;

use super::solids::Field;

/// Changes of velocities in a step, and how far velocities are from those of the parabolas.
#[derive(Debug, Default)]
pub(super) struct Flight {
    /// Length of the step (s).
    h: f64,
    points: Vec<Bend>,
    turns: Vec<Bend>,
    /// Share of the step at which each vertex had its last impact; 0 if none.
    pub since: Vec<f64>,
}

/// Bend of a course.
#[derive(Clone, Copy, Debug, Default)]
struct Bend {
    /// Change of the velocity in the step, without impacts (m/s or rad/s).
    gain: Vector3<f64>,
    /// Velocity of the parabola at the end of the step, less that of the method (m/s or rad/s).
    lag: Vector3<f64>,
}

impl Flight {
    /// Reads the courses of a step of h (s) with these velocities at its beginning and its end, and
    /// these displacements, before impacts.
    pub fn read(&mut self, h: f64, [v0, v, moves]: [&Field; 3]) {
        self.h = h;
        let read = |bends: &mut Vec<Bend>, [v0, v, moves]: [&[Vector3<f64>]; 3]| {
            bends.clear();
            bends.extend(v0.iter().zip(v).zip(moves).map(|((v0, v), way)| Bend {
                gain: v - v0,
                lag: way / h - (v0 + v) * 0.5,
            }));
        };
        read(&mut self.points, [&v0.points, &v.points, &moves.points]);
        read(&mut self.turns, [&v0.turns, &v.turns, &moves.turns]);
        self.since.clear();
        self.since.resize(v.points.len(), 0.0);
    }

    /// Forgets the bends of all courses, where velocities have changed by impulses and not evenly.
    pub fn straighten(&mut self) {
        self.points.fill(Bend::default());
        self.turns.fill(Bend::default());
    }

    /// Returns the velocity of a vertex (m/s) at a share of the step, if it is `end` (m/s) at its
    /// end.
    pub fn velocity(&self, i: usize, share: f64, end: Vector3<f64>) -> Vector3<f64> {
        self.points[i].velocity(1.0 - share, end)
    }

    /// Returns the change of the velocity of a vertex in the step without impacts (m/s).
    pub fn gain(&self, i: usize) -> Vector3<f64> {
        self.points[i].gain
    }

    /// Returns the change of the angular velocity of a body in the step without impacts, and how
    /// far it is behind that of the course (rad/s).
    pub fn turn(&self, solid: usize) -> [Vector3<f64>; 2] {
        [self.turns[solid].gain, self.turns[solid].lag]
    }

    /// Returns the position of a vertex (m) at a share of the step, from the position (m) and the
    /// velocity (m/s) at its end.
    pub fn position(&self, i: usize, share: f64, end: [Vector3<f64>; 2]) -> Vector3<f64> {
        let left = 1.0 - share;
        end[0] - self.points[i].velocity(0.5 * left, end[1]) * (left * self.h)
    }

    /// Returns the share of the step at which a distance that depends on vertices comes to `kept`:
    /// the last time at which it shrinks to that. `along` sums the vertices' vectors to the
    /// distance's, with their numbers; `end` is the distance at the end of the step (m), and `rate`
    /// its change there (m/s) by the velocities at the end. It is above 1 if that is after the
    /// step, and `None` if it never happens.
    pub fn arrival(
        &self,
        along: impl Fn(&dyn Fn(usize) -> Vector3<f64>) -> f64,
        [end, rate, kept]: [f64; 3],
    ) -> Option<f64> {
        let gain = along(&|i| self.points[i].gain);
        let rate = rate + along(&|i| self.points[i].lag);
        // a r2 + b r + c = 0 for the share r from the arrival to the end.
        let (a, b, c) = (0.5 * self.h * gain, -self.h * rate, end - kept);
        let root = (b * b - 4.0 * a * c).sqrt();
        let left = if b > 0.0 {
            -2.0 * c / (b + root)
        } else {
            (root - b) / (2.0 * a)
        };
        left.is_finite().then_some(1.0 - left)
    }
}

impl Bend {
    /// Returns the velocity at a share before the end of the step at which the method's is `end`.
    fn velocity(&self, left: f64, end: Vector3<f64>) -> Vector3<f64> {
        end - self.gain * left + self.lag
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A free fall in steps of the explicit Euler method's kind, whose positions lag.
    #[test]
    fn a_course_is_a_parabola_through_both_ends() {
        let (h, g) = (0.5, Vector3::new(0.0, -9.0, 1.0));
        let field = |v: Vector3<f64>| {
            let mut field = Field::default();
            field.points.push(v);
            field
        };
        let v0 = Vector3::new(1.0, -2.0, 3.0);
        let (v, way) = (v0 + g * h, v0 * h);
        let mut flight = Flight::default();
        flight.read(h, [&field(v0), &field(v), &field(way)]);
        let at = |share: f64| flight.position(0, share, [way, v]);
        assert!((at(0.0)).norm() < 1e-15 && (at(1.0) - way).norm() < 1e-15);
        for share in [0.1, 0.7] {
            let speed = (at(share + 1e-3) - at(share - 1e-3)) / (2e-3 * h);
            assert!((speed - flight.velocity(0, share, v)).norm() < 1e-12);
        }
        let bend = (at(1.0) - at(0.5) * 2.0 + at(0.0)) / (0.25 * h * h);
        assert!((bend - g).norm() < 1e-12, "{bend}");
        // It sinks through the height of its course at a share of 0.7.
        let along = |vector: &dyn Fn(usize) -> Vector3<f64>| vector(0).y;
        let found = flight.arrival(along, [way.y, v.y, at(0.7).y]);
        assert!((found.unwrap() - 0.7).abs() < 1e-12, "{found:?}");
    }
}
