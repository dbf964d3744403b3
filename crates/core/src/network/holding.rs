//! Constraints of a network: the forces by which they hold its particles.

use nalgebra::Vector3;

use super::evaluation::other_forces;
use super::parts::Network;
use crate::constraints::Turning;
use crate::error::Unmet;

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
    network
        .constraints
        .add_forces(motion, |k, f| bodies(k, f).0, [x, v], f, torques)
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
