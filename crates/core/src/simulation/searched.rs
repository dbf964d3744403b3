//! A step that is searched for events, and its polynomial.

use nalgebra::Vector3;

use super::depths::Depths;
use crate::contact::{Course, Obstacle};
use crate::network::Network;

/// Largest number of Newton steps, from the time on a piece's cubic to that on the polynomial.
const NEWTON_STEPS: usize = 8;

/// Kind of an event.
#[derive(Clone, Copy, Debug)]
pub(super) enum EventKind {
    /// A particle touches an obstacle, or reaches an outflow: their numbers. Outflows follow all
    /// obstacles.
    Touch { particle: usize, body: usize },
    /// A particle that rests on an obstacle sank deeper into it than allowed.
    Sunk,
    /// A particle ceases to stick or slide on an obstacle as it did, or a rope slackens.
    Rested,
    /// A spring between these ends reaches the length (m) at which it breaks, or a rope its own.
    Stretch { ends: [usize; 2], longest: f64 },
}

/// Step that is searched for events, between two times and states.
pub(super) struct Searched<'a> {
    pub network: &'a Network,
    /// Outflows of the fluid, as obstacles.
    pub outflows: &'a [Obstacle],
    pub t: f64,
    pub h: f64,
    pub ends: [&'a [f64]; 2],
    pub depths: Depths,
}

/// Writes the state at a share of the step to the slice.
pub(super) type StateAt<'a> = &'a mut dyn FnMut(f64, &mut [f64]);

impl Searched<'_> {
    /// Returns the obstacle of that number, or the outflow that follows all obstacles.
    pub fn body(&self, k: usize) -> &Obstacle {
        let obstacles = self.network.obstacles();
        let outflow = || &self.outflows[k - obstacles.len()];
        obstacles.get(k).unwrap_or_else(outflow)
    }

    /// Returns whether a particle ends the step inside its obstacle, but within the tolerance and
    /// on the side with that normal: then it is moved to the surface at the end, without an event.
    /// Where it may rebound, it has the impact at the touch.
    pub fn ends_shallow(&self, [particle, body]: [usize; 2], normal: &Vector3<f64>) -> bool {
        let obstacle = self.body(body);
        if obstacle.restitution > 0.0 {
            return false;
        }
        let (pose, n) = (obstacle.at(self.t + self.h), self.network.particles());
        let x = course(&self.ends, particle, self.h, n).x[1];
        let end = obstacle
            .shape
            .separation(pose.inwards(x - pose.place.position));
        let shallow = self
            .depths
            .shallow
            .min(0.25 * obstacle.shape.greatest_depth());
        (-shallow..=0.0).contains(&end.distance) && end.normal.dot(normal) > 0.5
    }

    /// Finds the share of the step at which an event happens on the polynomial, by Newton's method
    /// from a guess; `None` if it does not happen. Leaves the state near it in `state`.
    pub fn refine(
        &self,
        guess: f64,
        kind: EventKind,
        state: &mut [f64],
        state_at: StateAt,
    ) -> Option<f64> {
        let mut share = guess;
        let mut gap = f64::INFINITY;
        for _ in 0..NEWTON_STEPS {
            state_at(share, state);
            let (found, rate) = self.gap(share, kind, state);
            let next = share - found / (rate * self.h);
            if found.abs() >= gap.abs() || !(0.0..=1.0).contains(&next) {
                gap = found;
                break;
            }
            gap = found;
            if (next - share).abs() <= f64::EPSILON {
                break;
            }
            share = next;
        }
        (gap.abs() <= self.depths.none).then_some(share)
    }

    /// Returns the distance (m) from an event at a share of the step, and the rate of that distance
    /// (m/s).
    fn gap(&self, share: f64, kind: EventKind, y: &[f64]) -> (f64, f64) {
        let n = self.network.particles();
        let row = |first: usize, i: usize| {
            Vector3::new(y[first + i], y[first + n + i], y[first + 2 * n + i])
        };
        match kind {
            EventKind::Touch { particle, body } => {
                let obstacle = self.body(body);
                let pose = obstacle.at(self.t + share * self.h);
                let d = row(0, particle) - pose.place.position;
                let seen = obstacle.shape.separation(pose.inwards(d));
                let normal = pose.outwards(seen.normal);
                let spin = pose.orientation.map(|turned| turned.spin.cross(&d));
                let own = pose.place.velocity + spin.unwrap_or_default();
                (seen.distance, normal.dot(&(row(3 * n, particle) - own)))
            }
            EventKind::Stretch {
                ends: [i, j],
                longest,
            } => {
                let (d, v) = (row(0, j) - row(0, i), row(3 * n, j) - row(3 * n, i));
                (longest - d.norm(), -d.dot(&v) / d.norm())
            }
            EventKind::Sunk | EventKind::Rested => (0.0, 0.0),
        }
    }
}

/// Returns the course of particle i between two states.
pub(super) fn course<Y: AsRef<[f64]>>(ends: &[Y; 2], i: usize, h: f64, n: usize) -> Course {
    let row = |y: &[f64], first: usize| {
        Vector3::new(y[first + i], y[first + n + i], y[first + 2 * n + i])
    };
    Course {
        x: [0, 1].map(|k| row(ends[k].as_ref(), 0)),
        v: [0, 1].map(|k| row(ends[k].as_ref(), 3 * n)),
        h,
    }
}
