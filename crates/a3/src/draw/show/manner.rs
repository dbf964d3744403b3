//! Options for a picture of a run.

use a3_render::Style;

use super::quantity::{Arrows, Quantity};

/// A particle or an obstacle, by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    Particle(usize),
    Obstacle(usize),
}

impl Target {
    /// Returns the number of the particle, if the target is one.
    pub fn particle(self) -> Option<usize> {
        match self {
            Self::Particle(i) => Some(i),
            Self::Obstacle(_) => None,
        }
    }
}

/// The first look of a run.
#[derive(Clone, Copy, Default)]
pub struct Manner {
    /// Surface, wires or springs.
    pub style: Style,
    /// The particle whose springs are highlighted.
    pub springs_of: Option<usize>,
    /// Whether the projection is orthographic, not perspective.
    pub orthographic: bool,
    /// Whether the background is dark and text is light.
    pub dark: bool,
    /// Quantity that colours the particles.
    pub colour: Option<Quantity>,
    /// Arrows on particles.
    pub arrows: Option<Arrows>,
}
