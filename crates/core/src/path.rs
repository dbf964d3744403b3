//! Prescribed motion of pins and obstacles as a function of time.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Position, velocity and acceleration of a point of a path at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Position (m).
    pub position: Vector3<f64>,
    /// Velocity (m/s).
    pub velocity: Vector3<f64>,
    /// Acceleration (m/s2).
    pub acceleration: Vector3<f64>,
}

impl Place {
    /// Creates the place of a point at rest at `position` (m).
    #[must_use]
    pub fn still(position: Vector3<f64>) -> Self {
        Self { position, velocity: Vector3::zeros(), acceleration: Vector3::zeros() }
    }
}

/// Uniform turn about an axis between two times; at rest before and after. It turns anticlockwise
/// to someone who looks against the axis.
///
/// ```
/// use a3_core::{Turn, Vector3};
///
/// let turn = Turn { axis: Vector3::z(), rate: 0.5, start: 1.0, end: Some(3.0) };
/// assert_eq!(turn.at(0.0), (0.0, 0.0));
/// assert_eq!(turn.at(2.0), (0.5, 0.5));
/// assert_eq!(turn.at(9.0), (1.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Turn {
    /// Direction of the axis: a unit vector.
    #[serde(with = "crate::serial")]
    pub axis: Vector3<f64>,
    /// Angular velocity (rad/s).
    pub rate: f64,
    /// Time at which the turn starts (s).
    pub start: f64,
    /// Time at which the turn ends (s), later than `start`; `None` if it never ends.
    pub end: Option<f64>,
}

impl Turn {
    /// Returns the angle since the start (rad) and the angular velocity (rad/s) at time t (s).
    #[must_use]
    pub fn at(&self, t: f64) -> (f64, f64) {
        let angle = |t: f64| self.rate * (t - self.start);
        match self.end {
            _ if t < self.start => (0.0, 0.0),
            Some(end) if t >= end => (angle(end), 0.0),
            _ => (angle(t), self.rate),
        }
    }

    /// Returns the times at which the turn starts and ends (s).
    pub(crate) fn known_times(&self) -> [f64; 2] {
        [self.start, self.end.unwrap_or(f64::INFINITY)]
    }

    /// Returns whether the body turns at any time in an interval (s).
    pub(crate) fn is_on(&self, [from, to]: [f64; 2]) -> bool {
        self.rate != 0.0 && from < self.end.unwrap_or(f64::INFINITY) && to > self.start
    }

    /// Returns the orientation at time t (s), relative to that before the start.
    #[must_use]
    pub fn orientation(&self, t: f64) -> Orientation {
        let (angle, rate) = self.at(t);
        Orientation { rotation: rotation(self.axis * angle), spin: self.axis * rate }
    }
}

/// Returns the matrix of a rotation about a vector by its length (rad), by Rodrigues' formula.
#[must_use]
pub fn rotation(about: Vector3<f64>) -> Matrix3<f64> {
    let angle = about.norm();
    let (sin, cos) = libm::sincos(angle);
    let axis = if angle > 0.0 { about / angle } else { Vector3::zeros() };
    let turned =
        |e: Vector3<f64>| e * cos + axis.cross(&e) * sin + axis * (axis.dot(&e) * (1.0 - cos));
    Matrix3::from_columns(&[Vector3::x(), Vector3::y(), Vector3::z()].map(turned))
}

/// Orientation of a body that turns uniformly, at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation {
    /// Rotation matrix, from the axes of the body to those of the world.
    pub rotation: Matrix3<f64>,
    /// Angular velocity (rad/s), along the axis.
    pub spin: Vector3<f64>,
}

/// Place and orientation of a body at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Place of the body's origin.
    pub place: Place,
    /// Orientation; `None` for a body that never turns.
    pub orientation: Option<Orientation>,
}

impl Pose {
    /// Returns the place of a point of the body, given relative to the origin before any turn (m).
    #[must_use]
    pub fn of(&self, point: Vector3<f64>) -> Place {
        let Place { position, velocity, acceleration } = self.place;
        match self.orientation {
            None => Place { position: position + point, ..self.place },
            Some(Orientation { rotation, spin }) => {
                let arm = rotation * point;
                let along = spin.cross(&arm);
                Place {
                    position: position + arm,
                    velocity: velocity + along,
                    acceleration: acceleration + spin.cross(&along),
                }
            }
        }
    }

    /// Converts a vector from the axes of the world to those of the body.
    #[must_use]
    pub fn inwards(&self, vector: Vector3<f64>) -> Vector3<f64> {
        self.orientation.map_or(vector, |turned| turned.rotation.tr_mul(&vector))
    }

    /// Converts a vector from the axes of the body to those of the world.
    #[must_use]
    pub fn outwards(&self, vector: Vector3<f64>) -> Vector3<f64> {
        self.orientation.map_or(vector, |turned| turned.rotation * vector)
    }
}

/// Path of a pin or of an obstacle.
///
/// ```
/// use a3_core::{Path, Vector3};
///
/// let lift = Path::Line {
///     from: Vector3::zeros(),
///     to: Vector3::new(0.0, 3.0, 0.0),
///     start: 1.0,
///     end: 2.5,
/// };
/// assert_eq!(lift.at(0.5).velocity.y, 0.0);
/// assert_eq!((lift.at(2.0).position.y, lift.at(2.0).velocity.y), (2.0, 2.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Path {
    /// Point at rest at this position (m).
    Still(#[serde(with = "crate::serial")] Vector3<f64>),
    /// Harmonic motion: `center + amplitude sin(rate t + phase)`.
    Sine {
        /// Centre (m).
        #[serde(with = "crate::serial")]
        center: Vector3<f64>,
        /// Amplitude (m).
        #[serde(with = "crate::serial")]
        amplitude: Vector3<f64>,
        /// Angular frequency (rad/s).
        rate: f64,
        /// Phase at t = 0 (rad).
        phase: f64,
    },
    /// Uniform motion in a straight line from `from` at time `start` to `to` at time `end`; at rest
    /// before and after.
    Line {
        /// First position (m).
        #[serde(with = "crate::serial")]
        from: Vector3<f64>,
        /// Last position (m).
        #[serde(with = "crate::serial")]
        to: Vector3<f64>,
        /// Time at which the motion starts (s).
        start: f64,
        /// Time at which the motion ends (s), later than `start`.
        end: f64,
    },
    /// Turn about an axis that moves uniformly, without turning itself, from `from` at time `start`
    /// to `to` at time `end`, and is at rest before and after.
    Turn {
        /// The turn.
        turn: Turn,
        /// Position relative to the axis before the turn (m).
        #[serde(with = "crate::serial")]
        arm: Vector3<f64>,
        /// First position of a point of the axis (m).
        #[serde(with = "crate::serial")]
        from: Vector3<f64>,
        /// Last position of that point (m).
        #[serde(with = "crate::serial")]
        to: Vector3<f64>,
        /// Time at which the axis starts to move (s).
        start: f64,
        /// Time at which the axis stops (s), not earlier than `start`.
        end: f64,
    },
}

impl Path {
    /// Returns the position, velocity and acceleration at time t (s).
    #[must_use]
    pub fn at(&self, t: f64) -> Place {
        match *self {
            Self::Still(position) => Place::still(position),
            Self::Sine { center, amplitude, rate, phase } => {
                let (sin, cos) = libm::sincos(rate * t + phase);
                Place {
                    position: center + amplitude * sin,
                    velocity: amplitude * (rate * cos),
                    acceleration: amplitude * (-rate * rate * sin),
                }
            }
            Self::Line { from, to, start, end } => line([from, to], [start, end], t),
            Self::Turn { turn, arm, from, to, start, end } => {
                let axis = Pose {
                    place: line([from, to], [start, end], t),
                    orientation: Some(turn.orientation(t)),
                };
                axis.of(arm)
            }
        }
    }

    /// Returns the same motion elsewhere, displaced by a vector (m).
    #[must_use]
    pub fn moved(mut self, by: Vector3<f64>) -> Self {
        match &mut self {
            Self::Still(position) => *position += by,
            Self::Sine { center, .. } => *center += by,
            Self::Line { from, to, .. } | Self::Turn { from, to, .. } => {
                *from += by;
                *to += by;
            }
        }
        self
    }

    /// Returns whether the point is at rest at time t (s) and ever after.
    #[must_use]
    pub fn is_still_from(&self, t: f64) -> bool {
        match self {
            Self::Still(_) => true,
            Self::Sine { .. } => false,
            Self::Line { end, .. } => t >= *end,
            Self::Turn { turn, end, .. } => t >= *end && turn.end.is_some_and(|end| t >= end),
        }
    }

    /// Returns the length (m) of the motion: its amplitude, or the distance of its ends.
    pub(crate) fn length(&self) -> f64 {
        match *self {
            Self::Still(_) => 0.0,
            Self::Sine { amplitude, .. } => amplitude.norm(),
            Self::Line { from, to, .. } => (to - from).norm(),
            Self::Turn { arm, from, to, .. } => (to - from).norm().max(arm.norm()),
        }
    }

    /// Returns the times at which the motion begins or ends (s). Some may be infinite or occur
    /// twice.
    pub(crate) fn known_times(&self) -> [f64; 4] {
        match self {
            Self::Still(_) | Self::Sine { .. } => [f64::INFINITY; 4],
            Self::Line { start, end, .. } => [*start, *end, *start, *end],
            Self::Turn { turn, start, end, .. } => {
                let [from, to] = turn.known_times();
                [*start, *end, from, to]
            }
        }
    }

    /// Returns the longest step (s) that resolves the motion in an interval (s): a quarter of its
    /// period; infinite if the motion has none then.
    pub(crate) fn quarter_period(&self, times: [f64; 2]) -> f64 {
        let rate = match self {
            Self::Sine { rate, .. } => *rate,
            Self::Turn { turn, .. } if turn.is_on(times) => turn.rate,
            _ => 0.0,
        };
        0.5 * std::f64::consts::PI / rate.abs()
    }

    /// Returns bounds on the speed (m/s) and on the acceleration (m/s2) in an interval (s). The
    /// acceleration is infinite where the motion begins or ends within it.
    pub(crate) fn bounds(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        let uniform = |way: Vector3<f64>, start: f64, end: f64| {
            if from < end && to > start && end > start { way.norm() / (end - start) } else { 0.0 }
        };
        let [speed, acceleration] = match self {
            Self::Still(_) => [0.0; 2],
            Self::Sine { amplitude, rate, .. } => {
                [1, 2].map(|power| amplitude.norm() * rate.abs().powi(power))
            }
            Self::Line { from: a, to: b, start, end } => [uniform(b - a, *start, *end), 0.0],
            Self::Turn { turn, arm, from: a, to: b, start, end } => {
                let rate = if turn.is_on([from, to]) { turn.rate.abs() } else { 0.0 };
                let along = uniform(b - a, *start, *end);
                [along + rate * arm.norm(), rate * rate * arm.norm()]
            }
        };
        let changes = self.known_times().iter().any(|t| from < *t && *t < to);
        [speed, if changes { f64::INFINITY } else { acceleration }]
    }
}

/// Returns the place at time t (s) of uniform motion between two positions (m) in an interval (s).
fn line([from, to]: [Vector3<f64>; 2], [start, end]: [f64; 2], t: f64) -> Place {
    if t < start {
        Place::still(from)
    } else if t >= end {
        Place::still(to)
    } else {
        let velocity = (to - from) / (end - start);
        Place { position: from + velocity * (t - start), velocity, acceleration: Vector3::zeros() }
    }
}
