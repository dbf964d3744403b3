//! What a picture of a run is asked to show.

use a3_render::Style;

use super::quantity::{Arrows, Quantity};

/// A particle or an obstacle, by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    Particle(usize),
    Obstacle(usize),
}

impl Target {
    /// The number of the particle, if it is one.
    pub fn particle(self) -> Option<usize> {
        match self {
            Self::Particle(i) => Some(i),
            Self::Obstacle(_) => None,
        }
    }
}

/// The manner in which a run is shown at first.
#[derive(Clone, Copy, Default)]
pub struct Manner {
    /// Surface, wires or springs.
    pub style: Style,
    /// The particle whose springs are highlighted.
    pub springs_of: Option<usize>,
    /// Whether the projection is orthographic, not perspective.
    pub orthographic: bool,
    /// Whether the background is dark, and text light.
    pub dark: bool,
    /// What particles are coloured by.
    pub colour: Option<Quantity>,
    /// Arrows on particles.
    pub arrows: Option<Arrows>,
}
