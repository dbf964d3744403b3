//! Ropes of a network: which of them are taut, and the impacts by which they tighten.

use nalgebra::{Matrix3, Vector3};

use super::loads::{self, Loads};
use super::parts::Network;
use super::rigid;
use crate::columns::{row, set_row};
use crate::constraints::{self, Constraint, Moved, beyond};
use crate::rows::Terms;
use crate::system::{Mechanics, ParticleSystem};

/// Largest number of impacts at one time: an impact may tighten further ropes.
const MAX_IMPACTS: usize = 100;

/// Largest number of impacts at one time with rebounds, which may follow one another without end.
const MAX_REBOUNDS: usize = 10;

/// Half of the interval of the difference quotient for the acceleration past an end of a joint (s).
const HALF_MOMENT: f64 = 1e-7;

/// Conditions for a rebound: heights (m) and times (s) that are too small for one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Least {
    /// Distance from its length that counts as zero.
    pub none: f64,
    /// Change of length up to which a rebound is left out.
    pub height: f64,
    /// Time up to which a rebound is left out.
    pub time: f64,
    /// Whether there are rebounds at all.
    pub rebounds: bool,
}

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

/// Applies the impacts of the ropes that tighten in the state y at time t (s). Returns whether
/// there were any.
pub(crate) fn tighten(network: &mut Network, t: f64, y: &mut [f64], least: Least) -> bool {
    let mut struck = false;
    for number in 0..MAX_IMPACTS {
        let may_rebound = least.rebounds && number < MAX_REBOUNDS;
        let turned = |k| turned(network, k, y);
        let state = halves(network, y);
        let mut ropes = beyond(&network.constraints, state, &turned, least.none);
        ropes.retain(|rope| rope.rate > 0.0);
        if ropes.is_empty() {
            break;
        }
        struck = true;
        let mut rates = vec![];
        if may_rebound && ropes.iter().any(|rope| rope.restitution > 0.0) {
            rates.resize(y.len(), 0.0);
            network.eval_f(t, y, &mut rates);
        }
        let speeds = ropes.iter().map(|rope| {
            let speed = rope.restitution * rope.rate;
            let rebounds = may_rebound && speed > 0.0 && {
                let press = parting(network, rope.number, y, &rates);
                speed * speed > 2.0 * press * least.height && 2.0 * speed > press * least.time
            };
            (rope.number, if rebounds { speed } else { 0.0 })
        });
        let speeds: Vec<_> = speeds.collect();
        strike(network, t, y, &speeds);
    }
    struck
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

/// Applies the impact of ropes, each with the speed (m/s) at which its ends approach afterwards.
fn strike(network: &mut Network, t: f64, y: &mut [f64], ropes: &[(usize, f64)]) {
    let (n, still) = (network.particles(), vec![0.0; 3 * network.particles()]);
    let before = y.to_vec();
    let (x, v) = network.halves(&before);
    let mut all = std::mem::take(&mut network.constraints);
    let weight = |i: usize| network.inverse_masses()[i];
    let loads = Loads {
        x,
        f: &still,
        torques: &vec![0.0; 3 * network.bodies().len()],
    };
    let turning = |k: usize| loads::turning(network, k, &before, Terms::KickForces, loads).0;
    constraints::strike(
        &mut all,
        ropes,
        weight,
        turning,
        [x, v],
        &mut |moved, push| match moved {
            Moved::Nothing => {}
            Moved::Particle(i) => {
                let v = &mut y[3 * n..6 * n];
                let changed = row(v, n, i) + push;
                set_row(v, n, i, changed);
            }
            Moved::Body(k) => {
                let numbers = network.bodies.numbers(k);
                for (y, push) in y[numbers.end - 3..numbers.end].iter_mut().zip(&push) {
                    *y += push;
                }
            }
        },
    );
    network.constraints = all;
    network.hold(t, y);
}

/// Returns the acceleration (m/s2) at which the ends of a slack rope part, or a joint passes its
/// end, with the rates of change of the state y.
fn parting(network: &Network, number: usize, y: &[f64], rates: &[f64]) -> f64 {
    if let Constraint::Stop(_) = network.constraints()[number] {
        let rate_at = |moment: f64| {
            let state: Vec<_> = y.iter().zip(rates).map(|(y, r)| y + moment * r).collect();
            let ends = open_ends(network, &state);
            let own = ends.iter().find(|(end, ..)| *end == number);
            own.map_or(0.0, |(.., rate)| *rate)
        };
        return (rate_at(HALF_MOMENT) - rate_at(-HALF_MOMENT)) / (2.0 * HALF_MOMENT);
    }
    let (i, j) = network.constraints()[number].ends();
    let (n, j) = (network.particles(), j.unwrap_or(i));
    let between = |a: &[f64]| -> Vector3<f64> { row(a, n, i) - row(a, n, j) };
    let [d, v, a] = [between(y), between(&y[3 * n..]), between(&rates[3 * n..])];
    let along = d / d.norm();
    let across = v - along * along.dot(&v);
    a.dot(&along) + across.norm_squared() / d.norm()
}

/// Returns the ends of joints that are not held in the state y, each with its error (m), negative
/// before the end, and the rate of that (m/s).
pub(crate) fn open_ends(network: &Network, y: &[f64]) -> Vec<(usize, f64, f64)> {
    let turned = |k| turned(network, k, y);
    constraints::open_ends(&network.constraints, halves(network, y), &turned).collect()
}

/// Returns the rotation matrix and the angular velocity (rad/s) of body k in the state y.
fn turned(network: &Network, k: usize, y: &[f64]) -> (Matrix3<f64>, Vector3<f64>) {
    let moving = network.bodies()[k].moving(&network.rotation(k, y));
    (moving.rotation, moving.spin)
}

fn halves<'a>(network: &Network, y: &'a [f64]) -> [&'a [f64]; 2] {
    network.halves(y).into()
}
