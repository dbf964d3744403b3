//! The fluid of a network, and its walls.

use super::Network;
use crate::elements::{Element, Fluid};

impl Network {
    /// The fluid, if there is one.
    #[must_use]
    pub fn fluid(&self) -> Option<&Fluid> {
        self.elements.iter().find_map(Element::fluid)
    }

    /// Whether particle i is in a wall: pinned, and of the fluid.
    #[must_use]
    pub fn is_wall(&self, i: usize) -> bool {
        self.is_pinned(i) && self.fluid().is_some_and(|fluid| fluid.contains(i))
    }
}
