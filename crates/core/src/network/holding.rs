//! Constraints of a network: the forces by which they hold its particles, how implicit methods see
//! them, and the nearest state in which all of them are met, if there is one.

use nalgebra::Vector3;

use super::evaluation::{Loads, other_forces, turning};
use super::parts::Network;
use crate::columns::{row, set_row};
use crate::constraints::{Constraint, Moved, Projected, Turning, nearest};
use crate::error::Unmet;
use crate::held::{Held, Joint};
use crate::random::SplitMix;
use crate::rigid::turn;
use crate::rows::Terms;
use crate::system::{Mechanics, ParticleSystem};
use crate::{constraints, rigid};

/// Returns the largest error |C| (m) of the constraints in the state y.
pub(super) fn error(network: &Network, y: &[f64]) -> Option<f64> {
    let x = &y[..3 * network.particles()];
    let rotation = |k| network.rotation(k, y).matrix();
    network.constraints.error(x, rotation)
}

/// Returns the constraint with the largest relative error in the state y, in a scene of that radius
/// (m).
pub(super) fn worst(network: &Network, y: &[f64], radius: f64) -> Option<Unmet> {
    let x = &y[..3 * network.particles()];
    let rotation = |k| network.rotation(k, y).matrix();
    network.constraints.worst(x, rotation, radius)
}

/// Returns whether the constraints in the state (x, v) at time t (s) are nearly singular, as those
/// of a chain that is stretched straight between two pins, where no force can hold it. False for
/// networks with rigid bodies, for which it is not known. Writes the forces to f.
pub(crate) fn is_nearly_singular(
    network: &Network,
    t: f64,
    x: &[f64],
    v: &[f64],
    f: &mut Vec<f64>,
) -> bool {
    if !network.is_constrained() || !network.bodies().is_empty() {
        return false;
    }
    f.resize(x.len(), 0.0);
    other_forces(network, t, x, v, f);
    hold_particles(network, t, [x, v], f)
}

/// Adds the forces of the constraints, if there are any, to the sum of all others, in a network
/// without rigid bodies, whose rotations are not in x and v. Returns whether the constraints are
/// nearly singular.
pub(super) fn hold_particles(network: &Network, t: f64, state: [&[f64]; 2], f: &mut [f64]) -> bool {
    let none = |_, _: &[f64]| unreachable!("there are no bodies");
    network.bodies().is_empty() && hold(network, t, state, none, (f, &mut []))
}

/// Adds the forces (N) of the constraints, if there are any, to the sum of all others, and the
/// torques (N m) of joints. `bodies` returns the rotation of a body and the acceleration of its
/// centre under given forces. Returns whether the constraints are nearly singular.
pub(super) fn hold(
    network: &Network,
    t: f64,
    [x, v]: [&[f64]; 2],
    bodies: impl Fn(usize, &[f64]) -> (Turning, Vector3<f64>),
    (f, torques): (&mut [f64], &mut [f64]),
) -> bool {
    if !network.is_constrained() {
        return false;
    }
    let motion = |i: usize, f: &[f64]| free_motion(network, t, &bodies, i, f);
    network.constraints.add_forces(motion, |k, f| bodies(k, f).0, [x, v], f, torques)
}

/// Returns the inverse mass (1/kg) of particle i, 0 if it is pinned, and its acceleration (m/s2)
/// under the forces f (N). `bodies` is that of [`hold`].
pub(super) fn free_motion(
    network: &Network,
    t: f64,
    bodies: &impl Fn(usize, &[f64]) -> (Turning, Vector3<f64>),
    i: usize,
    f: &[f64],
) -> (f64, Vector3<f64>) {
    let particles = &network.particles;
    let (n, w) = (particles.len(), particles.inverse_masses()[i]);
    let centered = || network.bodies().iter().position(|body| body.center() == i);
    let acceleration = if w == 0.0 {
        let pin = particles.pins_of(i..i + 1).first();
        pin.map_or_else(Vector3::zeros, |pin| pin.at(t).acceleration)
    } else if let Some(k) = centered() {
        bodies(k, f).1
    } else {
        Vector3::new(f[i], f[n + i], f[2 * n + i]) * w
    };
    (w, acceleration)
}

impl Held for Network {
    fn free_forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        other_forces(self, t, x, v, f);
    }

    fn joints(&self, x: &[f64], out: &mut Vec<Joint>) {
        constraints::joints(&self.constraints, x, out);
    }

    fn multipliers(&self, t: f64, state: [&[f64]; 2], f: &[f64], out: &mut [f64]) {
        let none = |_, _: &[f64]| unreachable!("there are no bodies");
        let motion = |i: usize, f: &[f64]| free_motion(self, t, &none, i, f);
        constraints::multipliers(&self.constraints, motion, state, f, out);
    }

    fn project(&self, x: &mut [f64], v: &mut [f64]) {
        constraints::project(&self.constraints, self.inverse_masses(), x, v);
    }
}

/// Largest number of Newton steps of a projection.
const MAX_ITERATIONS: usize = 20;

/// Largest step, over the positions or over 1 rad, that counts as rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Largest number of steps of a search for such a state from farther away.
const MAX_STEPS: usize = 100;

/// Error, as a share, up to which a constraint counts as met in it.
const MET_SHARE: f64 = 1e-9;

/// Error, as a share, above which a constraint cannot be met if no step reduces it.
const UNMET_SHARE: f64 = 1e-6;

/// Largest displacement in a step of that search, over the shortest length of a constraint.
const MAX_DISPLACEMENT: f64 = 0.3;

/// Random displacement, over that length, where the search makes no progress, as on a straight
/// line; also a random turn of bodies (rad).
const JITTER: f64 = 1e-2;

/// Time ahead in which a contradiction is looked for, over the time in which errors decay.
const LOOK_AHEAD: f64 = 0.1;

/// Returns whether there are joints.
pub(super) fn has_joints(network: &Network) -> bool {
    let mut all = network.constraints().iter();
    all.any(|constraint| matches!(constraint, Constraint::Joint(_)))
}

/// Changes the velocities in the state y by the least amount, weighted by the masses, so that all
/// constraints stay met. Ropes and ends of joints hold where they are passed.
pub(crate) fn project_velocities(network: &Network, y: &mut [f64]) {
    push(network, y, (Projected::Velocities, true), ChangeMeasure::Masses);
}

/// Moves the state y by the least distance, weighted by the masses, to where all constraints are
/// met and stay so. With `ends_hold`, as in an impact, ropes and ends of joints hold where they are
/// passed, else where they are taut.
pub(crate) fn project(network: &Network, y: &mut [f64], ends_hold: bool) {
    let size = network.halves(y).0.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    for _ in 0..MAX_ITERATIONS {
        let [moved, turned] =
            push(network, y, (Projected::Places, ends_hold), ChangeMeasure::Masses);
        // Written so that NaN ends the iteration.
        if !(moved > ROUNDING * size || turned > ROUNDING) {
            break;
        }
    }
    push(network, y, (Projected::Velocities, ends_hold), ChangeMeasure::Masses);
}

/// Returns a constraint that cannot be met near the state y at time t (s), or soon after, because
/// it contradicts others or the pins, in a scene of that radius (m).
pub(crate) fn contradiction(network: &Network, t: f64, y: &[f64], radius: f64) -> Option<Unmet> {
    if !network.is_constrained() {
        return None;
    }
    let soon = LOOK_AHEAD / network.constraints.baumgarte_frequency();
    [t, t + soon].into_iter().find_map(|t| {
        let mut y = y.to_vec();
        network.hold(t, &mut y);
        let left = approach(network, &mut y, radius)?;
        shake(network, JITTER * network.constraints.shortest(radius), &mut y);
        approach(network, &mut y, radius).map(|_| left)
    })
}

/// Moves the state y towards places that meet all constraints. Returns the worst constraint if
/// there are none.
fn approach(network: &Network, y: &mut [f64], radius: f64) -> Option<Unmet> {
    let most = MAX_DISPLACEMENT * network.constraints.shortest(radius);
    for _ in 0..MAX_STEPS {
        let worst = network.worst_constraint(y, radius)?;
        if worst.share <= MET_SHARE || worst.share.is_nan() {
            return None;
        }
        push(network, y, (Projected::Places, true), ChangeMeasure::Alike(most));
    }
    let worst = network.worst_constraint(y, radius);
    worst.filter(|worst| worst.share > UNMET_SHARE)
}

/// Moves particles at random by up to `most` (m), and turns bodies.
fn shake(network: &Network, most: f64, y: &mut [f64]) {
    let (n, mut random) = (network.particles(), SplitMix(1));
    let mut by = |most: f64| Vector3::from_fn(|_, _| most * random.between(-1.0, 1.0));
    for i in (0..n).filter(|i| network.particles.inverse_masses()[*i] > 0.0) {
        let moved = row(y, n, i) + by(most);
        set_row(&mut y[..3 * n], n, i, moved);
    }
    for k in 0..network.bodies().len() {
        turn_body(network, k, by(JITTER), Projected::Places, y);
    }
    network.bodies.settle(y);
}

/// Measure of the changes of a step, which are the least.
#[derive(Clone, Copy)]
enum ChangeMeasure {
    /// They are weighted by the masses.
    Masses,
    /// All that moves has the same mass, and moves by no more than that distance (m).
    Alike(f64),
}

/// Changes places or velocities by one step. Returns the largest changes of positions or velocities
/// (m, m/s), and of orientations or angular velocities (rad, rad/s).
fn push(
    network: &Network,
    y: &mut [f64],
    (what, ends_hold): (Projected, bool),
    metric: ChangeMeasure,
) -> [f64; 2] {
    let n = network.particles();
    let none = (vec![0.0; 3 * n], vec![0.0; 3 * network.bodies().len()]);
    let before = y.to_vec();
    let state: [&[f64]; 2] = network.halves(&before).into();
    let loads = Loads { x: state[0], f: &none.0, torques: &none.1 };
    let (masses, inverse_masses) = (network.masses(), network.particles.inverse_masses());
    let scale = |mass: f64| match metric {
        ChangeMeasure::Masses => 1.0,
        ChangeMeasure::Alike(_) => mass,
    };
    let most = match metric {
        ChangeMeasure::Masses => f64::INFINITY,
        ChangeMeasure::Alike(most) => most,
    };
    let weight = |i: usize| inverse_masses[i] * scale(masses[i]);
    let turning = |k: usize| {
        let mut turning = turning(network, k, &before, Terms::KickForces, loads).0;
        turning.inverse_inertia *= scale(masses[network.bodies()[k].center()]);
        turning
    };
    let (mut largest, mut changes) = ([0.0_f64; 2], vec![]);
    let kind = (what, ends_hold);
    nearest(&network.constraints, weight, turning, state, kind, &mut |moved, change| {
        let kind = usize::from(matches!(moved, Moved::Body(_)));
        largest[kind] = largest[kind].max(change.norm());
        changes.push((moved, change));
    });
    let radii = network.bodies().iter().map(rigid::Body::radius);
    let longest = largest[0].max(largest[1] * radii.fold(0.0, f64::max));
    let shortened = (most / longest).min(1.0);
    for (moved, change) in changes {
        let change = change * shortened;
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
    }
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
