//! A network with rigid bodies as integrators see it, with the state [x | v | q and L of each
//! body].

use std::ops::Range;

use super::evaluation::{Loads, at, decay, is_split, turning, wrench};
use super::holding::{free_motion, has_joints, hold, project};
use super::parts::Network;
use crate::constraints;
use crate::elements::force::DriftForces;
use crate::elements::{Airflow, Finish};
use crate::measure::Measure;
use crate::rigid::{ROTATION, Rotation};
use crate::rows::Terms;
use crate::system::{Mechanics, Rigid, Splitting, place_pins};

/// Evaluates forces in the state y at time t (s) with all points in their places, and calls `run`
/// with the velocities, n x 3, and the forces.
fn with_forces<T>(
    network: &Network,
    t: f64,
    terms: Terms,
    y: &[f64],
    run: impl FnOnce(&[f64], Loads) -> T,
) -> T {
    with_other_forces(network, t, terms, y, |x, v, f, [torques, held]| {
        if !is_split(network, terms) {
            let bodies = |k: usize, f: &[f64]| {
                let torques = &*torques;
                turning(network, k, y, terms, Loads { x, f, torques })
            };
            hold(network, t, [x, v], bodies, (f, held));
            for (sum, torque) in torques.iter_mut().zip(&*held) {
                *sum += torque;
            }
        }
        run(v, Loads { x, f, torques })
    })
}

/// Evaluates all forces except those of constraints, as [`with_forces`]. `run` gets positions,
/// velocities and forces, the torques of motors, and as many zeros.
fn with_other_forces<T>(
    network: &Network,
    t: f64,
    terms: Terms,
    y: &[f64],
    run: impl FnOnce(&[f64], &[f64], &mut [f64], [&mut [f64]; 2]) -> T,
) -> T {
    network.bodies.scratch.lend(|[x, v, f, torques]| {
        let (own_x, own_v) = network.halves(y);
        own_x.clone_into(x);
        own_v.clone_into(v);
        f.resize(x.len(), 0.0);
        network.bodies.place_points(y, x, v);
        let at = at(network, t, x, v);
        network.elements.evaluate(&at, f, &Finish::default());
        if !is_split(network, terms) {
            let DriftForces { gravity, drag } = network.elements.drift_forces();
            let n = network.particles();
            for (k, (f, v)) in f.iter_mut().zip(&*v).enumerate() {
                let mass = network.masses()[k % n];
                *f += mass * gravity[k / n] - if mass > 0.0 { drag * v } else { 0.0 };
            }
        }
        let count = 3 * network.bodies().len();
        torques.clear();
        torques.resize(2 * count, 0.0);
        let (torques, held) = torques.split_at_mut(count);
        network.bodies.drive(y, f, torques);
        for airflow in network.elements.of::<Airflow>() {
            network.bodies.blow(airflow, t, y, f, torques);
        }
        run(x, v, f, [torques, held])
    })
}

/// Lists the tensions of taut ropes in the state y at time t (s); see
/// [`tensions`](crate::constraints::tensions).
pub(super) fn tensions(network: &Network, t: f64, y: &[f64]) -> Vec<(usize, f64)> {
    let terms = Terms::AllForces;
    with_other_forces(network, t, terms, y, |x, v, f, [torques, _]| {
        let torques = &*torques;
        let bodies = |k: usize, f: &[f64]| turning(network, k, y, terms, Loads { x, f, torques });
        let motion = |i: usize, f: &[f64]| free_motion(network, t, &bodies, i, f);
        constraints::tensions(&network.constraints, motion, |k, f| bodies(k, f).0, [x, v], f)
    })
}

/// Writes accelerations (m/s2) of particles that no body carries to a, n x 3.
fn accelerate(network: &Network, f: &[f64], a: &mut [f64]) {
    let n = network.particles();
    for (k, (a, f)) in a.iter_mut().zip(f).enumerate() {
        *a = network.particles.inverse_masses()[k % n] * f;
    }
}

impl Rigid for Network {
    fn length(&self) -> usize {
        6 * self.particles() + ROTATION * self.bodies().len()
    }

    fn rates(&self, t: f64, y: &[f64], dydt: &mut [f64]) {
        let n = self.particles();
        with_forces(self, t, Terms::AllForces, y, |v, loads| {
            let (halves, tail) = dydt.split_at_mut(6 * n);
            let (dx, dv) = halves.split_at_mut(3 * n);
            dx.copy_from_slice(v);
            accelerate(self, loads.f, dv);
            Mechanics::pins(self, t, &mut |i, place| {
                for axis in 0..3 {
                    dx[axis * n + i] = place.velocity[axis];
                    dv[axis * n + i] = place.acceleration[axis];
                }
            });
            for ((k, body, rotation, moving), tail) in
                self.bodies.each(y).zip(tail.chunks_exact_mut(ROTATION))
            {
                let wrench = wrench(self, k, &rotation, Terms::AllForces, loads);
                let (c, w) = (body.center(), self.particles.inverse_masses()[body.center()]);
                for axis in 0..3 {
                    if w > 0.0 {
                        dv[axis * n + c] = w * wrench.force[axis];
                    }
                }
                let rate = Rotation { q: moving.rate(rotation.q), momentum: wrench.torque };
                rate.write(tail);
                let turning = moving.angular_acceleration(&body.inertia(), wrench.torque);
                for (i, anchor) in body.anchors() {
                    let arm = moving.rotation * anchor;
                    let along = moving.spin.cross(&arm);
                    let change = turning.cross(&arm) + moving.spin.cross(&along);
                    for axis in 0..3 {
                        dx[axis * n + i] = dx[axis * n + c] + along[axis];
                        dv[axis * n + i] = dv[axis * n + c] + change[axis];
                    }
                }
            }
        });
    }

    fn kick(&self, t: f64, terms: Terms, y: &[f64], rates: &mut [f64]) {
        let n = self.particles();
        with_forces(self, t, terms, y, |_, loads| {
            rates.fill(0.0);
            accelerate(self, loads.f, &mut rates[3 * n..6 * n]);
            for (k, body, rotation, _) in self.bodies.each(y) {
                let wrench = wrench(self, k, &rotation, terms, loads);
                let w = self.particles.inverse_masses()[body.center()];
                for axis in 0..3 {
                    rates[(3 + axis) * n + body.center()] = w * wrench.force[axis];
                }
                let momentum = self.bodies.numbers(k).end - 3..self.bodies.numbers(k).end;
                rates[momentum].copy_from_slice(wrench.torque.as_slice());
            }
        });
    }

    fn kick_reads_velocity(&self) -> bool {
        Splitting::kick_reads_velocity(self)
    }

    fn drift(&self, t: f64, h: f64, terms: Terms, y: &mut [f64]) {
        let n = self.particles();
        let (halves, tail) = y.split_at_mut(6 * n);
        let (x, v) = halves.split_at_mut(3 * n);
        let is_split = is_split(self, terms);
        if is_split {
            Splitting::drift(self, t, h, x, v);
        } else {
            for (x, v) in x.iter_mut().zip(v) {
                *x += h * *v;
            }
        }
        for (body, tail) in self.bodies().iter().zip(tail.chunks_exact_mut(ROTATION)) {
            let mut rotation = Rotation::read(tail);
            let decay = if is_split { decay(self, body) } else { 0.0 };
            body.fly(&mut rotation, decay, h);
            rotation.write(tail);
        }
        self.place(t + h, y);
    }

    fn is_carried(&self, k: usize) -> bool {
        let n = self.particles();
        k < 6 * n && Self::is_carried(self, k % n)
    }

    fn place(&self, t: f64, y: &mut [f64]) {
        let n = self.particles();
        let (x, rest) = y.split_at_mut(3 * n);
        let (v, _) = rest.split_at_mut(3 * n);
        place_pins(self, t, x, v);
        self.bodies.settle(y);
    }

    fn project(&self, y: &mut [f64]) {
        if has_joints(self) {
            project(self, y, false);
        }
    }

    fn measures(&self, visit: &mut dyn FnMut(Range<usize>, Measure)) {
        for axis in 0..6 {
            let measure = if axis < 3 { Measure::Position } else { Measure::Velocity };
            let mut start = axis * self.particles();
            for run in self.masses().chunk_by(|a, b| (*a > 0.0) == (*b > 0.0)) {
                if run[0] > 0.0 {
                    visit(start..start + run.len(), measure);
                }
                start += run.len();
            }
        }
        for (k, body) in self.bodies().iter().enumerate() {
            let Range { start, end } = self.bodies.numbers(k);
            let (radius, speed) = (body.radius(), body.speed());
            visit(start..end - 3, Measure::Rotation { radius });
            visit(end - 3..end, Measure::Momentum { speed });
        }
    }
}
