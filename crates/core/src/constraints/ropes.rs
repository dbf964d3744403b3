//! Ropes: |xi - xj| <= L. While a rope is taut, it has a row like that of a rod, whose multiplier
//! is at most 0; a slack rope has none. A rope tightens by an impact, J v+ = -e J v- for the rate
//! of its length J v, and slackens where its multiplier would become positive: then it would have
//! to push. In an impact, rods and ropes that are already taut keep their lengths, and a rope that
//! would have to push slackens (Moreau, *Unilateral contact and dry friction in finite freedom
//! dynamics*, 1988). The end of a joint, C <= 0, is like a rope: it holds while it would push back,
//! and the joint reaches it by an impact.

use nalgebra::{Matrix3, Vector3};

use super::constraint::{Constraint, SLACK_SHARE};
use super::joint::JointEquation;
use super::set::{Constraints, Moved, vector};
use super::solve::System;
use super::turning::Turning;

/// Rope that is as long as it can be, and whose ends part; or a joint at its end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretched {
    /// Number of the constraint.
    pub number: usize,
    /// Rate of its length, or of its error (m/s).
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

/// Returns the number, the error (m) and its rate (m/s) of each end of a joint that is not held.
pub(crate) fn open_ends(
    constraints: &Constraints,
    state: [&[f64]; 2],
    turned: Turned,
) -> impl Iterator<Item = (usize, f64, f64)> {
    let open = (0..constraints.all.len()).filter(|number| !constraints.holds[*number]);
    open.filter_map(move |number| {
        let equation = end_of_joint(constraints, number, state, turned)?;
        Some((number, equation.value, equation.rate))
    })
}

/// Returns the slack ropes whose ends are at most `none` (m) closer than their length, and at least
/// at rest relative to one another; and the joints that are as near to an end.
pub(crate) fn beyond(
    constraints: &Constraints,
    state: [&[f64]; 2],
    turned: Turned,
    none: f64,
) -> Vec<Stretched> {
    let [x, v] = state;
    let ends = open_ends(constraints, state, turned);
    let reached = ends.filter(|(_, value, rate)| *value >= -none && *rate >= 0.0);
    let mut all: Vec<_> = reached
        .map(|(number, _, rate)| Stretched {
            number,
            rate,
            restitution: match constraints.all[number] {
                Constraint::Stop(stop) => stop.restitution,
                _ => 0.0,
            },
        })
        .collect();
    for (number, (constraint, holds)) in constraints.all.iter().zip(&constraints.holds).enumerate()
    {
        let Constraint::Rope {
            i,
            j,
            length,
            restitution,
        } = *constraint
        else {
            continue;
        };
        let (d, w) = (vector(x, i) - vector(x, j), vector(v, i) - vector(v, j));
        let (distance, rate) = (d.norm(), d.dot(&w) / d.norm());
        if !holds && distance >= length - none && rate >= 0.0 {
            all.push(Stretched {
                number,
                rate,
                restitution,
            });
        }
    }
    all.sort_by_key(|stretched| stretched.number);
    all
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

/// Applies the impact of ropes that tighten, each given by its number and the speed (m/s) at which
/// its ends approach afterwards: it stays taut if that is 0. `weight` returns the inverse mass
/// (1/kg) of a particle on no body or of the centre of one. Velocities are changed by `push`: that
/// of a particle (m/s), or the angular momentum of a body (kg m2/s).
pub(crate) fn strike(
    constraints: &mut Constraints,
    ropes: &[(usize, f64)],
    weight: impl Fn(usize) -> f64,
    turning: impl Fn(usize) -> Turning,
    state: [&[f64]; 2],
    push: &mut dyn FnMut(Moved, Vector3<f64>),
) {
    let mut system = System::default();
    constraints.prepare(&mut system, weight, turning);
    for (number, _) in ropes {
        constraints.holds[*number] = true;
    }
    loop {
        constraints.solve(state, &mut system, |owner, _, _, rate, _| {
            let struck = ropes.iter().find(|(number, _)| *number == owner);
            struck.map_or(0.0, |(_, speed)| -rate - speed)
        });
        match least(constraints, &system).filter(|(_, tension)| *tension < 0.0) {
            Some((number, _)) => constraints.holds[number] = false,
            None => break,
        }
    }
    let mut impulses = vec![Vector3::zeros(); constraints.moved.len()];
    for row in &system.rows {
        row.spread(row.multiplier, &mut impulses);
    }
    for (k, moved) in constraints.moved.iter().enumerate() {
        let impulse = impulses[k];
        push(
            *moved,
            match &system.turnings[k] {
                Some(turning) => turning.rotation * impulse,
                None => impulse.component_mul(&system.weights[k]),
            },
        );
    }
    for (number, _) in ropes.iter().filter(|(_, speed)| *speed > 0.0) {
        constraints.holds[*number] = false;
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

fn least(constraints: &Constraints, system: &System) -> Option<(usize, f64)> {
    let rows = system.rows.iter().zip(&constraints.owners);
    let taut = rows.filter(|(_, (owner, _))| {
        constraints.all[*owner].is_one_sided() && constraints.holds[*owner]
    });
    let tensions = taut.map(|(row, (owner, _))| (*owner, -row.multiplier));
    tensions.min_by(|a, b| a.1.total_cmp(&b.1))
}
