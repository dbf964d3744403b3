//! Ropes: |xi - xj| <= L. While a rope is taut, it has a row like that of a rod, whose multiplier
//! is at most 0; a slack rope has none. A rope tightens by an impact (see [`jump`](super::jump)),
//! and slackens where its multiplier would become positive: then it would have to push. The end of
//! a joint, C <= 0, is like a rope: it holds while it would push back, and the joint reaches it by
//! an impact.

use nalgebra::{Matrix3, Vector3};

use super::constraint::{Constraint, SLACK_SHARE};
use super::joint::{JointEquation, Stop};
use super::set::{Constraints, Moved, vector};
use super::solve::System;
use super::turning::Turning;

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
pub(crate) type Turned<'a> = &'a dyn Fn(usize) -> (Matrix3<f64>, Vector3<f64>);

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
        Constraint::Rope {
            i,
            j,
            length,
            restitution,
        } => {
            let (d, w) = (vector(x, i) - vector(x, j), vector(v, i) - vector(v, j));
            (d.norm() - length, d.dot(&w) / d.norm(), restitution)
        }
        Constraint::Stop(Stop { restitution, .. }) => {
            let equation = end_of_joint(constraints, number, [x, v], turned)?;
            (equation.value, equation.rate, restitution)
        }
        _ => return None,
    };
    Some(OneSided {
        number,
        value,
        rate,
        restitution,
    })
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
    all.filter(|own| own.value >= -none && own.rate >= 0.0)
        .collect()
}

/// Returns the numbers of the taut ropes whose ends part, and of the held ends of joints that move
/// past them.
pub(crate) fn parting(constraints: &Constraints, state: [&[f64]; 2], turned: Turned) -> Vec<usize> {
    let parts = |number: &usize| {
        let own = one_sided(constraints, *number, state, turned);
        own.is_some_and(|own| own.rate > 0.0)
    };
    taut(constraints).filter(parts).collect()
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

/// Returns the number of the taut rope with the least tension, and that tension divided by a
/// positive number that is its own: it is negative for a rope that would have to push. `motion`,
/// `turning` and the other forces f (N) are those of [`Constraints::add_forces`].
pub(crate) fn least_tension(
    constraints: &Constraints,
    motion: impl Fn(usize, &[f64]) -> (f64, Vector3<f64>),
    turning: impl Fn(usize, &[f64]) -> Turning,
    state: [&[f64]; 2],
    f: &[f64],
) -> Option<(usize, f64)> {
    constraints.scratch.lend(|system| {
        constraints.find_multipliers(motion, turning, state, f, system);
        least(constraints, system)
    })
}

pub(super) fn least(constraints: &Constraints, system: &System) -> Option<(usize, f64)> {
    let rows = system.rows.iter().zip(&constraints.owners);
    let taut = rows.filter(|(_, (owner, _))| {
        constraints.all[*owner].is_one_sided() && constraints.holds[*owner]
    });
    let tensions = taut.map(|(row, (owner, _))| (*owner, -row.multiplier));
    tensions.min_by(|a, b| a.1.total_cmp(&b.1))
}
