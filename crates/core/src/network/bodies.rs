//! Rigid bodies of a network: its state is then [x | v | q, L of each body].

use std::ops::Range;

use nalgebra::Vector3;

use super::Network;
use crate::constraints::Turning;
use crate::elements::Finish;
use crate::elements::force::Carried;
use crate::error::Error;
use crate::path::Pose;
use crate::rigid::{Body, Moving, ROTATION, Rotation};
use crate::rows::Terms;
use crate::system::{Measure, Mechanics, Rigid, Splitting, place_pins};

/// Force (N) and torque about the centre (N m) on a body.
#[derive(Clone, Copy, Default)]
struct Wrench {
    force: Vector3<f64>,
    torque: Vector3<f64>,
}

impl Network {
    /// Makes a rigid body of a particle, its centre of mass, and of particles that it carries from
    /// now on: their masses become 0. The state gets seven numbers more, which
    /// [`Rotation`] writes.
    ///
    /// # Errors
    /// A particle does not exist, belongs to another body already, is pinned or in a
    /// sheet.
    pub fn add_body(&mut self, body: Body) -> Result<(), Error> {
        self.check_particle(body.center())?;
        if body.points().end > self.particles() {
            self.check_particle(body.points().end - 1)?;
        }
        for i in body.points() {
            let in_sheet = self.sheets().any(|sheet| sheet.particles().contains(&i));
            if i == body.center() || self.body_of(i).is_some() || in_sheet {
                return Err(Error::Invalid(format!(
                    "particle {i} cannot be a point of a body: it is a centre, in a sheet, or a \
                     point already"
                )));
            }
            self.check_led(i)?;
        }
        if self.body_of(body.center()).is_some() {
            return Err(Error::Invalid(format!(
                "particle {} cannot be the centre of two bodies",
                body.center()
            )));
        }
        for i in body.points() {
            (self.masses[i], self.inverse_masses[i]) = (0.0, 0.0);
        }
        self.uniform_inverse_mass = None;
        self.bodies.push(body);
        if self.is_constrained() {
            self.renew_constraints()?;
        }
        self.renew_contact();
        self.scratch.reserve(self.particles());
        Ok(())
    }

    /// The rigid bodies, in the order in which they were added.
    #[must_use]
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// The body to which particle i belongs, as its centre or as a point.
    #[must_use]
    pub fn body_of(&self, i: usize) -> Option<usize> {
        let mut bodies = self.bodies.iter();
        bodies.position(|body| body.center() == i || body.points().contains(&i))
    }

    /// Whether particle i is a point that a body carries.
    #[must_use]
    pub fn is_carried(&self, i: usize) -> bool {
        self.masses[i] == 0.0
    }

    /// Mass (kg) that moves with particle i: its own, or that of the body that carries it.
    pub(crate) fn mass_behind(&self, i: usize) -> f64 {
        let body = self.body_of(i).filter(|_| self.is_carried(i));
        self.masses[body.map_or(i, |k| self.bodies[k].center())]
    }

    /// `Ok` if particle i can be led along a path by itself.
    pub(crate) fn check_led(&self, i: usize) -> Result<(), Error> {
        match self.is_carried(i).then(|| self.body_of(i)).flatten() {
            None => Ok(()),
            Some(k) => Err(Error::Invalid(format!(
                "particle {i} cannot be pinned by itself: it is a point of a rigid body, whose \
                 centre is particle {}",
                self.bodies[k].center()
            ))),
        }
    }

    /// Numbers of the rotation of body k in a state.
    fn numbers(&self, k: usize) -> Range<usize> {
        let first = 6 * self.particles() + ROTATION * k;
        first..first + ROTATION
    }

    /// Rotation of body k in the state y.
    #[must_use]
    pub fn rotation(&self, k: usize, y: &[f64]) -> Rotation {
        Rotation::read(&y[self.numbers(k)])
    }

    /// Writes the rotation of body k to the state y. Its points follow at the next step.
    pub fn set_rotation(&self, k: usize, rotation: &Rotation, y: &mut [f64]) {
        rotation.write(&mut y[self.numbers(k)]);
    }

    /// Place and orientation of body k in the state y.
    #[must_use]
    pub fn pose(&self, k: usize, y: &[f64]) -> Pose {
        let (x, v) = self.halves(y);
        self.bodies[k].pose(&self.rotation(k, y), x, v)
    }

    /// Positions and velocities, n x 3 each, of a state.
    #[must_use]
    pub fn halves<'a>(&self, y: &'a [f64]) -> (&'a [f64], &'a [f64]) {
        let n = 3 * self.particles();
        (&y[..n], &y[n..2 * n])
    }

    /// Each body with its rotation and how it moves in the state y.
    fn each<'a>(
        &'a self,
        y: &'a [f64],
    ) -> impl Iterator<Item = (usize, &'a Body, Rotation, Moving)> {
        self.bodies.iter().enumerate().map(|(k, body)| {
            let rotation = self.rotation(k, y);
            (k, body, rotation, body.moving(&rotation))
        })
    }

    /// Puts the points of bodies, whose rotations are in y, to their places in x and v.
    fn place_points(&self, y: &[f64], x: &mut [f64], v: &mut [f64]) {
        let n = self.particles();
        for (_, body, _, moving) in self.each(y) {
            for (i, anchor) in body.anchors() {
                let arm = moving.rotation * anchor;
                let along = moving.spin.cross(&arm);
                for axis in 0..3 {
                    x[axis * n + i] = x[axis * n + body.center()] + arm[axis];
                    v[axis * n + i] = v[axis * n + body.center()] + along[axis];
                }
            }
        }
    }

    /// Evaluates forces (N), n x 3, in the state y at time t (s) with all points in their places,
    /// and uses them with these positions and velocities.
    fn with_forces<T>(
        &self,
        t: f64,
        terms: Terms,
        y: &[f64],
        run: impl FnOnce(&[f64], &[f64], &[f64]) -> T,
    ) -> T {
        self.scratch.lend(self.particles(), |[x, v, f]| {
            let (own_x, own_v) = self.halves(y);
            x.copy_from_slice(own_x);
            v.copy_from_slice(own_v);
            self.place_points(y, x, v);
            self.evaluate(&self.at(t, x, v), f, &Finish::default());
            if !self.drifts_carry(terms) {
                let Carried { gravity, drag } = self.carried();
                let n = self.particles();
                for (k, (f, v)) in f.iter_mut().zip(&*v).enumerate() {
                    let mass = self.masses[k % n];
                    *f += mass * gravity[k / n] - if mass > 0.0 { drag * v } else { 0.0 };
                }
                let bodies = |k: usize, f: &[f64]| self.turning(k, y, terms, x, f);
                self.hold(t, [x, v], bodies, f);
            }
            run(x, v, f)
        })
    }

    /// Force and torque on a body at x, of the forces f on its particles. Drag acts on a rotation
    /// as it does on the motion of the centre: at the rate c / m.
    fn wrench(
        &self,
        body: &Body,
        rotation: &Rotation,
        terms: Terms,
        x: &[f64],
        f: &[f64],
    ) -> Wrench {
        let center = row(x, body.center());
        let mut wrench = Wrench {
            force: row(f, body.center()),
            torque: Vector3::zeros(),
        };
        for i in body.points() {
            let force = row(f, i);
            wrench.force += force;
            wrench.torque += (row(x, i) - center).cross(&force);
        }
        if !self.drifts_carry(terms) {
            wrench.torque -= rotation.momentum * self.decay(body);
        }
        wrench
    }

    /// How body k turns, and the acceleration of its centre (m/s2), under the forces f, with y and
    /// all points at x.
    fn turning(
        &self,
        k: usize,
        y: &[f64],
        terms: Terms,
        x: &[f64],
        f: &[f64],
    ) -> (Turning, Vector3<f64>) {
        let (body, rotation) = (&self.bodies[k], self.rotation(k, y));
        let moving = body.moving(&rotation);
        let wrench = self.wrench(body, &rotation, terms, x, f);
        let turning = Turning {
            center: row(x, body.center()),
            rotation: moving.rotation,
            spin: moving.spin,
            acceleration: moving.angular_acceleration(&body.inertia(), wrench.torque),
            inverse_inertia: body.inertia().map(|moment| 1.0 / moment),
        };
        (turning, wrench.force * self.inverse_masses[body.center()])
    }

    /// Rate (1/s) at which drag takes from the motion of a body.
    fn decay(&self, body: &Body) -> f64 {
        self.carried().drag / self.masses[body.center()]
    }

    /// Writes accelerations (m/s2) of particles that no body carries to a, n x 3.
    fn accelerate(&self, f: &[f64], a: &mut [f64]) {
        let n = self.particles();
        for (k, (a, f)) in a.iter_mut().zip(f).enumerate() {
            *a = self.inverse_masses[k % n] * f;
        }
    }
}

/// The row of particle i.
fn row(a: &[f64], i: usize) -> Vector3<f64> {
    let n = a.len() / 3;
    Vector3::new(a[i], a[n + i], a[2 * n + i])
}

impl Rigid for Network {
    fn length(&self) -> usize {
        6 * self.particles() + ROTATION * self.bodies.len()
    }

    fn rates(&self, t: f64, y: &[f64], dydt: &mut [f64]) {
        let n = self.particles();
        self.with_forces(t, Terms::AllForces, y, |x, v, f| {
            let (halves, tail) = dydt.split_at_mut(6 * n);
            let (dx, dv) = halves.split_at_mut(3 * n);
            dx.copy_from_slice(v);
            self.accelerate(f, dv);
            Mechanics::pins(self, t, &mut |i, place| {
                for axis in 0..3 {
                    dx[axis * n + i] = place.velocity[axis];
                    dv[axis * n + i] = place.acceleration[axis];
                }
            });
            for ((_, body, rotation, moving), tail) in
                self.each(y).zip(tail.chunks_exact_mut(ROTATION))
            {
                let wrench = self.wrench(body, &rotation, Terms::AllForces, x, f);
                let (c, w) = (body.center(), self.inverse_masses[body.center()]);
                for axis in 0..3 {
                    if w > 0.0 {
                        dv[axis * n + c] = w * wrench.force[axis];
                    }
                }
                let rate = Rotation {
                    q: moving.rate(rotation.q),
                    momentum: wrench.torque,
                };
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
        self.with_forces(t, terms, y, |x, _, f| {
            rates.fill(0.0);
            self.accelerate(f, &mut rates[3 * n..6 * n]);
            for (k, body, rotation, _) in self.each(y) {
                let wrench = self.wrench(body, &rotation, terms, x, f);
                let w = self.inverse_masses[body.center()];
                for axis in 0..3 {
                    rates[(3 + axis) * n + body.center()] = w * wrench.force[axis];
                }
                let momentum = self.numbers(k).end - 3..self.numbers(k).end;
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
        let carries = self.drifts_carry(terms);
        if carries {
            Splitting::drift(self, t, h, x, v);
        } else {
            for (x, v) in x.iter_mut().zip(v) {
                *x += h * *v;
            }
        }
        for (body, tail) in self.bodies.iter().zip(tail.chunks_exact_mut(ROTATION)) {
            let mut rotation = Rotation::read(tail);
            let decay = if carries { self.decay(body) } else { 0.0 };
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
        self.scratch.lend(n, |[px, pv, _]| {
            px.copy_from_slice(&y[..3 * n]);
            pv.copy_from_slice(&y[3 * n..6 * n]);
            self.place_points(y, px, pv);
            y[..3 * n].copy_from_slice(px);
            y[3 * n..6 * n].copy_from_slice(pv);
        });
    }

    fn measures(&self, visit: &mut dyn FnMut(Range<usize>, Measure)) {
        for axis in 0..6 {
            let measure = if axis < 3 {
                Measure::Position
            } else {
                Measure::Velocity
            };
            let mut start = axis * self.particles();
            for run in self.masses.chunk_by(|a, b| (*a > 0.0) == (*b > 0.0)) {
                if run[0] > 0.0 {
                    visit(start..start + run.len(), measure);
                }
                start += run.len();
            }
        }
        for (k, body) in self.bodies.iter().enumerate() {
            let Range { start, end } = self.numbers(k);
            let (radius, speed) = (body.radius(), body.speed());
            visit(start..end - 3, Measure::Rotation { radius });
            visit(end - 3..end, Measure::Momentum { speed });
        }
    }
}
