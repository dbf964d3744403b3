//! Jumps of velocities at one time, by impulses along the rows of the constraints.
//!
//! Velocities v- need not fit the constraints: at the start of a run, where the velocity of a pin
//! jumps, or where a rope tightens. The least impulses p, weighted by the masses, make them fit:
//!
//! ```text
//! v+ = v- + W J^T p,    J v+ = 0            of rods, joints, wires and points
//!                       J v+ = -e J v-      of ropes that tighten, p <= 0
//!                       J v+ <= 0, p <= 0,  p J v+ = 0   of ropes that are taut
//! ```
//!
//! A rope that would have to push gets no impulse (Moreau, *Unilateral contact and dry friction in
//! finite freedom dynamics*, 1988). The end of a joint, C <= 0, is like a rope. Pins have the
//! velocities of their paths, before and after: the impulse on one does the work of its product
//! with the mean of both.

use nalgebra::{Matrix3, Vector3};

use super::constraint::{Constraint, Equation};
use super::joint::Stop;
use super::joints::{found, least};
use super::set::{Constraints, Moved, vector};
use super::solve::{System, Turning};
use crate::error::{ConstraintName, Unmet};

/// Rope that tightens, or joint that reaches an end: the number of the constraint, and the speed
/// (m/s) at which its ends approach afterwards.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Struck {
    pub number: usize,
    pub speed: f64,
}

/// Effect of a jump on a particle or on the rotation of a body.
pub(crate) struct Pushed {
    pub moved: Moved,
    /// Impulse (N s), or angular impulse (N m s), of the constraints.
    pub impulse: Vector3<f64>,
    /// Change of the velocity (m/s); 0 for a pin. Of a body, the change of its angular velocity
    /// (rad/s).
    pub change: Vector3<f64>,
}

/// Returns the effects of the least impulses after which velocities fit the constraints that hold
/// in the state (x, v), and of the ropes that tighten. A rope that tightens holds afterwards if its
/// ends do not approach. `weight` returns the inverse mass (1/kg) of a particle on no body or of
/// the centre of one.
pub(crate) fn jump(
    constraints: &mut Constraints,
    struck: &[Struck],
    weight: impl Fn(usize) -> f64,
    turning: impl Fn(usize) -> Turning,
    state: [&[f64]; 2],
) -> Vec<Pushed> {
    let mut system = System::default();
    constraints.prepare(&mut system, weight, turning);
    let taut = constraints.holds.clone();
    for Struck { number, .. } in struck {
        constraints.holds[*number] = true;
    }
    loop {
        constraints.solve(state, &mut system, |owner, _, _, rate, _| {
            let own = struck.iter().find(|struck| struck.number == owner);
            -rate - own.map_or(0.0, |struck| struck.speed)
        });
        match least(found(constraints, &system)).filter(|(_, tension)| *tension < 0.0) {
            Some((number, _)) => constraints.holds[number] = false,
            None => break,
        }
    }
    // A taut rope that gets no impulse may still pull: its tension decides that afterwards.
    for (number, taut) in taut.into_iter().enumerate() {
        let own = struck.iter().find(|struck| struck.number == number);
        constraints.holds[number] = match own {
            Some(struck) => constraints.holds[number] && struck.speed == 0.0,
            None => taut,
        };
    }
    let mut impulses = vec![Vector3::zeros(); constraints.moved.len()];
    for row in &system.rows {
        row.spread(row.multiplier, &mut impulses);
    }
    effects(constraints, &system, &impulses)
}

/// Returns the numbers of the taut ropes and of the held ends of joints, and the effects of an
/// impulse along the row of each, in the state (x, v). `weight` and `turning` are those of
/// [`jump`].
pub(crate) fn pulls(
    constraints: &Constraints,
    weight: impl Fn(usize) -> f64,
    turning: impl Fn(usize) -> Turning,
    state: [&[f64]; 2],
) -> Vec<(usize, Vec<Pushed>)> {
    let mut system = System::default();
    constraints.prepare(&mut system, weight, turning);
    constraints.build(state, &mut system, None, |_, _, _, _, _| 0.0);
    let rows = system.rows.iter().zip(&constraints.owners);
    let taut = rows.filter(|(row, (owner, _))| {
        constraints.all[*owner].is_one_sided() && constraints.holds[*owner] && !row.is_left_out()
    });
    taut.map(|(row, (owner, _))| {
        let mut impulses = vec![Vector3::zeros(); constraints.moved.len()];
        row.spread(1.0, &mut impulses);
        (*owner, effects(constraints, &system, &impulses))
    })
    .collect()
}

/// Returns the effects of these impulses on all that constraints move, by its place.
fn effects(constraints: &Constraints, system: &System, impulses: &[Vector3<f64>]) -> Vec<Pushed> {
    let all = constraints.moved.iter().zip(impulses).enumerate();
    all.map(|(k, (moved, &impulse))| {
        let change = impulse.component_mul(&system.weights[k]);
        let [impulse, change] = match &system.turnings[k] {
            Some(turning) => [impulse, change].map(|along| turning.rotation * along),
            None => [impulse, change],
        };
        Pushed { moved: *moved, impulse, change }
    })
    .collect()
}

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
        ConstraintName { kind, particle, other }
    }

    /// Returns the error (m) of one of its equations: a rope may be shorter than its length.
    pub(super) fn error(&self, equation: &Equation) -> f64 {
        if self.is_one_sided() { equation.value.max(0.0) } else { equation.value.abs() }
    }

    /// Returns its own length (m), if it has one.
    pub(super) fn length(&self) -> Option<f64> {
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
                worst = Some(Unmet { number, constraint: constraint.name(), share });
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
