//! Rigid bodies among the particles of a network. With them, the state is [x | v | q and L of each
//! body].
//!
//! Air that streams past a rigid body: its force and torque, by a quadrature over the faces.
//!
//! The faces are small beside the body, and smaller in the region of a wind. The nodes turn with
//! the body, and no piece is added or left out where the wind is not zero: so force and torque are
//! as smooth as the wind.

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use nalgebra::Vector3;

use super::elements::Elements;
use super::particles::Particles;
use crate::columns::row;
use crate::elements::{Airflow, Stream};
use crate::error::Error;
use crate::rigid::{Body, Driven, Face, Motor, Moving, ROTATION, Rotation, faces};
use crate::scratch::Scratch;

/// Rigid bodies of a network.
#[derive(Clone, Debug, Default)]
pub(super) struct Bodies {
    all: Vec<Body>,
    motors: Vec<Motor>,
    /// Faces of each body, past which air streams.
    faces: OnceLock<Arc<[Vec<Face>]>>,
    /// Number of particles.
    particles: usize,
    /// Positions (m), velocities (m/s) and forces (N) of an evaluation, n x 3 each, and torques
    /// (N m) on bodies.
    pub scratch: Scratch<[Vec<f64>; 4]>,
}

impl Bodies {
    /// Creates an empty list of bodies, among n particles.
    pub fn new(n: usize) -> Self {
        Self { particles: n, ..Self::default() }
    }

    /// Checks that a body can be added: its particles exist, belong to no other body and are free,
    /// and its points are in no sheet.
    pub fn check(
        &self,
        body: &Body,
        particles: &Particles,
        elements: &Elements,
    ) -> Result<(), Error> {
        particles.check(body.center())?;
        if body.points().end > particles.len() {
            particles.check(body.points().end - 1)?;
        }
        for i in body.points() {
            let in_sheet = elements.sheets().any(|sheet| sheet.particles().contains(&i));
            if i == body.center() || self.body_of(i).is_some() || in_sheet {
                return Err(Error::Invalid(format!(
                    "particle {i} cannot be a point of a body: it is a centre, in a sheet, or a \
                     point already"
                )));
            }
            self.check_free(particles, i)?;
        }
        if self.body_of(body.center()).is_some() {
            return Err(Error::Invalid(format!(
                "particle {} cannot be the centre of two bodies",
                body.center()
            )));
        }
        Ok(())
    }

    /// Checks that no body carries particle i.
    pub fn check_free(&self, particles: &Particles, i: usize) -> Result<(), Error> {
        match self.carrier(particles, i) {
            None => Ok(()),
            Some((center, _)) => Err(Error::Invalid(format!(
                "particle {i} cannot be pinned by itself: it is a point of a rigid body, whose \
                 centre is particle {center}"
            ))),
        }
    }

    pub fn add(&mut self, body: Body) {
        self.all.push(body);
        self.faces = OnceLock::new();
    }

    pub fn all(&self) -> &[Body] {
        &self.all
    }

    /// Adds a motor.
    pub fn add_motor(&mut self, motor: Motor) -> Result<(), Error> {
        motor.check(self.all.len())?;
        self.motors.push(motor);
        Ok(())
    }

    pub fn motors(&self) -> &[Motor] {
        &self.motors
    }

    /// Adds the forces of motors (N) in the state y to f, n x 3, and their torques (N m), three
    /// numbers for each body.
    pub fn drive(&self, y: &[f64], f: &mut [f64], torques: &mut [f64]) {
        let n = self.particles;
        let driven = |k: usize| Driven {
            moving: self.all[k].moving(&self.rotation(k, y)),
            place: row(y, n, self.all[k].center()),
            velocity: row(&y[3 * n..], n, self.all[k].center()),
        };
        for motor in &self.motors {
            let second = motor.second.map(driven);
            let [force, own, other] = motor.load(&driven(motor.first), second.as_ref());
            let sides = [(Some(motor.first), force, own), (motor.second, -force, other)];
            for (body, force, torque) in sides {
                let Some(k) = body else { continue };
                for axis in 0..3 {
                    f[axis * n + self.all[k].center()] += force[axis];
                    torques[3 * k + axis] += torque[axis];
                }
            }
        }
    }

    /// Adds the forces of air (N) that streams past the bodies in the state y at time t (s) to f,
    /// n x 3, and their torques (N m), three numbers for each body.
    pub fn blow(&self, airflow: &Airflow, t: f64, y: &[f64], f: &mut [f64], torques: &mut [f64]) {
        let n = self.particles;
        let of = |body: &Body| faces(body.parts(), body.radius());
        let faces = self.faces.get_or_init(|| self.all.iter().map(of).collect());
        let stream = airflow.wind.stream(t);
        for (k, body, _, moving) in self.each(y) {
            let [place, velocity] = [y, &y[3 * n..]].map(|of| row(of, n, body.center()));
            let pass = Pass { airflow, stream: stream.as_ref(), t, place, velocity, moving };
            let [force, torque] = pass.over(&faces[k], body.radius());
            for axis in 0..3 {
                f[axis * n + body.center()] += force[axis];
                torques[3 * k + axis] += torque[axis];
            }
        }
    }

    /// Returns the body to which particle i belongs, as its centre or as a point.
    pub fn body_of(&self, i: usize) -> Option<usize> {
        let mut bodies = self.all.iter();
        bodies.position(|body| body.center() == i || body.points().contains(&i))
    }

    /// Returns the centre and number of the body to which particle i belongs.
    pub fn belonging(&self, i: usize) -> Option<(usize, usize)> {
        self.body_of(i).map(|k| (self.all[k].center(), k))
    }

    /// Returns the centre and number of the body that carries particle i.
    pub fn carrier(&self, particles: &Particles, i: usize) -> Option<(usize, usize)> {
        let k = particles.is_carried(i).then(|| self.body_of(i))??;
        Some((self.all[k].center(), k))
    }

    /// Returns the places of the numbers of body k's rotation in a state.
    pub fn numbers(&self, k: usize) -> Range<usize> {
        let first = 6 * self.particles + ROTATION * k;
        first..first + ROTATION
    }

    /// Returns the rotation of body k in the state y.
    pub fn rotation(&self, k: usize, y: &[f64]) -> Rotation {
        Rotation::read(&y[self.numbers(k)])
    }

    /// Returns each body with its number, its rotation, and its motion in the state y.
    pub fn each<'a>(
        &'a self,
        y: &'a [f64],
    ) -> impl Iterator<Item = (usize, &'a Body, Rotation, Moving)> {
        self.all.iter().enumerate().map(|(k, body)| {
            let rotation = self.rotation(k, y);
            (k, body, rotation, body.moving(&rotation))
        })
    }

    /// Writes the positions and velocities of points of bodies, whose rotations are in y, to x and
    /// v.
    pub fn place_points(&self, y: &[f64], x: &mut [f64], v: &mut [f64]) {
        let n = self.particles;
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

    /// Puts the points of bodies in their places in the state y.
    pub fn settle(&self, y: &mut [f64]) {
        let n = 3 * self.particles;
        self.scratch.lend(|[x, v, ..]| {
            y[..n].clone_into(x);
            y[n..2 * n].clone_into(v);
            self.place_points(y, x, v);
            y[..n].copy_from_slice(x);
            y[n..2 * n].copy_from_slice(v);
        });
    }
}

/// Number of pieces of a flat side that bounds the work in long, thin regions, where fewer do not
/// suffice.
const MOST_PIECES: f64 = 1000.0;

/// Body in a stream of air at one time.
pub(super) struct Pass<'a> {
    pub airflow: &'a Airflow,
    /// Region of the wind, if it has one.
    pub stream: Option<&'a Stream>,
    /// Time (s).
    pub t: f64,
    /// Position of the centre (m).
    pub place: Vector3<f64>,
    /// Velocity of the centre (m/s).
    pub velocity: Vector3<f64>,
    pub moving: Moving,
}

impl Pass<'_> {
    /// Returns the force (N) and the torque (N m) about the centre of a body with these faces and
    /// that radius (m).
    pub fn over(&self, faces: &[Face], radius: f64) -> [Vector3<f64>; 2] {
        let mut sum = [Vector3::zeros(); 2];
        let Some(stream) = self.stream else {
            for face in faces {
                face.nodes(radius, &mut |at, area| {
                    self.add([at, area], [1.0, 0.0], &mut sum);
                });
            }
            return sum;
        };
        let area = stream.section().min(4.0 * radius * radius);
        let longest = stream.width().max((area / MOST_PIECES).sqrt());
        let is_near = |middle: Vector3<f64>, reach: f64| {
            stream.reaches(self.place + self.moving.rotation * middle, reach)
        };
        for face in faces {
            // Still air everywhere, and in the region what the wind changes.
            face.nodes(radius, &mut |at, area| {
                self.add([at, area], [0.0, 1.0], &mut sum);
            });
            face.pieces(longest, &is_near, &mut |piece| {
                piece.nodes(longest.min(radius), &mut |at, area| {
                    self.add([at, area], [1.0, -1.0], &mut sum);
                });
            });
        }
        sum
    }

    /// Adds the force and torque at a node, times the first share in the wind and times the second
    /// in still air.
    fn add(
        &self,
        [at, area]: [Vector3<f64>; 2],
        [wind, still]: [f64; 2],
        sum: &mut [Vector3<f64>; 2],
    ) {
        let [arm, area] = [at, area].map(|vector| self.moving.rotation * vector);
        let own = self.velocity + self.moving.spin.cross(&arm);
        let mut force = Vector3::zeros();
        if wind != 0.0 {
            let blown = self.airflow.wind.in_stream(self.stream, self.t, (self.place + arm).into());
            force += self.airflow.on_closed(blown - own, area) * wind;
        }
        if still != 0.0 {
            force += self.airflow.on_closed(-own, area) * still;
        }
        sum[0] += force;
        sum[1] += arm.cross(&force);
    }
}
