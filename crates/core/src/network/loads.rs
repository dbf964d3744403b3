//! Forces and torques on rigid bodies, and the rotation that they cause.

use nalgebra::Vector3;

use super::evaluation::is_split;
use super::parts::Network;
use crate::constraints::Turning;
use crate::rigid::{Body, Rotation};
use crate::rows::Terms;

/// Force (N) and torque about the centre (N m) on a body.
#[derive(Clone, Copy, Default)]
pub(super) struct Wrench {
    pub force: Vector3<f64>,
    pub torque: Vector3<f64>,
}

/// Forces (N) on all particles at x (m), n x 3 each, and torques (N m) on bodies besides those of
/// these forces, three numbers each.
#[derive(Clone, Copy)]
pub(super) struct Loads<'a> {
    pub x: &'a [f64],
    pub f: &'a [f64],
    pub torques: &'a [f64],
}

/// Returns the force and torque on body k, from the forces on its particles and its torques. Drag
/// damps the rotation at the same rate c / m as the motion of the centre.
pub(super) fn wrench(
    network: &Network,
    k: usize,
    rotation: &Rotation,
    terms: Terms,
    Loads { x, f, torques }: Loads,
) -> Wrench {
    let body = &network.bodies()[k];
    let center = row(x, body.center());
    let mut wrench = Wrench {
        force: row(f, body.center()),
        torque: Vector3::from_column_slice(&torques[3 * k..3 * k + 3]),
    };
    for i in body.points() {
        let force = row(f, i);
        wrench.force += force;
        wrench.torque += (row(x, i) - center).cross(&force);
    }
    if !is_split(network, terms) {
        wrench.torque -= rotation.momentum * decay(network, body);
    }
    wrench
}

/// Returns the rotation of body k and acceleration of its centre (m/s2) under these loads in the
/// state y.
pub(super) fn turning(
    network: &Network,
    k: usize,
    y: &[f64],
    terms: Terms,
    loads: Loads,
) -> (Turning, Vector3<f64>) {
    let (body, rotation) = (&network.bodies()[k], network.rotation(k, y));
    let moving = body.moving(&rotation);
    let wrench = wrench(network, k, &rotation, terms, loads);
    let turning = Turning {
        center: row(loads.x, body.center()),
        rotation: moving.rotation,
        spin: moving.spin,
        acceleration: moving.angular_acceleration(&body.inertia(), wrench.torque),
        inverse_inertia: body.inertia().map(|moment| 1.0 / moment),
    };
    (
        turning,
        wrench.force * network.particles.inverse_masses()[body.center()],
    )
}

/// Returns the rate (1/s) at which drag damps the motion of a body.
pub(super) fn decay(network: &Network, body: &Body) -> f64 {
    network.elements.drift_forces().drag / network.masses()[body.center()]
}

/// Returns row i of an n x 3 matrix.
fn row(a: &[f64], i: usize) -> Vector3<f64> {
    let n = a.len() / 3;
    Vector3::new(a[i], a[n + i], a[2 * n + i])
}
