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

use nalgebra::Vector3;

use super::ropes::least;
use super::set::{Constraints, Moved};
use super::solve::System;
use super::turning::Turning;

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
        match least(constraints, &system).filter(|(_, tension)| *tension < 0.0) {
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
    let all = constraints.moved.iter().zip(impulses).enumerate();
    all.map(|(k, (moved, impulse))| {
        let change = impulse.component_mul(&system.weights[k]);
        let [impulse, change] = match &system.turnings[k] {
            Some(turning) => [impulse, change].map(|along| turning.rotation * along),
            None => [impulse, change],
        };
        Pushed {
            moved: *moved,
            impulse,
            change,
        }
    })
    .collect()
}
