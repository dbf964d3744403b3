//! Variables of particles, rigid bodies and springs that can be plotted, and their values at one
//! time.

use crate::session::rows;

/// Kind of what is plotted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Particle,
    Body,
    Spring,
}

/// A variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variable {
    X,
    Y,
    Z,
    VelocityX,
    VelocityY,
    VelocityZ,
    Speed,
    Kinetic,
    Potential,
    Energy,
    SpinX,
    SpinY,
    SpinZ,
    Length,
    Strain,
    Force,
}

impl Variable {
    /// All variables, in the order of their buttons.
    pub const ALL: [Self; 16] = [
        Self::X,
        Self::Y,
        Self::Z,
        Self::VelocityX,
        Self::VelocityY,
        Self::VelocityZ,
        Self::Speed,
        Self::Kinetic,
        Self::Potential,
        Self::Energy,
        Self::SpinX,
        Self::SpinY,
        Self::SpinZ,
        Self::Length,
        Self::Strain,
        Self::Force,
    ];

    /// Returns the name on the button, the name on an axis, and the unit.
    fn words(self) -> [&'static str; 3] {
        match self {
            Self::X => ["x", "x", "m"],
            Self::Y => ["y", "y", "m"],
            Self::Z => ["z", "z", "m"],
            Self::VelocityX => ["vx", "vx", "m/s"],
            Self::VelocityY => ["vy", "vy", "m/s"],
            Self::VelocityZ => ["vz", "vz", "m/s"],
            Self::Speed => ["speed", "speed", "m/s"],
            Self::Kinetic => ["kinetic", "kinetic energy", "J"],
            Self::Potential => ["potential", "potential energy", "J"],
            Self::Energy => ["energy", "energy", "J"],
            Self::SpinX => ["ωx", "angular velocity x", "rad/s"],
            Self::SpinY => ["ωy", "angular velocity y", "rad/s"],
            Self::SpinZ => ["ωz", "angular velocity z", "rad/s"],
            Self::Length => ["length", "length", "m"],
            Self::Strain => ["strain", "strain", ""],
            Self::Force => ["force", "force", "N"],
        }
    }

    /// Returns the short name.
    pub fn name(self) -> &'static str {
        self.words()[0]
    }

    /// Returns the unit; empty for a ratio.
    pub fn unit(self) -> &'static str {
        self.words()[2]
    }

    /// Returns the name with the unit.
    pub fn label(self) -> String {
        match self.words() {
            [_, name, ""] => name.into(),
            [_, name, unit] => format!("{name} ({unit})"),
        }
    }

    /// Returns whether things of a kind have the variable.
    pub fn is_of(self, kind: Kind) -> bool {
        let of_spring = matches!(self, Self::Length | Self::Strain | Self::Force);
        let of_body = matches!(self, Self::SpinX | Self::SpinY | Self::SpinZ);
        match kind {
            Kind::Particle => !of_spring && !of_body,
            Kind::Body => !of_spring,
            Kind::Spring => of_spring,
        }
    }

    /// Returns the value in a row of something that has the variable.
    pub fn of(self, row: &Row) -> f64 {
        let values = &row.values;
        match self {
            Self::X | Self::Length => values[0],
            Self::Y | Self::Strain => values[1],
            Self::Z | Self::Force => values[2],
            Self::VelocityX => values[3],
            Self::VelocityY => values[4],
            Self::VelocityZ => values[5],
            Self::Speed => values[3].hypot(values[4]).hypot(values[5]),
            Self::Kinetic => values[6],
            Self::Potential => values[7],
            Self::Energy => values[6] + values[7],
            Self::SpinX => values[8],
            Self::SpinY => values[9],
            Self::SpinZ => values[10],
        }
    }

    /// Returns whether this is a coordinate of a place.
    pub fn is_coordinate(self) -> bool {
        matches!(self, Self::X | Self::Y | Self::Z)
    }

    /// Returns the velocity of a coordinate; that of x for any other variable.
    pub fn velocity(self) -> Self {
        match self {
            Self::Y => Self::VelocityY,
            Self::Z => Self::VelocityZ,
            _ => Self::VelocityX,
        }
    }
}

/// Number of values of a row.
pub const VALUES: usize = 11;

/// Values of a pick at one time. Of a spring: length (m), strain and force (N), above 0 when it
/// pulls. Otherwise: position (m), velocity (m/s), kinetic and potential energy (J), and the
/// angular velocity (rad/s) of a rigid body. A value that is not known is NaN.
pub type Row = rows::Row<[f64; VALUES]>;
