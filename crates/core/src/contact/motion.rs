//! Motion of all vertices in a step, which the collision safeguard changes, and its statistics.
//!
//! In a step of h, a vertex moves by the displacement that the method gives it, with the change of
//! its velocity spread evenly. This parabola is the course of a free fall by every method, also by
//! those of order 1, whose velocities belong to the middle of another step. An impact adds the
//! change of velocity from its time on, and leaves the accelerations as they are.

use std::ops::AddAssign;
use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::advance::{are_apart, time_and_planes};
use super::candidates::{Candidates, Stretch};
use super::impulse::Impulses;
use super::listing::Candidate;
use super::skin::Law;
use super::solids::{Field, Solid};
use super::surface::Surface;
use crate::geometry::{Closest, PairKind, closest, weighted};
use crate::rigid::{ROTATION, Rotation};

/// Number of planes between a pair that the cost of an evaluation includes.
const INCLUDED_PLANES: usize = 16;

/// Actions of the collision safeguard in a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Guarded {
    /// Number of impulses.
    pub impulses: usize,
    /// Sum of the magnitudes of the impulses and of friction (N s).
    pub impulse: f64,
    /// Number of vertices whose displacement was cut.
    pub cuts: usize,
    /// Sum of the magnitudes of the momentum lost by cuts (N s).
    pub lost: f64,
    /// Share of the step at which the first impulse was necessary; 1 if none was.
    pub first: f64,
    /// Number of planes between pairs in the search for impacts, beyond the usual number.
    pub planes: usize,
    /// Estimated error of the displacements by friction of obstacles that turn (m): friction acts
    /// after the step, where the estimate of the method does not see it.
    #[serde(skip)]
    pub missed: f64,
}

impl Default for Guarded {
    fn default() -> Self {
        Self { impulses: 0, impulse: 0.0, cuts: 0, lost: 0.0, first: 1.0, planes: 0, missed: 0.0 }
    }
}

impl AddAssign for Guarded {
    fn add_assign(&mut self, other: Self) {
        self.impulses += other.impulses;
        self.impulse += other.impulse;
        self.cuts += other.cuts;
        self.lost += other.lost;
        self.first = self.first.min(other.first);
        self.planes += other.planes;
        self.missed = self.missed.max(other.missed);
    }
}

/// Time within a step at which a pair comes too near.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    /// Share of the step.
    pub share: f64,
    /// Whether it enters the range of its repulsion there.
    pub enters: bool,
}

/// Motion of all vertices in a step.
#[derive(Debug, Default)]
pub(super) struct Motion {
    /// Times of its beginning and its end (s).
    pub times: [f64; 2],
    /// Positions at its beginning (m).
    pub x0: Vec<Vector3<f64>>,
    /// Displacements.
    pub moves: Field,
    /// Velocities at its beginning, if friction acts or bodies are rigid or elastic.
    pub v0: Field,
    /// Velocities at its end.
    pub v: Field,
    /// Inverse masses (1/kg): 0 for vertices that are kinematic or belong to rigid bodies.
    pub inverse_masses: Vec<f64>,
    /// Rigid bodies.
    pub solids: Vec<Solid>,
    /// Angular velocity of each obstacle at the end (rad/s), if there are rigid bodies.
    pub spins: Vec<Vector3<f64>>,
    /// Courses in the step, if bodies are rigid or elastic.
    pub flight: Flight,
    /// Impulses of the safeguard.
    pub impulses: Impulses,
    ends: Vec<Vector3<f64>>,
    /// Number of planes beyond the usual number.
    planes: AtomicUsize,
}

impl Motion {
    /// Updates `candidates` so that it contains every pair that may touch.
    pub fn cover(&mut self, surface: &Surface, candidates: &mut Candidates) {
        self.ends.clear();
        let ends = self.x0.iter().zip(&self.moves.points).map(|(x, move_)| x + move_);
        self.ends.extend(ends);
        let stretch = Stretch { times: self.times, ends: [&self.x0, &self.ends], speeds: None };
        candidates.cover(surface, &stretch);
    }

    /// Returns the positions at the end of the step (m), as of the last call of
    /// [`cover`](Self::cover).
    pub fn ends(&self) -> &[Vector3<f64>] {
        &self.ends
    }

    /// Reads the rigid bodies of a surface in a step between two states, and adds their turns to
    /// the displacements and velocities, which those of the vertices are in already.
    pub fn read_solids(&mut self, surface: &Surface, states: [&[f64]; 2]) {
        for field in [&mut self.moves, &mut self.v, &mut self.v0] {
            field.forget_solids();
        }
        self.solids.clear();
        let first = 6 * surface.particles();
        for (k, body) in surface.rigid().iter().enumerate() {
            let numbers = first + ROTATION * k..first + ROTATION * (k + 1);
            let ends = states.map(|y| Rotation::read(&y[numbers.clone()]));
            let inverse_mass = self.inverse_masses[body.center()];
            let (solid, way, [before, after]) = Solid::new(body, inverse_mass, ends);
            self.solids.push(solid);
            self.moves.add_solid(way);
            self.v0.add_solid(before);
            self.v.add_solid(after);
        }
    }

    /// Returns the velocity of vertex i at a share of the step (m/s).
    pub fn velocity(&self, i: usize, share: f64) -> Vector3<f64> {
        self.flight.velocity(i, share, self.v[i])
    }

    /// Returns the positions of the points of a pair at the share of the step of a hit (m): on
    /// straight lines or on their courses, as [`impact`](Self::impact) looks at them.
    pub fn places(&self, pair: &Candidate, law: &Law, hit: Hit) -> [Vector3<f64>; 4] {
        let share = hit.share;
        pair.points.map(|i| {
            let i = i as usize;
            if law.skin.restitution > 0.0 || hit.enters {
                let end = [self.x0[i] + self.moves[i], self.v[i]];
                self.flight.position(i, share, end)
            } else {
                self.x0[i] + self.moves[i] * share
            }
        })
    }

    /// Returns the angular momentum (kg m2/s) at the end of the step of the parts that a pair
    /// moves, if a side is a rigid body and no vertex is kinematic.
    pub fn turning(&self, surface: &Surface, pair: &Candidate) -> Option<Vector3<f64>> {
        let bodies = pair.points.map(|i| surface.solid(i));
        let first = bodies.into_iter().flatten().next()?;
        let about = self.x0[self.solids[first].center];
        let mut sum = Vector3::zeros();
        for (number, (i, body)) in pair.points.into_iter().zip(bodies).enumerate() {
            if self.is_kinematic(surface, i) {
                return None;
            }
            // A body counts once, with all its points.
            if body.is_some() && bodies[..number].contains(&body) {
                continue;
            }
            let i = body.map_or(i as usize, |k| self.solids[k].center);
            let state = (self.x0[i] + self.moves[i], self.v[i]);
            sum += match body {
                Some(k) => self.solids[k].turning(state, self.v.turns[k], about),
                None => (state.0 - about).cross(&(state.1 / self.inverse_masses[i])),
            };
        }
        Some(sum)
    }

    /// Moves the points of rigid body k to their places by its rotation at the end of the step:
    /// impulses move them perpendicular to their levers, which is right to first order only.
    pub fn rotate_points(&mut self, k: usize) {
        self.solids[k].rotate_points(k, &self.x0, &mut self.moves);
    }

    /// Returns whether vertex i of a surface is kinematic, so that contact does not move it.
    pub fn is_kinematic(&self, surface: &Surface, i: u32) -> bool {
        match surface.solid(i) {
            Some(k) => self.solids[k].is_kinematic(),
            None => self.inverse_masses[i as usize] == 0.0,
        }
    }

    /// Finds the share of the step at which a pair comes too near, if it does. An elastic pair does
    /// so on its course, so that its energy is right there.
    pub fn impact(&self, surface: &Surface, candidate: &Candidate) -> Option<Hit> {
        let law = surface.law(candidate.kind, &candidate.points);
        let x = candidate.of(&self.x0);
        let on_course = law.skin.restitution > 0.0;
        let kept = || Self::kept(surface, candidate, &x);
        let share = self.arrives(candidate, &law, (2.0 * law.max_kept(), on_course), kept)?;
        Some(Hit { share, enters: false })
    }

    /// Finds the share of the step at which a pair that begins beyond the range of its repulsion
    /// enters it on its course, if it does.
    pub fn entry(&self, surface: &Surface, candidate: &Candidate) -> Option<Hit> {
        let law = surface.law(candidate.kind, &candidate.points);
        if !law.is_dull {
            return None;
        }
        let range = law.range();
        let begun = closest(candidate.kind, &candidate.of(&self.x0)).apart(candidate.kind);
        let is_beyond = begun.is_some_and(|(begun, _)| begun >= range - surface.rounding());
        let share = self.arrives(candidate, &law, (range, is_beyond), || range);
        let share = share.filter(|_| is_beyond)?;
        Some(Hit { share, enters: true })
    }

    /// Finds the share of the step at which a pair comes as near as `kept` (m), in straight lines
    /// or on its course, if it does: not if it is farther apart than `apart` (m).
    fn arrives(
        &self,
        candidate: &Candidate,
        law: &Law,
        (apart, on_course): (f64, bool),
        kept: impl Fn() -> f64,
    ) -> Option<f64> {
        let (x, moves) = (candidate.of(&self.x0), candidate.of(&self.moves));
        if are_apart(candidate.kind, &x, &moves, apart) {
            return None;
        }
        let kept = kept();
        let share = self.first_impact(candidate.kind, [&x, &moves], law.radius, kept)?;
        if on_course { self.arrival(candidate, share, kept) } else { Some(share) }
    }

    /// Finds the share of the step at which a pair that would touch at another share, if it moved
    /// in straight lines, comes as near as `kept` (m) on its course, if it does.
    fn arrival(&self, pair: &Candidate, share: f64, kept: f64) -> Option<f64> {
        let (x0, moves) = (pair.of(&self.x0), pair.of(&self.moves));
        let at = std::array::from_fn(|k| x0[k] + moves[k] * share);
        let ends = std::array::from_fn(|k| x0[k] + moves[k]);
        let Closest { weights, offset } = closest(pair.kind, &at);
        let normal = offset.normalize();
        let along = |vector: &dyn Fn(usize) -> Vector3<f64>| {
            normal.dot(&weighted(&weights, &pair.points.map(|i| vector(i as usize))))
        };
        let end = normal.dot(&weighted(&weights, &ends));
        let rate = along(&|i| self.v[i]);
        let since = pair.points.map(|i| self.flight.since[i as usize]);
        let since = since.into_iter().fold(0.0, f64::max);
        let found = self.flight.arrival(along, [end, rate, kept]);
        let is_apart = end > kept && closest(pair.kind, &ends).offset.norm() > kept;
        match found {
            Some(found) if (since..=1.0).contains(&found) => Some(found),
            _ if is_apart => None,
            Some(found) if found < since => Some(since),
            _ => Some(share.max(since)),
        }
    }

    /// Finds the share of the step, after another one, at which a pair comes too near, if it does.
    pub fn impact_after(&self, surface: &Surface, candidate: &Candidate, time: f64) -> Option<f64> {
        let (x, moves) = (candidate.of(&self.x0), candidate.of(&self.moves));
        let at = std::array::from_fn(|k| x[k] + moves[k] * time);
        let rest = moves.map(|u| u * (1.0 - time));
        let law = surface.law(candidate.kind, &candidate.points);
        let kept = Self::kept(surface, candidate, &x);
        let share = self.first_impact(candidate.kind, [&at, &rest], law.radius, kept)?;
        Some(time + (1.0 - time) * share)
    }

    /// Returns the time of impact of a pair, as a share of the motion, and counts its planes.
    /// Several threads may search for impacts.
    fn first_impact(
        &self,
        kind: PairKind,
        [from, moves]: [&[Vector3<f64>; 4]; 2],
        radius: f64,
        kept: f64,
    ) -> Option<f64> {
        let (time, planes) = time_and_planes(kind, from, moves, radius, kept);
        if planes > INCLUDED_PLANES {
            self.planes.fetch_add(planes - INCLUDED_PLANES, Ordering::Relaxed);
        }
        time
    }

    /// Returns the number of planes beyond the usual number since the last call.
    pub fn take_planes(&mut self) -> usize {
        std::mem::take(self.planes.get_mut())
    }

    /// Returns the distance (m) that a pair keeps, which is less than its distance at the
    /// beginning.
    pub fn kept(surface: &Surface, candidate: &Candidate, x: &[Vector3<f64>; 4]) -> f64 {
        let law = surface.law(candidate.kind, &candidate.points);
        law.kept(closest(candidate.kind, x).offset.norm())
    }
}

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
    /// these displacements, before impacts. Velocities of a method with a tolerance are right, and
    /// do not lag: its error is in the displacement.
    pub fn read(&mut self, h: f64, may_lag: bool, [v0, v, moves]: [&Field; 3]) {
        self.h = h;
        let read = |bends: &mut Vec<Bend>, [v0, v, moves]: [&[Vector3<f64>]; 3]| {
            bends.clear();
            bends.extend(v0.iter().zip(v).zip(moves).map(|((v0, v), way)| Bend {
                gain: v - v0,
                lag: if may_lag { way / h - (v0 + v) * 0.5 } else { Vector3::zeros() },
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
        let left = if b > 0.0 { -2.0 * c / (b + root) } else { (root - b) / (2.0 * a) };
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
        flight.read(h, true, [&field(v0), &field(v), &field(way)]);
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
