//! A network as methods see it that solve spring by spring.

use super::Network;
use crate::elements::Element;
use crate::spring::SpringLaw;
use crate::system::{Compliant, Linearized};

impl Network {
    /// Whether springs of one stiffness and damping each are all that couples particles.
    pub(super) fn is_compliant(&self) -> bool {
        let is_no_spring = |e: &Element| {
            matches!(e, Element::BucklingSprings(_) | Element::Solid(_)) && !e.is_empty()
        };
        let flows = self.fluid().is_some();
        !self.is_constrained() && !flows && !self.elements.iter().any(is_no_spring)
    }
}

impl Compliant for Network {
    /// Those of sheets direction by direction, then the single ones.
    fn springs(&self, visit: &mut dyn FnMut([usize; 2], SpringLaw)) {
        for element in &self.elements {
            element.springs().for_each(|s| visit([s.i, s.j], s.law));
        }
    }

    fn other_forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        f.fill(0.0);
        let is_other = |e: &&Element| !e.is_elastic() && !matches!(e, Element::Drag(_));
        for element in self.elements.iter().filter(is_other) {
            element.force().add_forces(&self.at(t, x, v), f);
        }
    }

    fn drag_coefficient(&self) -> f64 {
        Linearized::drag_coefficient(self)
    }
}
