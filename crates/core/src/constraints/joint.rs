//! Joints of rigid bodies: what they let free, and their equations in a state.
//!
//! A joint has a frame on each of its two sides, which turns with the body of that side; the second
//! side may be the world, and the first one of a ball joint a particle. Let d be the place of the
//! first frame seen from the second, `a_i` and `u_j` the axes of the two, and `w_1`, `w_2` the
//! angular velocities of their bodies. The equations are of three forms, each with its rate:
//!
//! ```text
//! C = e . d            C' = e . d'                        along an axis e of the world
//! C = u_j . d          C' = u_j . d' + w_2 . (u_j x d)    along an axis of the second body
//! C = L a_i . u_j      C' = L (w_1 - w_2) . (a_i x u_j)   two axes at a right angle
//! ```
//!
//! L is a length, so that errors of directions are distances, too. A ball joint has three equations
//! of the first form; a hinge has these, and `a_1` is perpendicular to `u_2` and `u_3`; where
//! bodies are fixed to each other, `a_2` is perpendicular to `u_3` as well. A slider has these
//! three right angles, and two equations of the second form, across its axis `u_1` (Haug, *Computer
//! Aided Kinematics and Dynamics of Mechanical Systems*, 1989).

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix3, Vector3};

use crate::columns::row;
use crate::error::{Error, positive};
use crate::geometry::normals;
use crate::path::Pose;

/// What a joint lets free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// All rotations: both sides have a point in common.
    Ball,
    /// The rotation about an axis.
    Hinge,
    /// The displacement along an axis.
    Slider,
    /// Nothing.
    Fixed,
}

/// Joint between a rigid body, or a particle, and another body or the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// What it lets free.
    pub kind: JointKind,
    /// Centre of the first body; a particle of no body may be on a ball joint.
    pub first: usize,
    /// Centre of the second body; `None` for the world.
    pub second: Option<usize>,
    /// Places of the joint on each side: from the centre of the body along its principal axes, or
    /// in the world (m).
    pub anchors: [Vector3<f64>; 2],
    /// Axes of the joint on each side, as columns, along the principal axes of the body or in the
    /// world. The first is that of a hinge or a slider.
    pub axes: [Matrix3<f64>; 2],
    /// Length at whose end errors of directions count (m).
    pub length: f64,
}

/// End of what a joint lets free: the largest or the least angle of a hinge, or displacement of a
/// slider, of the first body relative to the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// The hinge or the slider.
    pub joint: Joint,
    /// Least and largest angle (rad) or displacement (m).
    pub limits: [f64; 2],
    /// Whether it stops at the largest.
    pub is_upper: bool,
    /// Coefficient of restitution, from 0 to 1: the speed after the joint has reached its end, over
    /// that before.
    pub restitution: f64,
}

/// Side of a joint in a state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// Place and velocity of the joint (m, m/s).
    place: Vector3<f64>,
    velocity: Vector3<f64>,
    /// From the centre of the body to that place (m).
    arm: Vector3<f64>,
    /// Angular velocity (rad/s).
    spin: Vector3<f64>,
    /// Axes of the joint in the world.
    axes: Matrix3<f64>,
}

/// Equation of a joint in a state.
#[derive(Default)]
pub(super) struct JointEquation {
    /// Error C (m), its rate of change, and what of its second derivative no acceleration causes.
    pub value: f64,
    pub rate: f64,
    pub bend: f64,
    /// Gradient by the position of the first centre; by that of the second, it is opposite.
    pub gradient: Vector3<f64>,
    /// Gradients by rotations of the two bodies (m).
    pub levers: [Vector3<f64>; 2],
}

impl JointKind {
    /// Returns its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ball => "ball joint",
            Self::Hinge => "hinge",
            Self::Slider => "slider",
            Self::Fixed => "fixed joint",
        }
    }
}

impl Joint {
    /// Creates a joint at a point (m) between a body and either another body or the world (`None`).
    /// A body is given by its centre and its pose; instead of the first one, a particle of no body
    /// is given with the pose of its place. A hinge turns about the axis, a slider moves along it;
    /// the axis may have any length but 0. Errors of directions count at the end of a length (m).
    ///
    /// # Errors
    /// The axis has no length.
    pub fn new(
        kind: JointKind,
        (first, second): ((usize, &Pose), Option<(usize, &Pose)>),
        (at, axis): (Vector3<f64>, Vector3<f64>),
        length: f64,
    ) -> Result<Self, Error> {
        positive("the length of an axis", axis.norm())?;
        let axis = axis.normalize();
        let [side, other] = normals(axis);
        let frame = Matrix3::from_columns(&[axis, side, other]);
        let seen = [Some(first), second].map(|of| match of {
            Some((_, pose)) => {
                let d = at - pose.place.position;
                let columns = [0, 1, 2].map(|k| pose.inwards(frame.column(k).into_owned()));
                (pose.inwards(d), Matrix3::from_columns(&columns))
            }
            None => (at, frame),
        });
        Ok(Self {
            kind,
            first: first.0,
            second: second.map(|(i, _)| i),
            anchors: seen.map(|(anchor, _)| anchor),
            axes: seen.map(|(_, axes)| axes),
            length,
        })
    }

    /// Returns the number of its equations.
    pub(super) fn count(&self) -> usize {
        match self.kind {
            JointKind::Ball => 3,
            JointKind::Hinge | JointKind::Slider => 5,
            JointKind::Fixed => 6,
        }
    }

    /// Returns the same joint, or an error if its numbers are invalid.
    pub(super) fn check(&self) -> Result<(), Error> {
        positive("the length of a joint", self.length)?;
        if self.second == Some(self.first) {
            return Err(Error::Invalid(
                "a joint needs two different bodies, or one and the world".into(),
            ));
        }
        let right = |axes: &Matrix3<f64>| (axes.tr_mul(axes) - Matrix3::identity()).norm() < 1e-9;
        if self.anchors.iter().flatten().all(|x| x.is_finite()) && self.axes.iter().all(right) {
            return Ok(());
        }
        Err(Error::Invalid(
            "the place of a joint must be finite, and its axes perpendicular, of length 1".into(),
        ))
    }

    /// Checks what it joins. `is_center` returns whether a particle is the centre of a body, or
    /// `None` if it is on no body.
    pub(super) fn check_bodies(
        &self,
        is_center: impl Fn(usize) -> Option<bool>,
    ) -> Result<(), Error> {
        let first = is_center(self.first);
        let second = self.second.map(|i| is_center(i) == Some(true));
        let is_body = first == Some(true) && second != Some(false);
        let is_attached = first.is_none() && second == Some(true);
        if is_body || is_attached && self.kind == JointKind::Ball {
            return Ok(());
        }
        Err(Error::Invalid(
            "a joint names the centres of one or two rigid bodies, and a ball joint may hold a \
             particle of no body to a body"
                .into(),
        ))
    }

    /// Returns its sides in the state (x, v). `turned` returns the rotation matrix and the angular
    /// velocity of the body on a side, if there is one.
    pub(super) fn sides(
        &self,
        [x, v]: [&[f64]; 2],
        turned: impl Fn(usize) -> Option<(Matrix3<f64>, Vector3<f64>)>,
    ) -> [Side; 2] {
        let n = x.len() / 3;
        [(0, Some(self.first)), (1, self.second)].map(|(k, center)| {
            let (rotation, spin) =
                turned(k).unwrap_or_else(|| (Matrix3::identity(), Vector3::zeros()));
            let anchor = rotation * self.anchors[k];
            let (place, velocity, arm) = match center {
                Some(i) => (row(x, n, i) + anchor, row(v, n, i) + spin.cross(&anchor), anchor),
                None => (anchor, Vector3::zeros(), Vector3::zeros()),
            };
            Side { place, velocity, arm, spin, axes: rotation * self.axes[k] }
        })
    }

    /// Returns the equation of a number with these sides.
    pub(super) fn equation(&self, number: usize, sides: &[Side; 2]) -> JointEquation {
        let [own, other] = sides;
        match (self.kind, number) {
            (JointKind::Slider, 0 | 1) => {
                let axis = other.axes.column(number + 1).into_owned();
                along(own, other, axis, Some(other.spin))
            }
            (JointKind::Slider, k) => self.right_angle(own, other, k - 2),
            (_, 0..=2) => {
                let mut axis = Vector3::zeros();
                axis[number] = 1.0;
                along(own, other, axis, None)
            }
            (_, k) => self.right_angle(own, other, k - 3),
        }
    }

    /// Returns the equation that two axes are perpendicular: one of three.
    fn right_angle(&self, own: &Side, other: &Side, number: usize) -> JointEquation {
        let (i, j) = [(0, 1), (0, 2), (1, 2)][number];
        let (a, u) = (own.axes.column(i), other.axes.column(j));
        let lever = a.cross(&u) * self.length;
        let spin = own.spin - other.spin;
        let change = own.spin.cross(&a).cross(&u) + a.cross(&other.spin.cross(&u));
        JointEquation {
            value: a.dot(&u) * self.length,
            rate: spin.dot(&lever),
            bend: spin.dot(&change) * self.length,
            gradient: Vector3::zeros(),
            levers: [lever, -lever],
        }
    }
}

impl Stop {
    /// Checks the kind of the joint, and the limits.
    pub(super) fn check(&self) -> Result<(), Error> {
        self.joint.check()?;
        check_restitution("the end of a joint", self.restitution)?;
        let [least, most] = self.limits;
        let right = match self.joint.kind {
            JointKind::Hinge => most - least < TAU,
            JointKind::Slider => true,
            JointKind::Ball | JointKind::Fixed => false,
        };
        if right && least.is_finite() && most.is_finite() && least < most {
            return Ok(());
        }
        Err(Error::Invalid(format!(
            "only a hinge and a slider have limits: the first below the second, and for a hinge in \
             radians, by less than a whole turn, 6.283; not {least} and {most}"
        )))
    }

    /// Returns its equation with these sides. The error is negative between the limits.
    pub(super) fn equation(&self, [own, other]: &[Side; 2]) -> JointEquation {
        let axis = other.axes.column(0).into_owned();
        let (sign, bound) =
            if self.is_upper { (1.0, self.limits[1]) } else { (-1.0, self.limits[0]) };
        let mut equation = match self.joint.kind {
            JointKind::Hinge => {
                let (spin, lever) = (own.spin - other.spin, axis * self.joint.length);
                JointEquation {
                    value: self.angle(own, other) * self.joint.length,
                    rate: spin.dot(&lever),
                    bend: spin.dot(&other.spin.cross(&lever)),
                    gradient: Vector3::zeros(),
                    levers: [lever, -lever],
                }
            }
            _ => along(own, other, axis, Some(other.spin)),
        };
        let bound = match self.joint.kind {
            JointKind::Hinge => bound * self.joint.length,
            _ => bound,
        };
        equation.value = sign * (equation.value - bound);
        equation.rate *= sign;
        equation.bend *= sign;
        equation.gradient *= sign;
        equation.levers = equation.levers.map(|lever| lever * sign);
        equation
    }

    /// Returns the angle of a hinge (rad), within half a turn of the middle of its limits.
    fn angle(&self, own: &Side, other: &Side) -> f64 {
        let (side, [_, u, w]) = (own.axes.column(1), [0, 1, 2].map(|j| other.axes.column(j)));
        let middle = 0.5 * (self.limits[0] + self.limits[1]);
        let off = libm::atan2(side.dot(&w), side.dot(&u)) - middle;
        middle + off - TAU * ((off + PI) / TAU).floor()
    }
}

/// Returns the equation that the sides are at the same place along an axis, which turns with the
/// second body at this angular velocity (rad/s), or not at all.
fn along(
    own: &Side,
    other: &Side,
    axis: Vector3<f64>,
    spin: Option<Vector3<f64>>,
) -> JointEquation {
    let (d, velocity) = (own.place - other.place, own.velocity - other.velocity);
    // An axis of the second body acts on it where it acts on the first.
    let arm = other.arm + spin.map_or_else(Vector3::zeros, |_| d);
    let spin = spin.unwrap_or_default();
    let turn = spin.cross(&axis);
    let inwards = |side: &Side| side.spin.cross(&side.spin.cross(&side.arm));
    JointEquation {
        value: axis.dot(&d),
        rate: axis.dot(&velocity) + turn.dot(&d),
        bend: axis.dot(&(inwards(own) - inwards(other)))
            + 2.0 * turn.dot(&velocity)
            + spin.cross(&turn).dot(&d),
        gradient: axis,
        levers: [own.arm.cross(&axis), -arm.cross(&axis)],
    }
}

/// Checks that a coefficient of restitution is from 0 to 1.
pub(super) fn check_restitution(of: &str, restitution: f64) -> Result<(), Error> {
    if (0.0..=1.0).contains(&restitution) {
        return Ok(());
    }
    Err(Error::Invalid(format!("the restitution of {of} must be from 0 to 1, not {restitution}")))
}
