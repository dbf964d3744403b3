//! The nearest state in which the joints of rigid bodies, and all other constraints, are met.

use nalgebra::Vector3;

use super::loads::{Loads, turning};
use super::parts::Network;
use crate::columns::{row, set_row};
use crate::constraints::{Constraint, Moved, Projected, nearest};
use crate::rigid::turn;
use crate::rows::Terms;

/// Largest number of Newton steps of a projection.
const MAX_ITERATIONS: usize = 20;

/// Largest step, over the positions or over 1 rad, that counts as rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Returns whether there are joints.
pub(crate) fn has_joints(network: &Network) -> bool {
    let mut all = network.constraints().iter();
    all.any(|constraint| matches!(constraint, Constraint::Joint(_)))
}

/// Changes the velocities in the state y by the least amount, weighted by the masses, so that all
/// constraints stay met, if there are joints.
pub(crate) fn project_velocities(network: &Network, y: &mut [f64]) {
    if has_joints(network) {
        push(network, y, (Projected::Velocities, false));
    }
}

/// Moves the state y by the least distance, weighted by the masses, to where all constraints are
/// met and stay so. `ends_hold` is whether that includes the ends that joints have passed, as in an
/// impact.
pub(crate) fn project(network: &Network, y: &mut [f64], ends_hold: bool) {
    let size = network
        .halves(y)
        .0
        .iter()
        .fold(0.0, |most: f64, x| most.max(x.abs()));
    for _ in 0..MAX_ITERATIONS {
        let [moved, turned] = push(network, y, (Projected::Places, ends_hold));
        // Written so that NaN ends the iteration.
        if !(moved > ROUNDING * size || turned > ROUNDING) {
            break;
        }
    }
    push(network, y, (Projected::Velocities, ends_hold));
}

/// Changes places or velocities by one step. Returns the largest changes of positions or velocities
/// (m, m/s), and of orientations or angular velocities (rad, rad/s).
fn push(network: &Network, y: &mut [f64], (what, ends_hold): (Projected, bool)) -> [f64; 2] {
    let n = network.particles();
    let none = (vec![0.0; 3 * n], vec![0.0; 3 * network.bodies().len()]);
    let before = y.to_vec();
    let state: [&[f64]; 2] = network.halves(&before).into();
    let loads = Loads {
        x: state[0],
        f: &none.0,
        torques: &none.1,
    };
    let weight = |i: usize| network.particles.inverse_masses()[i];
    let turning = |k: usize| turning(network, k, &before, Terms::KickForces, loads).0;
    let mut largest = [0.0_f64; 2];
    let constraints = &network.constraints;
    nearest(
        constraints,
        weight,
        turning,
        state,
        (what, ends_hold),
        &mut |moved, change| {
            let kind = usize::from(matches!(moved, Moved::Body(_)));
            largest[kind] = largest[kind].max(change.norm());
            match moved {
                Moved::Nothing => {}
                Moved::Particle(i) => {
                    let first = if what == Projected::Places { 0 } else { 3 * n };
                    let out = &mut y[first..first + 3 * n];
                    let changed = row(out, n, i) + change;
                    set_row(out, n, i, changed);
                }
                Moved::Body(k) => turn_body(network, k, change, what, y),
            }
        },
    );
    network.bodies.settle(y);
    largest
}

/// Turns body k by a vector (rad), or changes its angular velocity by one (rad/s).
fn turn_body(network: &Network, k: usize, change: Vector3<f64>, what: Projected, y: &mut [f64]) {
    let mut rotation = network.rotation(k, y);
    let body = &network.bodies()[k];
    match what {
        Projected::Places => {
            // The angular velocity stays as it is.
            let spin = body.moving(&rotation).spin;
            rotation.q = turn(change) * rotation.q;
            rotation.momentum = body.momentum(rotation.q, spin);
        }
        Projected::Velocities => rotation.momentum += body.momentum(rotation.q, change),
    }
    network.set_rotation(k, &rotation, y);
}
