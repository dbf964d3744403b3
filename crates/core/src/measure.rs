//! Quantities that numbers of a state stand for.

/// Quantity that numbers of a state stand for. Errors of different quantities are not compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// Numbers of any units and sizes, each with its own.
    Plain,
    /// Numbers of one unit and one size, such as the coordinates of points.
    Alike,
    /// Positions (m).
    Position,
    /// Velocities (m/s).
    Velocity,
    /// Quaternion of a rigid body, of any length but 0.
    Rotation {
        /// Radius of the body (m).
        radius: f64,
    },
    /// Angular momentum of a rigid body (kg m2/s).
    Momentum {
        /// Speed of the body's surface over the angular momentum (1/(kg m)).
        speed: f64,
    },
}
