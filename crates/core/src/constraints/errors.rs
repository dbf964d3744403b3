//! Errors of constraints.

use nalgebra::{Matrix3, Vector3};

use super::constraint::{Constraint, Equation};
use super::joint::Stop;
use super::set::{Constraints, Moved, vector};
use crate::error::{ConstraintName, Unmet};

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

    /// Returns the shortest length of a constraint (m), in a scene of that radius (m).
    pub fn shortest(&self, radius: f64) -> f64 {
        let lengths = self.all.iter().map(|c| c.length().unwrap_or(radius));
        lengths.fold(f64::INFINITY, f64::min)
    }

    /// Returns the position of the first particle of a constraint, relative to the second one if it
    /// has one.
    pub(super) fn relative(&self, number: usize, x: &[f64]) -> Vector3<f64> {
        let (first, second) = self.all[number].ends();
        let from = second.map_or_else(Vector3::zeros, |j| vector(x, j));
        vector(x, first) - from
    }
}
