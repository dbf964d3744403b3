//! Variables of particles, rigid bodies, springs, rods and the whole scene that can be plotted, and
//! their values at one time.

use crate::session::rows;

/// Kind of what is plotted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Particle,
    Body,
    Spring,
    /// A rod or a rope.
    Rod,
    Scene,
}

impl Kind {
    /// Returns the phase plane with which plots of this kind begin.
    pub fn plane(self) -> [Variable; 2] {
        match self {
            Self::Particle | Self::Body => [Variable::X, Variable::VelocityX],
            Self::Spring => [Variable::Length, Variable::Force],
            Self::Rod => [Variable::Angle, Variable::SpinZ],
            Self::Scene => [Variable::Kinetic, Variable::Potential],
        }
    }
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
    Elastic,
    Contact,
    Gravitational,
    Potential,
    Energy,
    Angle,
    Tilt,
    SpinX,
    SpinY,
    SpinZ,
    Length,
    Strain,
    Force,
}

impl Variable {
    /// All variables, in the order of their buttons.
    pub const ALL: [Self; 21] = [
        Self::X,
        Self::Y,
        Self::Z,
        Self::VelocityX,
        Self::VelocityY,
        Self::VelocityZ,
        Self::Speed,
        Self::Kinetic,
        Self::Elastic,
        Self::Contact,
        Self::Gravitational,
        Self::Potential,
        Self::Energy,
        Self::Angle,
        Self::Tilt,
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
            Self::Elastic => ["elastic", "elastic energy", "J"],
            Self::Contact => ["contact", "energy of contact", "J"],
            Self::Gravitational => ["gravity", "gravitational energy", "J"],
            Self::Potential => ["potential", "potential energy", "J"],
            Self::Energy => ["energy", "energy", "J"],
            Self::Angle => ["angle", "angle", "rad"],
            Self::Tilt => ["tilt", "angle to the vertical", "rad"],
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

    /// Returns the name on an axis.
    pub fn long_name(self) -> &'static str {
        self.words()[1]
    }

    /// Returns whether things of a kind have the variable.
    pub fn is_of(self, kind: Kind) -> bool {
        match self {
            Self::X | Self::Y | Self::Z | Self::Speed => {
                kind == Kind::Particle || kind == Kind::Body
            }
            Self::VelocityX | Self::VelocityY | Self::VelocityZ => Self::X.is_of(kind),
            Self::Kinetic | Self::Potential | Self::Energy => {
                Self::X.is_of(kind) || kind == Kind::Scene
            }
            Self::Elastic => matches!(kind, Kind::Particle | Kind::Spring | Kind::Scene),
            Self::Gravitational => kind == Kind::Particle || kind == Kind::Scene,
            Self::Contact => kind == Kind::Scene,
            Self::Angle | Self::Tilt | Self::SpinZ => {
                matches!(kind, Kind::Body | Kind::Spring | Kind::Rod)
            }
            Self::SpinX | Self::SpinY => kind == Kind::Body,
            Self::Length => kind == Kind::Spring || kind == Kind::Rod,
            Self::Strain | Self::Force => kind == Kind::Spring,
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
            Self::Elastic => values[7],
            Self::Gravitational => values[8],
            Self::Contact => values[9],
            Self::Potential => values[7] + values[8] + values[9],
            Self::Energy => values[6] + values[7] + values[8] + values[9],
            Self::SpinX => values[10],
            Self::SpinY => values[11],
            Self::SpinZ => values[12],
            Self::Angle => values[ANGLE],
            Self::Tilt => values[14],
        }
    }

    /// Returns whether this is a coordinate of a place, or an angle.
    pub fn is_coordinate(self) -> bool {
        matches!(self, Self::X | Self::Y | Self::Z | Self::Angle)
    }

    /// Returns the velocity of a coordinate or of an angle; that of x for any other variable.
    pub fn velocity(self) -> Self {
        match self {
            Self::Angle => Self::SpinZ,
            Self::Y => Self::VelocityY,
            Self::Z => Self::VelocityZ,
            _ => Self::VelocityX,
        }
    }
}

/// Number of values of a row.
pub const VALUES: usize = 15;
/// Place of the angle among them.
pub const ANGLE: usize = 13;

/// Values of a pick at one time. Of a spring, or a rod without the last two: length (m), strain and
/// force (N), above 0 when it pulls. Otherwise: position (m). Then of all: velocity (m/s), kinetic,
/// elastic, gravitational and contact energy (J), angular velocity (rad/s), and two angles (rad). A
/// value that is not known is NaN.
///
/// Seen from the front, along z, the first angle is that of a spring or a rod from straight down,
/// or of a body's own x axis from the right, both anticlockwise. The second one is that in space of
/// the spring or rod to straight down, or of the body's own y axis to straight up.
pub type Row = rows::Row<[f64; VALUES]>;
