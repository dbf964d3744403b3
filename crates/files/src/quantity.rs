//! The quantity by which models of a scene are compared.

/// Quantity by which models of a scene are compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quantity {
    /// Positions of the particles, root mean square (m)
    #[default]
    Position,
    /// Path of the centre of mass (m)
    Centre,
    /// Energy that the motion has gained or lost since the start (J)
    Energy,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Position, Self::Centre, Self::Energy];

    /// Returns the name of the quantity.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Centre => "centre",
            Self::Energy => "energy",
        }
    }
}
