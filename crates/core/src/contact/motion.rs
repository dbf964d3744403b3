//! Motion of all vertices in a step, as the guard changes it, and what it did.

use std::ops::AddAssign;
use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::advance::{are_apart, time_and_planes};
use super::candidates::{Candidates, Stretch};
use super::impulses::Impulses;
use super::listing::Candidate;
use super::rebound::Course;
use super::solids::{Field, Solid};
use super::surface::Surface;
use crate::geometry::{PairKind, closest};
use crate::rigid::{ROTATION, Rotation};

/// Number of planes between a pair that the price of an evaluation includes.
const USUAL: usize = 16;

/// What the guard did in a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Guarded {
    /// Number of impulses.
    pub impulses: usize,
    /// Sum of the magnitudes of the impulses and of friction (N s).
    pub impulse: f64,
    /// Number of vertices whose way was cut.
    pub cuts: usize,
    /// Sum of the magnitudes of the momentum that cuts took (N s).
    pub lost: f64,
    /// Share of the step at which the first impulse was needed; 1 if none was.
    pub first: f64,
    /// Number of planes between pairs that the search for impacts took beyond the usual few.
    pub planes: usize,
}

impl Default for Guarded {
    fn default() -> Self {
        Self {
            impulses: 0,
            impulse: 0.0,
            cuts: 0,
            lost: 0.0,
            first: 1.0,
            planes: 0,
        }
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
    }
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
    /// Velocities at its beginning, where friction acts or bodies are rigid or elastic.
    pub v0: Field,
    /// Velocities at its end.
    pub v: Field,
    /// Inverse masses (1/kg): 0 for vertices that are led or belong to rigid bodies.
    pub inverse_masses: Vec<f64>,
    /// Rigid bodies.
    pub solids: Vec<Solid>,
    /// Impulses that the guard gave.
    pub impulses: Impulses,
    ends: Vec<Vector3<f64>>,
    /// Number of planes beyond the usual ones.
    planes: AtomicUsize,
}

impl Motion {
    /// Makes sure that `candidates` has every pair that may touch.
    pub fn cover(&mut self, surface: &Surface, candidates: &mut Candidates) {
        self.ends.clear();
        let ends = self
            .x0
            .iter()
            .zip(&self.moves.points)
            .map(|(x, move_)| x + move_);
        self.ends.extend(ends);
        let stretch = Stretch {
            times: self.times,
            ends: [&self.x0, &self.ends],
            speeds: None,
        };
        candidates.cover(surface, &stretch);
    }

    /// Reads the rigid bodies of a surface in a step between two states. The displacements and the
    /// velocities, which are those of the vertices already, get the turns of the bodies.
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

    /// Velocity of vertex i at a share of a step of h (s): that of the cubic through both ends.
    pub fn velocity(&self, i: usize, share: f64, h: f64) -> Vector3<f64> {
        Course {
            x: [Vector3::zeros(), self.moves[i]],
            v: [self.v0[i], self.v[i]],
            h,
        }
        .velocity(share)
    }

    /// Angular momentum (kg m2/s), at the end of the step, of what a pair moves, if a side is a
    /// rigid body and nothing is led.
    pub fn turning(&self, surface: &Surface, pair: &Candidate) -> Option<Vector3<f64>> {
        let bodies = pair.points.map(|i| surface.solid(i));
        let first = bodies.into_iter().flatten().next()?;
        let about = self.x0[self.solids[first].center];
        let mut sum = Vector3::zeros();
        for (number, (i, body)) in pair.points.into_iter().zip(bodies).enumerate() {
            if self.is_led(surface, i) {
                return None;
            }
            // The points of a body are its own, and count once.
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

    /// Takes the points of rigid body k to where its rotation has them at the end of the step.
    /// Impulses move them across their levers, which is right to first order.
    pub fn bend(&mut self, k: usize) {
        self.solids[k].bend(k, &self.x0, &mut self.moves);
    }

    /// Whether vertex i of a surface is kinematic: contact does not move it.
    pub fn is_led(&self, surface: &Surface, i: u32) -> bool {
        match surface.solid(i) {
            Some(k) => self.solids[k].is_led(),
            None => self.inverse_masses[i as usize] == 0.0,
        }
    }

    /// Share of the step at which a pair comes too near, if it does.
    pub fn impact(&self, surface: &Surface, candidate: &Candidate) -> Option<f64> {
        let x = candidate.of(&self.x0);
        let moves = candidate.of(&self.moves);
        let law = surface.law(candidate.kind, &candidate.points);
        if are_apart(candidate.kind, &x, &moves, 2.0 * law.most_kept()) {
            return None;
        }
        let kept = Self::kept(surface, candidate, &x);
        self.first_impact(candidate.kind, [&x, &moves], law.radius, kept)
    }

    /// Share of the step, after another one, at which a pair comes too near, if it does.
    pub fn impact_after(&self, surface: &Surface, candidate: &Candidate, time: f64) -> Option<f64> {
        let (x, moves) = (candidate.of(&self.x0), candidate.of(&self.moves));
        let at = std::array::from_fn(|k| x[k] + moves[k] * time);
        let rest = moves.map(|u| u * (1.0 - time));
        let law = surface.law(candidate.kind, &candidate.points);
        let kept = Self::kept(surface, candidate, &x);
        let share = self.first_impact(candidate.kind, [&at, &rest], law.radius, kept)?;
        Some(time + (1.0 - time) * share)
    }

    /// Time of impact of a pair, whose planes are counted. Several threads may look for impacts.
    fn first_impact(
        &self,
        kind: PairKind,
        [from, moves]: [&[Vector3<f64>; 4]; 2],
        radius: f64,
        kept: f64,
    ) -> Option<f64> {
        let (time, planes) = time_and_planes(kind, from, moves, radius, kept);
        if planes > USUAL {
            self.planes.fetch_add(planes - USUAL, Ordering::Relaxed);
        }
        time
    }

    /// Number of planes beyond the usual ones since this was last asked.
    pub fn take_planes(&mut self) -> usize {
        std::mem::take(self.planes.get_mut())
    }

    /// Distance (m) that a pair keeps, less than what it has at the beginning.
    pub fn kept(surface: &Surface, candidate: &Candidate, x: &[Vector3<f64>; 4]) -> f64 {
        let law = surface.law(candidate.kind, &candidate.points);
        law.kept(closest(candidate.kind, x).offset.norm())
    }
}
