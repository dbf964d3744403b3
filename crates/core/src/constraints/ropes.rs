//! Ropes: |xi - xj| <= L. While a rope is taut, it has a row like that of a rod, whose multiplier
//! is at most 0; a slack rope has none. A rope tightens by an impact, J v+ = -e J v- for the rate
//! of its length J v, and slackens where its multiplier would become positive: then it would have
//! to push. In an impact, rods and ropes that are already taut keep their lengths, and a rope that
//! would have to push slackens (Moreau, *Unilateral contact and dry friction in finite freedom
//! dynamics*, 1988).

use nalgebra::Vector3;

use super::constraint::{Constraint, SLACK_SHARE};
use super::set::{Constraints, Moved, vector};
use super::solve::System;
use super::turning::Turning;

/// Rope that is as long as it can be, and whose ends part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretched {
    /// Number of the constraint.
    pub number: usize,
    /// Rate of its length (m/s).
    pub rate: f64,
    pub restitution: f64,
}

/// Whether there are ropes.
pub(crate) fn has_ropes(constraints: &Constraints) -> bool {
    constraints.all.iter().any(Constraint::is_rope)
}

/// Returns the slack ropes whose ends are at most `none` (m) closer than their length, and at least
/// at rest relative to one another.
pub(crate) fn beyond(constraints: &Constraints, [x, v]: [&[f64]; 2], none: f64) -> Vec<Stretched> {
    let mut all = vec![];
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
    all
}

/// Returns the ropes that are taut, by their numbers, in order.
pub(crate) fn taut(constraints: &Constraints) -> impl Iterator<Item = usize> {
    let all = constraints.all.iter().zip(&constraints.holds).enumerate();
    all.filter(|(_, (constraint, holds))| constraint.is_rope() && **holds)
        .map(|(number, _)| number)
}

/// Makes a rope taut, without an impact, or slack.
pub(crate) fn set_taut(constraints: &mut Constraints, number: usize, taut: bool) {
    constraints.holds[number] = taut;
}

/// Slackens the taut ropes that are clearly shorter than their length at x (m).
pub(crate) fn loosen(constraints: &mut Constraints, x: &[f64]) {
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
        *holds = !constraint.is_rope() || taut.contains(&number);
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
    for moved in &constraints.moved {
        let (weight, turning) = match *moved {
            Moved::Nothing => (Vector3::zeros(), None),
            Moved::Particle(i) => (Vector3::repeat(weight(i)), None),
            Moved::Body(k) => {
                let turning = turning(k);
                (turning.inverse_inertia, Some(turning))
            }
        };
        system.weights.push(weight);
        system.vectors.push(Vector3::zeros());
        system.turnings.push(turning);
    }
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
    let taut = rows
        .filter(|(_, (owner, _))| constraints.all[*owner].is_rope() && constraints.holds[*owner]);
    let tensions = taut.map(|(row, (owner, _))| (*owner, -row.multiplier));
    tensions.min_by(|a, b| a.1.total_cmp(&b.1))
}
