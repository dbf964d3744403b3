//! Constraints for implicit methods: to second order, with their multipliers, and the projection of
//! a state on what they allow. With rigid bodies, there is the projection alone.

use nalgebra::{Matrix3, Vector3};

use super::constraint::{Constraint, Projected};
use super::set::{Constraints, Moved};
use super::solve::System;
use super::turning::Turning;
use crate::held::Joint;

/// Largest number of Newton steps of a projection.
const MAX_ITERATIONS: usize = 20;

/// Longest step, over the positions, that counts as rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Replaces `out` by the constraints at x.
pub(crate) fn joints(constraints: &Constraints, x: &[f64], out: &mut Vec<Joint>) {
    out.clear();
    for (k, (constraint, holds)) in constraints.all.iter().zip(&constraints.holds).enumerate() {
        let (i, other) = constraint.ends();
        let mut joint = Joint {
            ends: [i, other.unwrap_or(i)],
            count: 0,
            gradients: [Vector3::zeros(); 3],
            values: [0.0; 3],
            curvature: Matrix3::zeros(),
        };
        let relative = constraints.relative(k, x);
        constraint.equations(relative, Vector3::zeros(), |equation| {
            if *holds && !constraint.is_slack(&equation) {
                joint.gradients[joint.count] = equation.gradient;
                joint.values[joint.count] = equation.value;
                joint.count += 1;
                if let Some(distance) = constraint.distance(&equation) {
                    joint.curvature = curvature(constraint, equation.gradient, distance);
                }
            }
        });
        out.push(joint);
    }
}

/// Writes the multipliers (N), three for each constraint. The other arguments are those of
/// [`Constraints::add_forces`].
pub(crate) fn multipliers(
    constraints: &Constraints,
    motion: impl Fn(usize, &[f64]) -> (f64, Vector3<f64>),
    state: [&[f64]; 2],
    f: &[f64],
    out: &mut [f64],
) {
    let turning = |_, _: &[f64]| -> Turning { unreachable!("there are no bodies") };
    constraints.scratch.lend(|system| {
        constraints.find_multipliers(motion, turning, state, f, system);
        out.fill(0.0);
        for (row, (owner, number)) in system.rows.iter().zip(&constraints.owners) {
            out[3 * owner + number] = row.unscaled();
        }
    });
}

/// Moves x to where all constraints are met, and v to where they stay so, each by the least
/// distance, weighted by the masses. None of them holds a rigid body.
pub(crate) fn project(
    constraints: &Constraints,
    inverse_masses: &[f64],
    x: &mut [f64],
    v: &mut [f64],
) {
    let size = x.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let weight = |i: usize| inverse_masses[i];
    let none = |_| -> Turning { unreachable!("there are no bodies") };
    constraints.scratch.lend(|system| {
        for _ in 0..MAX_ITERATIONS {
            let state = [&*x, &*v];
            push(constraints, weight, none, state, (system, None), |c, _| -c);
            spread(constraints, system, x);
            let longest = system.vectors.iter().map(Vector3::norm).fold(0.0, f64::max);
            if longest.is_nan() || longest <= ROUNDING * size {
                break;
            }
        }
        let state = [&*x, &*v];
        let to = (&mut *system, None);
        push(constraints, weight, none, state, to, |_, rate| -rate);
        spread(constraints, system, v);
    });
}

/// Visits the least changes, weighted by the masses, of all that the constraints move, in the
/// world: a step of Newton's method towards a state that meets them. `weight` returns the inverse
/// mass (1/kg) of a particle on no body or of the centre of one. With `ends_hold`, ropes and ends
/// of joints hold where they are passed.
pub(crate) fn nearest(
    constraints: &Constraints,
    weight: impl Fn(usize) -> f64,
    turning: impl Fn(usize) -> Turning,
    state: [&[f64]; 2],
    (what, ends_hold): (Projected, bool),
    visit: &mut dyn FnMut(Moved, Vector3<f64>),
) {
    constraints.scratch.lend(|system| {
        let target = |error: f64, rate: f64| match what {
            Projected::Places => -error,
            Projected::Velocities => -rate,
        };
        let ends_hold = ends_hold.then_some(what);
        let to = (&mut *system, ends_hold);
        push(constraints, weight, turning, state, to, target);
        for (k, moved) in constraints.moved.iter().enumerate() {
            let change = system.vectors[k];
            let turning = system.turnings[k].as_ref();
            visit(
                *moved,
                turning.map_or(change, |turning| turning.rotation * change),
            );
        }
    });
}

/// Writes the least changes of all that moves that have the effect on each equation that `target`
/// returns for its error and its rate of change, to the vectors of the system. Ends of joints that
/// are passed hold in a projection of that kind, if one is given.
fn push(
    constraints: &Constraints,
    weight: impl Fn(usize) -> f64,
    turning: impl Fn(usize) -> Turning,
    state: [&[f64]; 2],
    (system, ends_hold): (&mut System, Option<Projected>),
    target: impl Fn(f64, f64) -> f64 + Sync,
) {
    constraints.prepare(system, weight, turning);
    constraints.build(state, system, ends_hold, |_, _, equation, rate, _| {
        target(equation.value, rate)
    });
    system.solve_exactly(|| constraints.pattern());
    system.spread();
}

/// Adds the vectors of the system to the rows of the particles in `out`, n x 3.
fn spread(constraints: &Constraints, system: &System, out: &mut [f64]) {
    let n = out.len() / 3;
    for (moved, change) in constraints.moved.iter().zip(&system.vectors) {
        if let Moved::Particle(i) = *moved {
            for axis in 0..3 {
                out[axis * n + i] += change[axis];
            }
        }
    }
}

/// Returns the second derivative (1/m) of the last equation of a constraint at a distance from its
/// centre, or between its ends, along a unit vector.
fn curvature(constraint: &Constraint, outwards: Vector3<f64>, distance: f64) -> Matrix3<f64> {
    let mut within = Matrix3::identity() - outwards * outwards.transpose();
    if let Constraint::Circle { normal, .. } = constraint {
        within -= normal * normal.transpose();
    }
    within / distance
}
