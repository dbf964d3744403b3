//! Ropes of a network: which of them are taut.

use nalgebra::{Matrix3, Vector3};

use super::parts::Network;
use super::rigid;
use crate::constraints::{self, Constraint, OneSided, beyond};

/// Returns whether there are ropes.
pub(crate) fn has_ropes(network: &Network) -> bool {
    network.is_constrained() && constraints::has_ropes(&network.constraints)
}

/// Returns the numbers of the constraints that are taut ropes, in order.
pub(crate) fn taut(network: &Network) -> impl Iterator<Item = usize> {
    constraints::taut(&network.constraints)
}

/// Makes these ropes taut, and all others slack.
pub(crate) fn set_taut(network: &mut Network, taut: &[usize]) {
    constraints::set_all_taut(&mut network.constraints, taut);
}

/// Returns the slack ropes, as their ends and lengths (m).
pub(crate) fn slack(network: &Network) -> impl Iterator<Item = ([usize; 2], f64)> {
    let taut: Vec<_> = taut(network).collect();
    let all = network.constraints().iter().enumerate();
    all.filter_map(move |(number, constraint)| match *constraint {
        Constraint::Rope { i, j, length, .. } if taut.binary_search(&number).is_err() => {
            Some(([i, j], length))
        }
        _ => None,
    })
}

/// Returns the other end and the length (m) of each rope attached to particle i.
pub(crate) fn ropes_of(network: &Network, i: usize) -> impl Iterator<Item = (usize, f64)> {
    network.constraints().iter().filter_map(move |c| match *c {
        Constraint::Rope {
            i: a, j: b, length, ..
        } if a == i || b == i => Some((a + b - i, length)),
        _ => None,
    })
}

/// Decides which ropes are taut in the state y at time t (s): those that pull. Returns the number
/// of evaluations.
pub(crate) fn settle(network: &mut Network, t: f64, y: &[f64], none: f64) -> u64 {
    if !has_ropes(network) {
        return 0;
    }
    let mut all = std::mem::take(&mut network.constraints);
    let turned = |k| turned(network, k, y);
    let state = halves(network, y);
    constraints::loosen(&mut all, state[0], &turned);
    for rope in beyond(&all, state, &turned, none) {
        constraints::set_taut(&mut all, rope.number, true);
    }
    network.constraints = all;
    let mut evaluated = 0;
    while taut(network).next().is_some() {
        evaluated += 1;
        match least_tension(network, t, y) {
            Some((number, tension)) if tension < 0.0 => {
                constraints::set_taut(&mut network.constraints, number, false);
            }
            _ => break,
        }
    }
    evaluated
}

/// Returns the taut rope with the least tension in the state y at time t (s), and a number of the
/// sign of that tension.
pub(crate) fn least_tension(network: &Network, t: f64, y: &[f64]) -> Option<(usize, f64)> {
    rigid::least_tension(network, t, y)
}

/// Returns the ends of joints that are not held in the state y.
pub(crate) fn open_ends(network: &Network, y: &[f64]) -> Vec<OneSided> {
    let turned = |k| turned(network, k, y);
    constraints::open_ends(&network.constraints, halves(network, y), &turned).collect()
}

/// Returns the rotation matrix and the angular velocity (rad/s) of body k in the state y.
pub(super) fn turned(network: &Network, k: usize, y: &[f64]) -> (Matrix3<f64>, Vector3<f64>) {
    let moving = network.bodies()[k].moving(&network.rotation(k, y));
    (moving.rotation, moving.spin)
}

/// Returns the positions and velocities in the state y.
pub(super) fn halves<'a>(network: &Network, y: &'a [f64]) -> [&'a [f64]; 2] {
    network.halves(y).into()
}
