//! Errors of constraints, and whether constraints can be met at all.

use nalgebra::{Matrix3, Vector3};

use super::constraint::{Constraint, Equation};
use super::joint::Stop;
use super::row::Row;
use super::set::{Constraints, Moved, vector};
use super::solve::System;
use crate::error::{ConstraintName, Unmet};
use crate::random::SplitMix;

/// Largest number of Newton steps towards positions that meet all constraints.
const MAX_ITERATIONS: usize = 100;

/// Error, as a share, up to which a constraint counts as met by such positions.
const MET_SHARE: f64 = 1e-9;
/// Error, as a share, above which a constraint cannot be met if no step reduces it.
const UNMET_SHARE: f64 = 1e-6;

/// Largest displacement of Newton's method in one step, over the shortest length of a constraint.
const MAX_DISPLACEMENT: f64 = 0.3;

/// Random displacement, over that length, of particles at a point where Newton's method makes no
/// progress, as on a straight line.
const JITTER: f64 = 1e-2;

impl Constraint {
    /// Returns its name.
    pub(crate) fn name(&self) -> ConstraintName {
        let (kind, particle, other) = match *self {
            Self::Point { particle, .. } => ("point", particle, None),
            Self::Line { particle, .. } => ("line", particle, None),
            Self::Circle { particle, .. } => ("circle", particle, None),
            Self::Sphere { particle, .. } => ("sphere", particle, None),
            Self::Rod { i, j, .. } => ("rod", i, Some(j)),
            Self::Rope { i, j, .. } => ("rope", i, Some(j)),
            Self::Joint(joint) => (joint.kind.name(), joint.first, joint.second),
            Self::Stop(stop) => ("limit", stop.joint.first, stop.joint.second),
        };
        ConstraintName {
            kind,
            particle,
            other,
        }
    }

    /// Returns the error (m) of one of its equations: a rope may be shorter than its length.
    pub(super) fn error(&self, equation: &Equation) -> f64 {
        if self.is_one_sided() {
            equation.value.max(0.0)
        } else {
            equation.value.abs()
        }
    }

    /// Returns its own length (m), if it has one.
    fn length(&self) -> Option<f64> {
        match *self {
            Self::Rod { length, .. } | Self::Rope { length, .. } => Some(length),
            Self::Circle { radius, .. } | Self::Sphere { radius, .. } => Some(radius),
            Self::Point { .. } | Self::Line { .. } => None,
            Self::Joint(joint) | Self::Stop(Stop { joint, .. }) => Some(joint.length),
        }
    }
}

impl Constraints {
    /// Returns the largest error |C| (m) at x. `rotation` returns the rotation matrix of a body.
    pub fn error(&self, x: &[f64], rotation: impl Fn(usize) -> Matrix3<f64>) -> Option<f64> {
        let all = (0..self.all.len()).map(|number| self.error_of(number, x, &rotation));
        all.reduce(f64::max)
    }

    /// Returns the largest error (m) of the constraint of a number at x.
    fn error_of(&self, number: usize, x: &[f64], rotation: impl Fn(usize) -> Matrix3<f64>) -> f64 {
        let (constraint, mut error) = (&self.all[number], 0.0_f64);
        let turned = |place: usize| match self.moved[place] {
            Moved::Body(k) => Some((rotation(k), Vector3::zeros())),
            Moved::Nothing | Moved::Particle(_) => None,
        };
        if let Some(sides) = self.sides(number, [x, x], turned) {
            for k in 0..constraint.joint_equations() {
                let equation = constraint.joint_equation(k, &sides);
                error = error.max(constraint.error(&equation.into()));
            }
            return error;
        }
        constraint.equations(self.relative(number, x), Vector3::zeros(), |equation| {
            error = error.max(constraint.error(&equation));
        });
        error
    }

    /// Returns the constraint with the largest error at x, in a scene of that radius (m).
    /// `rotation` returns the rotation matrix of a body.
    pub fn worst(
        &self,
        x: &[f64],
        rotation: impl Fn(usize) -> Matrix3<f64>,
        radius: f64,
    ) -> Option<Unmet> {
        let mut worst: Option<Unmet> = None;
        for (number, constraint) in self.all.iter().enumerate() {
            let length = constraint.length().unwrap_or(radius);
            let share = self.error_of(number, x, &rotation) / length;
            if worst.is_none_or(|worst| share > worst.share) {
                worst = Some(Unmet {
                    number,
                    constraint: constraint.name(),
                    share,
                });
            }
        }
        worst
    }

    /// Returns a constraint that no positions near x (m) can meet, if there is one; particles
    /// without inverse mass are fixed. Always `None` if constraints hold rigid bodies.
    pub fn contradiction(
        &self,
        inverse_masses: &[f64],
        x: &mut [f64],
        radius: f64,
    ) -> Option<Unmet> {
        if !self.rotations.is_empty() {
            return None;
        }
        let left = self.approach(inverse_masses, x, radius)?;
        let mut random = SplitMix(1);
        let shortest = self.shortest(radius);
        for (k, x) in x.iter_mut().enumerate() {
            if inverse_masses[k % inverse_masses.len()] > 0.0 {
                *x += JITTER * shortest * random.between(-1.0, 1.0);
            }
        }
        self.approach(inverse_masses, x, radius).map(|_| left)
    }

    /// Returns the shortest length of a constraint (m).
    fn shortest(&self, radius: f64) -> f64 {
        let lengths = self.all.iter().map(|c| c.length().unwrap_or(radius));
        lengths.fold(f64::INFINITY, f64::min)
    }

    /// Moves x towards positions that meet all constraints, by Newton's method with the smallest
    /// displacement, weighted by the masses. Returns the worst constraint if that fails.
    fn approach(&self, inverse_masses: &[f64], x: &mut [f64], radius: f64) -> Option<Unmet> {
        let most = MAX_DISPLACEMENT * self.shortest(radius);
        let none = |_| unreachable!("constraints hold no bodies");
        let mut system = System::default();
        for _ in 0..MAX_ITERATIONS {
            let worst = self.worst(x, none, radius)?;
            if worst.share <= MET_SHARE || worst.share.is_nan() {
                return None;
            }
            self.displace(inverse_masses, x, &mut system);
            let (moves, n) = (&system.vectors, inverse_masses.len());
            let longest = moves.iter().map(Vector3::norm).fold(0.0, f64::max);
            let scale = (most / longest).min(1.0);
            for (moved, step) in self.moved.iter().zip(moves) {
                if let Moved::Particle(i) = *moved {
                    for axis in 0..3 {
                        x[axis * n + i] += scale * step[axis];
                    }
                }
            }
        }
        self.worst(x, none, radius)
            .filter(|worst| worst.share > UNMET_SHARE)
    }

    /// Writes the displacements (m) of a step of Newton's method at x to the vectors of the
    /// system.
    fn displace(&self, inverse_masses: &[f64], x: &[f64], system: &mut System) {
        system.clear();
        for moved in &self.moved {
            let weight = match *moved {
                Moved::Particle(i) => inverse_masses[i],
                Moved::Nothing | Moved::Body(_) => 0.0,
            };
            system.weights.push(Vector3::repeat(weight));
            system.vectors.push(Vector3::zeros());
        }
        system.rows.clear();
        for (number, constraint) in self.all.iter().enumerate() {
            let [first, second] = self.ends[number];
            let relative = self.relative(number, x);
            constraint.equations(relative, Vector3::zeros(), |equation| {
                let mut row = Row::default();
                if constraint.error(&equation) > 0.0 || !constraint.is_one_sided() {
                    row.add(first.place, equation.gradient);
                    row.add(second.place, -equation.gradient);
                    row.set_target(-equation.value, &system.weights);
                }
                system.rows.push(row);
            });
        }
        system.solve(|| self.pattern());
        system.spread();
    }

    /// Returns the position of the first particle of a constraint, relative to the second one if it
    /// has one.
    pub(super) fn relative(&self, number: usize, x: &[f64]) -> Vector3<f64> {
        let (first, second) = self.all[number].ends();
        let from = second.map_or_else(Vector3::zeros, |j| vector(x, j));
        vector(x, first) - from
    }
}
