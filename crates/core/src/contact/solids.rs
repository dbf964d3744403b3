//! Rigid bodies in a step, as the guard moves them: their mobilities, and what impulses do to them.

use std::ops::{Deref, DerefMut, Range};

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use super::surface::Surface;
use crate::rigid::{Body, Rotation, rotation_vector, turn};

/// Distance of two points of contact that count as one, over that from the body's centre, and that
/// of their normals.
pub(super) const SAME: f64 = 1e-6;

/// A vector for each vertex, and one for each rigid body: displacements (m) and rotation vectors
/// (rad), or velocities (m/s) and angular velocities (rad/s).
#[derive(Clone, Debug, Default)]
pub(super) struct Field {
    pub points: Vec<Vector3<f64>>,
    pub turns: Vec<Vector3<f64>>,
    /// What impulses changed of each rigid body that the points and the turns do not have yet.
    changes: Vec<Change>,
}

/// Change of a rigid body: of its centre, and of its turn.
#[derive(Clone, Copy, Debug, Default)]
struct Change {
    along: Vector3<f64>,
    turned: Vector3<f64>,
}

impl Field {
    /// Forgets all bodies.
    pub fn forget_solids(&mut self) {
        self.turns.clear();
        self.changes.clear();
    }

    /// Adds a body of that turn.
    pub fn add_solid(&mut self, turn: Vector3<f64>) {
        self.turns.push(turn);
        self.changes.push(Change::default());
    }
}

impl Deref for Field {
    type Target = Vec<Vector3<f64>>;

    fn deref(&self) -> &Self::Target {
        &self.points
    }
}

impl DerefMut for Field {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.points
    }
}

/// Rigid body at the end of a step.
#[derive(Clone, Debug)]
pub(super) struct Solid {
    pub center: usize,
    pub points: Range<usize>,
    /// Inverse mass (1/kg): 0 if its centre is pinned.
    inverse_mass: f64,
    /// Inertia and its inverse in the world (kg m2).
    inertia: Matrix3<f64>,
    inverse_inertia: Matrix3<f64>,
    /// Points as seen from the centre (m).
    arms: Vec<Vector3<f64>>,
    /// Orientation and angular momentum at both ends of the step.
    ends: [Rotation; 2],
    /// Rotation vector of the step (rad) and angular velocity at its end (rad/s) before the guard.
    unguarded: [Vector3<f64>; 2],
}

/// Side of a contact that is a rigid body.
#[derive(Clone, Copy)]
pub(super) struct Arm {
    pub solid: usize,
    /// Point of contact as seen from the centre (m).
    lever: Vector3<f64>,
    /// The point of contact as seen from the closest point of the body's simplices (m): not 0 on
    /// round bodies.
    round: Vector3<f64>,
    /// 1 for the first primitive of a pair, -1 for the second.
    sign: f64,
}

impl Solid {
    /// A body at the end of a step between these ends, and its rotation vector in the step (rad)
    /// and the angular velocities at both ends (rad/s).
    pub fn new(
        body: &Body,
        inverse_mass: f64,
        ends: [Rotation; 2],
    ) -> (Self, Vector3<f64>, [Vector3<f64>; 2]) {
        let [before, after] = ends.map(|rotation| body.moving(&rotation));
        let matrix = after.rotation;
        let along =
            |moments: Vector3<f64>| matrix * Matrix3::from_diagonal(&moments) * matrix.transpose();
        let way = rotation_vector(ends[1].q, ends[0].q);
        let solid = Self {
            center: body.center(),
            points: body.points(),
            inverse_mass,
            inertia: along(body.inertia()),
            inverse_inertia: along(body.inertia().map(f64::recip)),
            arms: body.anchors().map(|(_, anchor)| matrix * anchor).collect(),
            ends,
            unguarded: [way, after.spin],
        };
        (solid, way, [before.spin, after.spin])
    }

    /// The arm of a point of contact on the body of a vertex, at the closest point of its simplices
    /// as seen from the vertices with these weights.
    pub fn arm(
        surface: &Surface,
        solids: &[Self],
        side: (&[u32], &[f64]),
        normal: Vector3<f64>,
        sign: f64,
    ) -> Option<Arm> {
        let (points, weights) = side;
        let solid = surface.solid(points[0])?;
        let own = &solids[solid];
        let mut lever = Vector3::zeros();
        for (i, weight) in points.iter().zip(weights) {
            lever += own.arms[*i as usize - own.points.start] * (weight * sign);
        }
        let round = normal * (-sign * surface.radius(points[0]));
        Some(Arm {
            solid,
            lever: lever + round,
            round,
            sign,
        })
    }

    /// Whether the body has its way whatever it meets: its centre is pinned.
    pub fn is_led(&self) -> bool {
        self.inverse_mass == 0.0
    }

    /// Change of the velocity of a point at the end of a lever (m) by an impulse there: a matrix
    /// (1/kg).
    pub fn mobility(&self, arm: &Arm) -> Matrix3<f64> {
        let cross = arm.lever.cross_matrix();
        Matrix3::identity() * self.inverse_mass - cross * self.inverse_inertia * cross
    }

    /// Changes the body's motion by an impulse (N s) at an arm, but for its points, which
    /// [`settle`](Self::settle) moves.
    pub fn push(&self, arm: &Arm, impulse: Vector3<f64>, field: &mut Field) {
        let change = &mut field.changes[arm.solid];
        change.along += impulse * (arm.sign * self.inverse_mass);
        change.turned += self.inverse_inertia * arm.lever.cross(&impulse) * arm.sign;
    }

    /// The angular velocity (rad/s) and the inverse of the inertia (1/(kg m2)) at a time `left` (s)
    /// before the end of the step, that is after a share of it, where its angular velocity at the
    /// end is `spin`.
    pub fn at(&self, spin: Vector3<f64>, share: f64, left: f64) -> (Vector3<f64>, Matrix3<f64>) {
        let back = UnitQuaternion::new_unchecked(turn(spin * -left));
        let back = back.to_rotation_matrix().into_inner();
        let inverse_inertia = back * self.inverse_inertia * back.transpose();
        let momentum = self.ends[0].momentum.lerp(&(self.inertia * spin), share);
        (inverse_inertia * momentum, inverse_inertia)
    }

    /// Changes the motion of this body, which is number k, by an impulse (N s) at the end of a
    /// lever (m), times a span, but for its points, which [`settle`](Self::settle) moves.
    pub fn push_at(
        &self,
        k: usize,
        lever: Vector3<f64>,
        impulse: Vector3<f64>,
        span: f64,
        field: &mut Field,
    ) {
        let change = &mut field.changes[k];
        change.along += impulse * (span * self.inverse_mass);
        change.turned += self.inverse_inertia * lever.cross(&impulse) * span;
    }

    /// Angular momentum (kg m2/s) of the body about a point (m) at the end of the step, with its
    /// centre at x (m).
    pub fn turning(
        &self,
        (x, v): (Vector3<f64>, Vector3<f64>),
        spin: Vector3<f64>,
        about: Vector3<f64>,
    ) -> Vector3<f64> {
        (x - about).cross(&(v / self.inverse_mass)) + self.inertia * spin
    }

    /// Angular velocity (rad/s) that an angular momentum (kg m2/s) gives the body.
    pub fn spun(&self, momentum: Vector3<f64>) -> Vector3<f64> {
        self.inverse_inertia * momentum
    }

    /// Changes the velocities of the points by an angular velocity (rad/s).
    pub fn spin_points(&self, spin: Vector3<f64>, field: &mut Field) {
        for (i, lever) in self.points.clone().zip(&self.arms) {
            field.points[i] += spin.cross(lever);
        }
    }

    /// Gives the points of this body, which is number k, what impulses changed of it. Returns
    /// whether they did.
    pub fn settle(&self, k: usize, field: &mut Field) -> bool {
        let Change { along, turned } = std::mem::take(&mut field.changes[k]);
        field.turns[k] += turned;
        field.points[self.center] += along;
        for (i, lever) in self.points.clone().zip(&self.arms) {
            field.points[i] += along + turned.cross(lever);
        }
        along != Vector3::zeros() || turned != Vector3::zeros()
    }

    /// Takes the points of this body, which is number k and began at x0 (m), to where its rotation
    /// has them at the end of the step.
    pub fn bend(&self, k: usize, x0: &[Vector3<f64>], moves: &mut Field) {
        let by = UnitQuaternion::new_unchecked(turn(moves.turns[k] - self.unguarded[0]));
        let center = x0[self.center] + moves.points[self.center];
        for (i, arm) in self.points.clone().zip(&self.arms) {
            moves.points[i] = center + by * arm - x0[i];
        }
    }

    /// The rotation vector of the step (rad) if only that share is made of a step whose rotation
    /// vector is `turned`.
    pub fn shortened(&self, turned: Vector3<f64>, share: f64) -> Vector3<f64> {
        let [start, end] = self.ends.map(|rotation| rotation.q);
        let whole = rotation_vector(self.orientation(turned), start);
        self.unguarded[0] + rotation_vector(turn(whole * share) * start, end)
    }

    /// The orientation at the end of a step with that rotation vector (rad).
    fn orientation(&self, turned: Vector3<f64>) -> Quaternion<f64> {
        let (way, q) = (self.unguarded[0], self.ends[1].q);
        if turned == way {
            q
        } else {
            turn(turned - way) * q
        }
    }

    /// The rotation and angular momentum at the end of the step, whose rotation vector (rad) the
    /// guard has made `turned`, and whose angular velocity `turning` (rad/s).
    pub fn end(&self, turned: Vector3<f64>, turning: Vector3<f64>) -> Rotation {
        let spin = self.unguarded[1];
        let mut momentum = self.ends[1].momentum;
        if turning != spin {
            momentum += self.inertia * (turning - spin);
        }
        Rotation {
            q: self.orientation(turned),
            momentum,
        }
    }
}

impl Arm {
    /// Whether another arm of the body ends at the same point.
    pub fn is_at(&self, other: &Self) -> bool {
        (self.lever - other.lever).norm() < SAME * self.lever.norm()
    }

    /// The part of the velocity of the point of contact that the points of its body do not have: a
    /// round body's turn beyond the closest point of its simplices, and what is not settled.
    pub fn beyond_points(&self, field: &Field) -> Vector3<f64> {
        let Change { along, turned } = field.changes[self.solid];
        let roll = field.turns[self.solid].cross(&self.round);
        (roll + along + turned.cross(&self.lever)) * self.sign
    }
}
