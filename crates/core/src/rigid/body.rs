//! Rigid bodies: their parts, their mass properties, the places of their points, and motors:
//! torques about an axis, or forces along it, between two of them, or one and the world.

use std::ops::Range;

use nalgebra::{Matrix3, Quaternion, Vector3};

use super::rotation::Rotation;
use crate::error::{Error, finite, positive};
use crate::geometry::Shape;
use crate::path::{Orientation, Place, Pose};

/// Share of a moment of inertia that may be a rounding error.
const ROUNDING: f64 = 1e-9;

/// Rigid body of a network.
///
/// ```
/// use a3_core::contact::Shape;
/// use a3_core::rigid::{Body, MassProperties, Part, ROTATION, Rotation};
/// use a3_core::{Control, Network, Scene, Simulation, Vector3, integrators};
///
/// // A ball that spins in space: a particle at its centre, one at its only point, and a rotation.
/// let ball = Shape::Sphere { radius: 0.5 };
/// let properties = MassProperties::of(&ball, 1000.0)?;
/// let mut network = Network::new(vec![properties.mass, properties.mass])?;
/// let part = Part { shape: ball, at: Vector3::zeros() };
/// network.add_body(Body::new(0, 1, properties.inertia.diagonal(), vec![part])?)?;
/// let mut state = vec![0.0; 12 + ROTATION];
/// let still = Rotation::about(Vector3::zeros());
/// Rotation { momentum: Vector3::z(), ..still }.write(&mut state[12..]);
/// let verlet = integrators::find("verlet").unwrap();
/// let scene = Scene::new("spin", network, state);
/// let mut run = Simulation::new(scene, verlet, Control::Step(0.01))?;
/// let before = run.energy().unwrap().kinetic;
/// run.advance_to(1.0)?;
/// assert!((run.energy().unwrap().kinetic / before - 1.0).abs() < 1e-9);
/// # Ok::<(), a3_core::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    center: usize,
    points: Range<usize>,
    /// Places of the points, relative to the centre and along the principal axes (m).
    anchors: Vec<Vector3<f64>>,
    inertia: Vector3<f64>,
    radius: f64,
    parts: Vec<Part>,
}

/// Body in motion: its rotation matrix and angular velocity (rad/s).
#[derive(Clone, Copy)]
pub(crate) struct Moving {
    pub rotation: Matrix3<f64>,
    pub spin: Vector3<f64>,
    momentum: Vector3<f64>,
}

impl Body {
    /// Creates a body with these principal moments of inertia (kg m2), whose centre of mass is the
    /// particle `center`. The [points](crate::geometry::Shape::simplices) of its parts are the
    /// particles from number `first` on.
    ///
    /// # Errors
    /// It has no parts, or only floors; or no body can have these moments: each has to be a finite
    /// number above 0, and none larger than the sum of the other two.
    pub fn new(
        center: usize,
        first: usize,
        inertia: Vector3<f64>,
        parts: Vec<Part>,
    ) -> Result<Self, Error> {
        for moment in &inertia {
            positive("a moment of inertia", *moment)?;
        }
        let largest = inertia.max();
        if largest > (inertia.sum() - largest) * (1.0 + ROUNDING) {
            return Err(Error::Invalid(format!(
                "no body has the moments of inertia {}, {} and {}: none may be larger than the \
                 sum of the other two",
                inertia.x, inertia.y, inertia.z
            )));
        }
        let (mut anchors, mut radius) = (vec![], 0.0f64);
        for part in &parts {
            part.shape.check()?;
            let simplices = part.shape.simplices();
            for point in simplices.points {
                let anchor = part.at + point;
                radius = radius.max(anchor.norm() + simplices.radius);
                anchors.push(anchor);
            }
        }
        if anchors.is_empty() {
            return Err(Error::Invalid("a body needs a part that is not a floor".into()));
        }
        Ok(Self { center, points: first..first + anchors.len(), anchors, inertia, radius, parts })
    }

    /// Adds points to the body, as those that a liquid touches: the particles that follow the
    /// points of its parts. Their places are relative to the centre and along the principal axes
    /// (m).
    #[must_use]
    pub fn with_points(mut self, places: impl IntoIterator<Item = Vector3<f64>>) -> Self {
        self.anchors.extend(places);
        self.points.end = self.points.start + self.anchors.len();
        self
    }

    /// Returns the particle at the centre of mass, which has the body's mass.
    #[must_use]
    pub fn center(&self) -> usize {
        self.center
    }

    /// Returns the particles at the points of the parts, and at further points, which have no mass.
    #[must_use]
    pub fn points(&self) -> Range<usize> {
        self.points.clone()
    }

    /// Lists the points with their places, relative to the centre and along the principal axes (m).
    pub(crate) fn anchors(&self) -> impl Iterator<Item = (usize, &Vector3<f64>)> {
        self.points.clone().zip(&self.anchors)
    }

    /// Returns the principal moments of inertia (kg m2).
    #[must_use]
    pub fn inertia(&self) -> Vector3<f64> {
        self.inertia
    }

    /// Returns the distance of the body's farthest point from the centre (m).
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns the largest speed of the body's surface per unit of angular momentum (1/(kg m)).
    pub(crate) fn speed(&self) -> f64 {
        self.radius / self.inertia.min()
    }

    /// Returns the parts.
    #[must_use]
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Returns the body in motion.
    pub(crate) fn moving(&self, rotation: &Rotation) -> Moving {
        let (matrix, momentum) = (rotation.matrix(), rotation.momentum);
        Moving {
            rotation: matrix,
            spin: matrix * matrix.tr_mul(&momentum).component_div(&self.inertia),
            momentum,
        }
    }

    /// Returns the energy of the rotation (J).
    #[must_use]
    pub fn energy(&self, rotation: &Rotation) -> f64 {
        0.5 * rotation.momentum.dot(&self.moving(rotation).spin)
    }

    /// Returns the angular momentum (kg m2/s) at which the body turns with that angular velocity
    /// (rad/s).
    #[must_use]
    pub fn momentum(&self, q: Quaternion<f64>, spin: Vector3<f64>) -> Vector3<f64> {
        let momentum = Vector3::zeros();
        let matrix = Rotation { q, momentum }.matrix();
        matrix * matrix.tr_mul(&spin).component_mul(&self.inertia)
    }

    /// Returns the place and orientation of a body whose centre is at x and moves with v, both n x
    /// 3.
    #[must_use]
    pub fn pose(&self, rotation: &Rotation, x: &[f64], v: &[f64]) -> Pose {
        let Moving { rotation, spin, .. } = self.moving(rotation);
        let row = |a: &[f64]| {
            let n = a.len() / 3;
            Vector3::new(a[self.center], a[n + self.center], a[2 * n + self.center])
        };
        Pose {
            place: Place { position: row(x), velocity: row(v), acceleration: Vector3::zeros() },
            orientation: Some(Orientation { rotation, spin }),
        }
    }
}

impl Moving {
    /// Returns the rate of the quaternion, w q / 2.
    pub fn rate(&self, q: Quaternion<f64>) -> Quaternion<f64> {
        Quaternion::from_imag(self.spin) * q * 0.5
    }

    /// Returns the angular acceleration (rad/s2) under a torque (N m).
    pub fn angular_acceleration(
        &self,
        inertia: &Vector3<f64>,
        torque: Vector3<f64>,
    ) -> Vector3<f64> {
        let change = torque - self.spin.cross(&self.momentum);
        self.rotation * self.rotation.tr_mul(&change).component_div(inertia)
    }
}

/// Motion that a motor drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// Rotation about the axis, by a torque.
    Rotary,
    /// Displacement along the axis, by a force.
    Linear,
}

/// Motor that moves a body relative to another one or to the world, about or along an axis of the
/// body. Its torque or force is constant; or it falls in proportion to the speed and vanishes at
/// one speed, as that of a DC motor at a constant voltage: T (1 - w / w0). Beyond that speed it
/// brakes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// What it drives.
    pub drive: Drive,
    /// Number of the body that it moves.
    pub first: usize,
    /// Number of the body that it moves against; `None` for the world.
    pub second: Option<usize>,
    /// Axis along the principal axes of the first body, of length 1.
    pub axis: Vector3<f64>,
    /// Torque (N m) or force (N) at rest.
    pub effort: f64,
    /// Speed at which that vanishes (rad/s or m/s), of the same sign; `None` for a constant one.
    pub speed: Option<f64>,
}

impl Motor {
    /// Checks all numbers of the motor, in a network with that many bodies.
    pub(crate) fn check(&self, bodies: usize) -> Result<(), Error> {
        finite("the axis of a motor", self.axis)?;
        let right = self.effort.is_finite()
            && self.first < bodies
            && self.second.is_none_or(|k| k < bodies && k != self.first)
            && self.speed.is_none_or(|speed| speed.is_finite() && speed * self.effort > 0.0);
        if right {
            return Ok(());
        }
        Err(Error::Invalid(
            "a motor needs bodies that exist, a finite torque or force, and a speed of the same sign".into(),
        ))
    }

    /// Returns the force (N) and the torque (N m) on the first body, and the torque on the second,
    /// whose force is opposite. A force acts at the centre of the first.
    pub(crate) fn load(&self, first: &Driven, second: Option<&Driven>) -> [Vector3<f64>; 3] {
        let axis = first.moving.rotation * self.axis;
        let still = Vector3::zeros();
        let arm = second.map_or(still, |second| first.place - second.place);
        let spin = second.map_or(still, |second| second.moving.spin);
        let rate = match self.drive {
            Drive::Rotary => first.moving.spin - spin,
            Drive::Linear => {
                let velocity = second.map_or(still, |second| second.velocity);
                first.velocity - velocity - spin.cross(&arm)
            }
        };
        let share = self.speed.map_or(1.0, |speed| 1.0 - axis.dot(&rate) / speed);
        let effort = axis * (self.effort * share);
        match self.drive {
            Drive::Rotary => [still, effort, -effort],
            Drive::Linear => [effort, still, -arm.cross(&effort)],
        }
    }
}

/// Body on one side of a motor in a state.
pub(crate) struct Driven {
    pub moving: Moving,
    /// Place (m) and velocity (m/s) of its centre.
    pub place: Vector3<f64>,
    pub velocity: Vector3<f64>,
}

/// Part of a body, relative to its centre and along the principal axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Shape.
    pub shape: Shape,
    /// Place of the part (m).
    pub at: Vector3<f64>,
}
