//! Particles of a fluid, and the boxes in which they leave it for good.

use nalgebra::Vector3;

use super::Fluid;
use crate::error::{Error, positive};

/// Box in which particles of a fluid leave it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outflow {
    /// Centre (m).
    pub at: Vector3<f64>,
    /// Half of the edges (m).
    pub half: Vector3<f64>,
}

impl Outflow {
    /// Whether a place (m) is inside, or at most `slack` (m) outside.
    #[must_use]
    pub fn contains(&self, place: &Vector3<f64>, slack: f64) -> bool {
        let from_centre = (place - self.at).abs();
        (0..3).all(|axis| from_centre[axis] <= self.half[axis] + slack)
    }
}

impl Fluid {
    /// Returns the numbers of the fluid's particles, without those that have left it, in order.
    #[must_use]
    pub fn particles(&self) -> &[u32] {
        &self.particles
    }

    /// Whether particle i is of the fluid, or has left it.
    #[must_use]
    pub fn contains(&self, i: usize) -> bool {
        self.particles.binary_search(&(i as u32)).is_ok() || self.has_left(i)
    }

    /// Whether particle i has left the fluid.
    #[must_use]
    pub fn has_left(&self, i: usize) -> bool {
        self.drained.binary_search(&(i as u32)).is_ok()
    }

    /// Sets the boxes in which particles leave the fluid; a new one has none.
    ///
    /// # Errors
    /// An edge is not a finite number above 0.
    pub fn with_outflows(mut self, outflows: Vec<Outflow>) -> Result<Self, Error> {
        let mut edges = outflows.iter().flat_map(|outflow| outflow.half.iter());
        edges.try_for_each(|edge| positive("half an edge of an outflow", *edge))?;
        self.outflows = outflows;
        Ok(self)
    }

    /// Returns the boxes in which particles leave the fluid.
    #[must_use]
    pub fn outflows(&self) -> &[Outflow] {
        &self.outflows
    }

    /// Returns the numbers of the particles that have left the fluid, in order.
    #[must_use]
    pub fn drained(&self) -> &[u32] {
        &self.drained
    }

    /// Lets exactly these particles, given in order, have left the fluid. The others are back.
    pub(crate) fn set_drained(&mut self, drained: &[u32]) {
        let mut all = std::mem::take(&mut self.particles);
        all.append(&mut self.drained);
        all.sort_unstable();
        let is_drained = |i: &u32| drained.binary_search(i).is_ok();
        (self.drained, self.particles) = all.into_iter().partition(is_drained);
    }
}
