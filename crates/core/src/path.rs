//! Where something that is led by the hand is, as a function of time.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Position, velocity and acceleration of a point on a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// In m.
    pub position: Vector3<f64>,
    /// In m/s.
    pub velocity: Vector3<f64>,
    /// In m/s2.
    pub acceleration: Vector3<f64>,
}

impl Place {
    /// At rest at `position`.
    #[must_use]
    pub fn still(position: Vector3<f64>) -> Self {
        Self {
            position,
            velocity: Vector3::zeros(),
            acceleration: Vector3::zeros(),
        }
    }
}

/// Path of a pin or of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Path {
    /// Stays there.
    Still(#[serde(with = "crate::serial")] Vector3<f64>),
    /// `center + amplitude sin(rate t + phase)`.
    Sine {
        /// In m.
        #[serde(with = "crate::serial")]
        center: Vector3<f64>,
        /// In m.
        #[serde(with = "crate::serial")]
        amplitude: Vector3<f64>,
        /// In rad/s.
        rate: f64,
        /// In rad.
        phase: f64,
    },
    /// From `from` at time `start` in a straight line to `to` at time `end`; at rest before and after.
    Line {
        /// In m.
        #[serde(with = "crate::serial")]
        from: Vector3<f64>,
        /// In m.
        #[serde(with = "crate::serial")]
        to: Vector3<f64>,
        /// In s.
        start: f64,
        /// In s, later than `start`
        end: f64,
    },
}

impl Path {
    /// The place at time t (s).
    #[must_use]
    pub fn at(&self, t: f64) -> Place {
        match *self {
            Self::Still(position) => Place::still(position),
            Self::Sine {
                center,
                amplitude,
                rate,
                phase,
            } => {
                let (sin, cos) = libm::sincos(rate * t + phase);
                Place {
                    position: center + amplitude * sin,
                    velocity: amplitude * (rate * cos),
                    acceleration: amplitude * (-rate * rate * sin),
                }
            }
            Self::Line {
                from,
                to,
                start,
                end,
            } => {
                if t < start {
                    Place::still(from)
                } else if t >= end {
                    Place::still(to)
                } else {
                    let velocity = (to - from) / (end - start);
                    Place {
                        position: from + velocity * (t - start),
                        velocity,
                        acceleration: Vector3::zeros(),
                    }
                }
            }
        }
    }
}
