//! Prescribed motion of pins and obstacles as a function of time.

use nalgebra::Vector3;
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
    /// Place of a point at rest at `position` (m).
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
}

impl Path {
    /// Position, velocity and acceleration at time t (s).
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
