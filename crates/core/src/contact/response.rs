//! Changes of velocities by impulses on bodies and particles that constraints hold.
//!
//! A rod or a joint passes an impulse on at once: what it holds gets the least change of its
//! velocities, weighted by the masses, with the impulse that the constraints can follow. So a body
//! on a hinge is struck with the mass that the hinge leaves it, and so is the end of a rod.

use nalgebra::Vector3;

use super::solids::{Arm, Field, Solid};
use crate::rigid::{ROTATION, Rotation};

/// Constraints of a network.
pub(crate) trait Joints {
    /// Returns whether a constraint holds the particle, or the rigid body with that centre.
    fn hold(&self, i: usize) -> bool;

    /// Changes the velocities in the state y, which an impulse alone has given, by the least
    /// amount, weighted by the masses, so that they fit the constraints.
    fn fit(&self, y: &mut [f64]);

    /// Is told of an impulse (N s) that they have passed on, and of its work (J).
    fn note(&self, impulse: f64, work: f64);
}

/// Constraints, with the state at the end of a step.
#[derive(Clone, Copy)]
pub(super) struct Joined<'a> {
    pub joints: &'a dyn Joints,
    pub y: &'a [f64],
}

/// Changes by an impulse of 1 N s in a direction.
pub(super) struct Response {
    direction: Vector3<f64>,
    points: Vec<(usize, Vector3<f64>)>,
    solids: Vec<(usize, [Vector3<f64>; 2])>,
}

impl Response {
    /// Finds the response to an impulse of 1 N s in a direction on the first of two arms, and the
    /// opposite on the second. The points change their velocities by `pushed` (m/s).
    pub fn new<'a>(
        joined: Joined,
        solids: &[Solid],
        direction: Vector3<f64>,
        arms: impl Iterator<Item = &'a Arm>,
        pushed: impl Iterator<Item = (usize, Vector3<f64>)>,
    ) -> Self {
        let mut y = joined.y.to_vec();
        let n = (y.len() - ROTATION * solids.len()) / 6;
        y[3 * n..6 * n].fill(0.0);
        let add = |y: &mut [f64], i: usize, change: Vector3<f64>| {
            for axis in 0..3 {
                y[(3 + axis) * n + i] += change[axis];
            }
        };
        let numbers = |k: usize| 6 * n + ROTATION * k..6 * n + ROTATION * (k + 1);
        let mut momenta = vec![Vector3::zeros(); solids.len()];
        for arm in arms {
            let (k, impulse) = (arm.solid, direction * arm.sign);
            add(&mut y, solids[k].center, impulse * arm.inverse_mass);
            momenta[k] += arm.lever.cross(&impulse);
        }
        for (i, change) in pushed.filter(|(i, _)| *i < n) {
            add(&mut y, i, change);
        }
        for (k, momentum) in momenta.into_iter().enumerate() {
            let q = Rotation::read(&y[numbers(k)]).q;
            Rotation { q, momentum }.write(&mut y[numbers(k)]);
        }
        joined.joints.fit(&mut y);
        let speed = |i: usize| Vector3::from([3, 4, 5].map(|row| y[row * n + i]));
        let on_bodies = |i: usize| {
            let is_of = |solid: &Solid| solid.center == i || solid.points.contains(&i);
            solids.iter().any(is_of)
        };
        let points = (0..n).filter(|i| speed(*i) != Vector3::zeros() && !on_bodies(*i));
        let changed = (0..solids.len()).map(|k| {
            let momentum = Rotation::read(&y[numbers(k)]).momentum;
            (k, [speed(solids[k].center), solids[k].spun(momentum)])
        });
        Self {
            direction,
            points: points.map(|i| (i, speed(i))).collect(),
            solids: changed
                .filter(|(_, it)| *it != [Vector3::zeros(); 2])
                .collect(),
        }
    }

    /// Lists the particles, without those of bodies, whose velocities change.
    pub fn points(&self) -> impl Iterator<Item = u32> {
        self.points.iter().map(|(i, _)| *i as u32)
    }

    /// Changes a field by an impulse (N s), as far as it is in this direction. The points of the
    /// bodies must be settled afterwards.
    pub fn push(&self, impulse: Vector3<f64>, field: &mut Field) {
        let size = self.direction.dot(&impulse);
        for (i, change) in &self.points {
            field[*i] += change * size;
        }
        for (k, change) in &self.solids {
            field.change(*k, change.map(|change| change * size));
        }
    }
}
