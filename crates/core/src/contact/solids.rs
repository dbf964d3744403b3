//! Rigid bodies in a step of the collision safeguard: their mobilities, and the effect of impulses.

use std::ops::{Deref, DerefMut, Range};

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use super::surface::Surface;
use crate::rigid::{Body, Rotation, rotation_vector, turn};

/// Largest distance of two points of contact that count as one, over that from the body's centre;
/// also the largest difference of their normals.
pub(super) const SAME_TOLERANCE: f64 = 1e-6;

/// A vector for each vertex, and one for each rigid body: displacements (m) and rotation vectors
/// (rad), or velocities (m/s) and angular velocities (rad/s).
#[derive(Clone, Debug, Default)]
pub(super) struct Field {
    pub points: Vec<Vector3<f64>>,
    pub turns: Vec<Vector3<f64>>,
    /// Changes of each rigid body by impulses that its points and turn do not include yet.
    changes: Vec<Change>,
}

/// Change of a rigid body: of its centre, and of its rotation.
#[derive(Clone, Copy, Debug, Default)]
struct Change {
    along: Vector3<f64>,
    turned: Vector3<f64>,
}

impl Field {
    /// Creates a field of zeros for n vertices and a number of bodies.
    pub fn still(n: usize, solids: usize) -> Self {
        Self {
            points: vec![Vector3::zeros(); n],
            turns: vec![Vector3::zeros(); solids],
            changes: vec![Change::default(); solids],
        }
    }

    /// Forgets all bodies.
    pub fn forget_solids(&mut self) {
        self.turns.clear();
        self.changes.clear();
    }

    /// Returns the turn of a body, with that by impulses that its points do not include yet.
    fn turn(&self, solid: usize) -> Vector3<f64> {
        self.turns[solid] + self.changes[solid].turned
    }

    /// Returns the vectors of a body, number k, with that centre: of the centre, and of the turn.
    pub fn of_solid(&self, k: usize, center: usize) -> [Vector3<f64>; 2] {
        [self.points[center] + self.changes[k].along, self.turn(k)]
    }

    /// Changes the centre and the turn of a body, number k.
    pub fn change(&mut self, k: usize, [along, turned]: [Vector3<f64>; 2]) {
        self.changes[k].along += along;
        self.changes[k].turned += turned;
    }

    /// Adds a body with that turn.
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
    /// Points relative to the centre (m).
    arms: Vec<Vector3<f64>>,
    /// Orientation and angular momentum at both ends of the step.
    ends: [Rotation; 2],
    /// Rotation vector of the step (rad) and angular velocity at its end (rad/s) before the
    /// safeguard.
    unguarded: [Vector3<f64>; 2],
}

/// Side of a contact that is a rigid body.
#[derive(Clone, Copy)]
pub(super) struct Arm {
    pub solid: usize,
    /// Point of contact relative to the centre (m).
    pub lever: Vector3<f64>,
    /// Point of contact relative to the closest point of the body's simplices (m): not 0 on round
    /// bodies.
    pub round: Vector3<f64>,
    /// 1 for the first primitive of a pair, -1 for the second.
    pub sign: f64,
    pub inverse_mass: f64,
    /// Change of the angular velocity of the body by an angular impulse (1/(kg m2)).
    pub inverse_inertia: Matrix3<f64>,
}

impl Solid {
    /// Creates a body at the end of a step between these ends, with its rotation vector in the step
    /// (rad) and the angular velocities at both ends (rad/s).
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

    /// Returns the arm of a point of contact on the body that the vertices belong to, whose weights
    /// give the closest point of its simplices.
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
            inverse_mass: own.inverse_mass,
            inverse_inertia: own.inverse_inertia,
        })
    }

    /// Returns whether the body is kinematic: its centre is pinned.
    pub fn is_kinematic(&self) -> bool {
        self.inverse_mass == 0.0
    }

    /// Returns the angular velocity (rad/s) and the inverse inertia (1/(kg m2)) `left` (s) and the
    /// share `share` of the step before its end, if the angular velocity at the end is `spin`, and
    /// lags behind the course by `lag` (rad/s).
    pub fn before(
        &self,
        [spin, lag]: [Vector3<f64>; 2],
        share: f64,
        left: f64,
    ) -> (Vector3<f64>, Matrix3<f64>) {
        let back = UnitQuaternion::new_unchecked(turn(spin * -left));
        let back = back.to_rotation_matrix().into_inner();
        let inverse_inertia = back * self.inverse_inertia * back.transpose();
        let gain = self.ends[1].momentum - self.ends[0].momentum;
        let momentum = self.inertia * spin - gain * share;
        (inverse_inertia * momentum + lag, inverse_inertia)
    }

    /// Returns the angular momentum (kg m2/s) of the body about a point (m) at the end of the step,
    /// with its centre at x (m).
    pub fn turning(
        &self,
        (x, v): (Vector3<f64>, Vector3<f64>),
        spin: Vector3<f64>,
        about: Vector3<f64>,
    ) -> Vector3<f64> {
        (x - about).cross(&(v / self.inverse_mass)) + self.inertia * spin
    }

    /// Returns the change of the angular velocity by an angular impulse at the end of the step
    /// (1/(kg m2)).
    pub fn inverse_inertia(&self) -> Matrix3<f64> {
        self.inverse_inertia
    }

    /// Returns the angular velocity (rad/s) that an angular momentum (kg m2/s) gives the body.
    pub fn spun(&self, momentum: Vector3<f64>) -> Vector3<f64> {
        self.inverse_inertia * momentum
    }

    /// Changes the velocities of the points by an angular velocity (rad/s).
    pub fn spin_points(&self, spin: Vector3<f64>, field: &mut Field) {
        for (i, lever) in self.points.clone().zip(&self.arms) {
            field.points[i] += spin.cross(lever);
        }
    }

    /// Applies the changes of this body, number k, by impulses to its turn and its points. Returns
    /// whether there were any.
    pub fn settle(&self, k: usize, field: &mut Field) -> bool {
        let Change { along, turned } = std::mem::take(&mut field.changes[k]);
        field.turns[k] += turned;
        field.points[self.center] += along;
        for (i, lever) in self.points.clone().zip(&self.arms) {
            field.points[i] += along + turned.cross(lever);
        }
        along != Vector3::zeros() || turned != Vector3::zeros()
    }

    /// Moves the points of this body, number k, which began at x0 (m), to their places by its
    /// rotation at the end of the step.
    pub fn rotate_points(&self, k: usize, x0: &[Vector3<f64>], moves: &mut Field) {
        let by = UnitQuaternion::new_unchecked(turn(moves.turns[k] - self.unguarded[0]));
        let center = x0[self.center] + moves.points[self.center];
        for (i, arm) in self.points.clone().zip(&self.arms) {
            moves.points[i] = center + by * arm - x0[i];
        }
    }

    /// Returns the rotation vector (rad) of a step whose rotation vector is `turned`, if only a
    /// share of its turn is made.
    pub fn shortened(&self, turned: Vector3<f64>, share: f64) -> Vector3<f64> {
        let [start, end] = self.ends.map(|rotation| rotation.q);
        let whole = rotation_vector(self.orientation(turned), start);
        self.unguarded[0] + rotation_vector(turn(whole * share) * start, end)
    }

    /// Returns the orientation at the end of a step with that rotation vector (rad).
    fn orientation(&self, turned: Vector3<f64>) -> Quaternion<f64> {
        let (way, q) = (self.unguarded[0], self.ends[1].q);
        if turned == way { q } else { turn(turned - way) * q }
    }

    /// Returns the rotation and angular momentum at the end of the step, if the safeguard has
    /// changed its rotation vector (rad) to `turned`, and its angular velocity to `turning`
    /// (rad/s).
    pub fn end(&self, turned: Vector3<f64>, turning: Vector3<f64>) -> Rotation {
        let spin = self.unguarded[1];
        let mut momentum = self.ends[1].momentum;
        if turning != spin {
            momentum += self.inertia * (turning - spin);
        }
        Rotation { q: self.orientation(turned), momentum }
    }
}

impl Arm {
    /// Returns the turn of the body, with the sign of its side.
    pub fn turn(&self, field: &Field) -> Vector3<f64> {
        field.turn(self.solid) * self.sign
    }

    /// Returns the change of the velocity of the point of contact by an impulse there: a matrix
    /// (1/kg).
    pub fn mobility(&self) -> Matrix3<f64> {
        let cross = self.lever.cross_matrix();
        Matrix3::identity() * self.inverse_mass - cross * self.inverse_inertia * cross
    }

    /// Changes the body's motion by an impulse (N s) on its side, except that of its points, which
    /// [`Solid::settle`] moves.
    pub fn push(&self, impulse: Vector3<f64>, field: &mut Field) {
        let turned = self.inverse_inertia * self.lever.cross(&impulse) * self.sign;
        let along = impulse * (self.sign * self.inverse_mass);
        field.change(self.solid, [along, turned]);
    }

    /// Gives the body an angular impulse (N m s), with the sign of its side.
    pub fn spin(&self, impulse: Vector3<f64>, field: &mut Field) {
        let turned = self.inverse_inertia * impulse * self.sign;
        field.change(self.solid, [Vector3::zeros(), turned]);
    }

    /// Returns whether another arm is of the same body, and ends at the same point.
    pub fn is_at(&self, other: &Self) -> bool {
        self.solid == other.solid
            && (self.lever - other.lever).norm() < SAME_TOLERANCE * self.lever.norm()
    }

    /// Returns the velocity of the point of contact beyond that of its body's points: by the turn
    /// of a round body beyond the closest point of its simplices, and by changes that are not
    /// settled.
    pub fn beyond_points(&self, field: &Field) -> Vector3<f64> {
        let Change { along, turned } = field.changes[self.solid];
        let roll = field.turns[self.solid].cross(&self.round);
        (roll + along + turned.cross(&self.lever)) * self.sign
    }
}
