//! Constraints for implicit methods: to second order, with their multipliers, and the projection of
//! a state on what they allow. With rigid bodies, there is the projection alone.
//!
//! Ropes: |xi - xj| <= L. While a rope is taut, it has a row like that of a rod, whose multiplier
//! is at most 0; a slack rope has none. A rope tightens by an impact (see [`jump`](super::jump)),
//! and slackens where its multiplier would become positive: then it would have to push. The end of
//! a joint, C <= 0, is like a rope: it holds while it would push back, and the joint reaches it by
//! an impact.

use nalgebra::{Matrix3, Vector3};

use super::constraint::{Constraint, Projected, SLACK_SHARE};
use super::joint::{JointEquation, Stop};
use super::set::{Constraints, Moved, vector};
use super::solve::{System, Turning};
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
            visit(*moved, turning.map_or(change, |turning| turning.rotation * change));
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
    constraints
        .build(state, system, ends_hold, |_, _, equation, rate, _| target(equation.value, rate));
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

/// Rope or end of a joint in a state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OneSided {
    /// Number of the constraint.
    pub number: usize,
    /// Error (m), negative for a rope that is slack or a joint before its end, and its rate (m/s).
    pub value: f64,
    pub rate: f64,
    pub restitution: f64,
}

/// Function that returns the rotation matrix and the angular velocity (rad/s) of a body.
type Turned<'a> = &'a dyn Fn(usize) -> (Matrix3<f64>, Vector3<f64>);

/// Returns whether there are ropes, or joints that end.
pub(crate) fn has_ropes(constraints: &Constraints) -> bool {
    constraints.all.iter().any(Constraint::is_one_sided)
}

/// Returns the equation of the constraint of a number, if it is the end of a joint.
fn end_of_joint(
    constraints: &Constraints,
    number: usize,
    state: [&[f64]; 2],
    turned: Turned,
) -> Option<JointEquation> {
    let constraint = &constraints.all[number];
    let Constraint::Stop(_) = constraint else {
        return None;
    };
    let of = |place: usize| match constraints.moved[place] {
        Moved::Body(k) => Some(turned(k)),
        Moved::Nothing | Moved::Particle(_) => None,
    };
    let sides = constraints.sides(number, state, of)?;
    Some(constraint.joint_equation(0, &sides))
}

/// Returns the rope or the end of a joint with that number, if it is one.
fn one_sided(
    constraints: &Constraints,
    number: usize,
    [x, v]: [&[f64]; 2],
    turned: Turned,
) -> Option<OneSided> {
    let (value, rate, restitution) = match constraints.all[number] {
        Constraint::Rope { i, j, length, restitution } => {
            let (d, w) = (vector(x, i) - vector(x, j), vector(v, i) - vector(v, j));
            (d.norm() - length, d.dot(&w) / d.norm(), restitution)
        }
        Constraint::Stop(Stop { restitution, .. }) => {
            let equation = end_of_joint(constraints, number, [x, v], turned)?;
            (equation.value, equation.rate, restitution)
        }
        _ => return None,
    };
    Some(OneSided { number, value, rate, restitution })
}

/// Returns the ends of joints that are not held.
pub(crate) fn open_ends(
    constraints: &Constraints,
    state: [&[f64]; 2],
    turned: Turned,
) -> impl Iterator<Item = OneSided> {
    let all = constraints.all.iter().zip(&constraints.holds).enumerate();
    let open = all.filter(|(_, (constraint, holds))| constraint.is_end() && !**holds);
    open.filter_map(move |(number, _)| one_sided(constraints, number, state, turned))
}

/// Returns the slack ropes whose ends are at most `none` (m) closer than their length, and at least
/// at rest relative to one another; and the joints that are as near to an end.
pub(crate) fn beyond(
    constraints: &Constraints,
    state: [&[f64]; 2],
    turned: Turned,
    none: f64,
) -> Vec<OneSided> {
    let open = (0..constraints.all.len()).filter(|number| !constraints.holds[*number]);
    let all = open.filter_map(|number| one_sided(constraints, number, state, turned));
    all.filter(|own| own.value >= -none && own.rate >= 0.0).collect()
}

/// Makes ropes at their length taut, and holds joints that are at an end.
pub(crate) fn hold_at_ends(constraints: &mut Constraints, state: [&[f64]; 2], turned: Turned) {
    for number in 0..constraints.all.len() {
        if let Some(own) = one_sided(constraints, number, state, turned) {
            constraints.holds[number] |= constraints.all[number].is_at_end(own.value);
        }
    }
}

/// Returns the rates (m/s) at which the ends of taut ropes part, and held joints move past their
/// ends, with the numbers of these constraints.
pub(crate) fn rates(
    constraints: &Constraints,
    state: [&[f64]; 2],
    turned: Turned,
) -> Vec<(usize, f64)> {
    let rate = |number| Some((number, one_sided(constraints, number, state, turned)?.rate));
    taut(constraints).filter_map(rate).collect()
}

/// Returns the ropes that are taut, by their numbers, in order.
pub(crate) fn taut(constraints: &Constraints) -> impl Iterator<Item = usize> {
    let all = constraints.all.iter().zip(&constraints.holds).enumerate();
    all.filter(|(_, (constraint, holds))| constraint.is_one_sided() && **holds)
        .map(|(number, _)| number)
}

/// Makes a rope taut, without an impact, or slack.
pub(crate) fn set_taut(constraints: &mut Constraints, number: usize, taut: bool) {
    constraints.holds[number] = taut;
}

/// Slackens the taut ropes that are clearly shorter than their length at x (m), and leaves the ends
/// of joints that are clearly away from them.
pub(crate) fn loosen(constraints: &mut Constraints, x: &[f64], turned: Turned) {
    for number in 0..constraints.all.len() {
        if let Some(equation) = end_of_joint(constraints, number, [x, x], turned) {
            constraints.holds[number] &= !constraints.all[number].is_away(&equation);
        }
    }
    let all = constraints.all.iter().zip(&mut constraints.holds);
    for (constraint, holds) in all {
        if let Constraint::Rope { i, j, length, .. } = *constraint {
            *holds &= (vector(x, i) - vector(x, j)).norm() >= (1.0 - SLACK_SHARE) * length;
        }
    }
}

/// Makes these ropes taut, and all others slack.
pub(crate) fn set_all_taut(constraints: &mut Constraints, taut: &[usize]) {
    let all = constraints.all.iter().zip(&mut constraints.holds);
    for (number, (constraint, holds)) in all.enumerate() {
        *holds = !constraint.is_one_sided() || taut.contains(&number);
    }
}

/// Lists the numbers of the taut ropes and of the held ends of joints, and the tension of each,
/// divided by a positive number that is its own: it is negative for a rope that would have to push.
/// `motion`, `turning` and the other forces f (N) are those of [`Constraints::add_forces`].
pub(crate) fn tensions(
    constraints: &Constraints,
    motion: impl Fn(usize, &[f64]) -> (f64, Vector3<f64>),
    turning: impl Fn(usize, &[f64]) -> Turning,
    state: [&[f64]; 2],
    f: &[f64],
) -> Vec<(usize, f64)> {
    constraints.scratch.lend(|system| {
        constraints.find_multipliers(motion, turning, state, f, system);
        found(constraints, system).collect()
    })
}

/// Lists the tensions of a solved system, as [`tensions`] does.
pub(super) fn found(
    constraints: &Constraints,
    system: &System,
) -> impl Iterator<Item = (usize, f64)> {
    let rows = system.rows.iter().zip(&constraints.owners);
    let taut = rows.filter(|(_, (owner, _))| {
        constraints.all[*owner].is_one_sided() && constraints.holds[*owner]
    });
    taut.map(|(row, (owner, _))| (*owner, -row.multiplier))
}

/// Returns the least of some tensions.
pub(crate) fn least(tensions: impl IntoIterator<Item = (usize, f64)>) -> Option<(usize, f64)> {
    tensions.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))
}
