//! Particles of a fluid, and the boxes in which they leave it for good.

use nalgebra::Vector3;

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
    /// Returns whether a place (m) is inside, or at most `slack` (m) outside.
    #[must_use]
    pub fn contains(&self, place: &Vector3<f64>, slack: f64) -> bool {
        let from_centre = (place - self.at).abs();
        (0..3).all(|axis| from_centre[axis] <= self.half[axis] + slack)
    }
}

/// Particles of a fluid by their numbers, and those that have left it.
#[derive(Clone, Debug)]
pub struct Members {
    flowing: Vec<u32>,
    drained: Vec<u32>,
    outflows: Vec<Outflow>,
}

impl Members {
    /// Creates a list of particles, given by their numbers in any order.
    ///
    /// # Errors
    /// A particle is named twice.
    pub(super) fn new(mut particles: Vec<u32>) -> Result<Self, Error> {
        particles.sort_unstable();
        let twice = particles.windows(2).find(|pair| pair[0] == pair[1]);
        if let Some([i, ..]) = twice {
            let why = format!("particle {i} is named twice in a fluid");
            return Err(Error::Invalid(why));
        }
        Ok(Self {
            flowing: particles,
            drained: vec![],
            outflows: vec![],
        })
    }

    /// Sets the boxes in which particles leave.
    ///
    /// # Errors
    /// An edge is not a finite number above 0.
    pub(super) fn set_outflows(&mut self, outflows: Vec<Outflow>) -> Result<(), Error> {
        let mut edges = outflows.iter().flat_map(|outflow| outflow.half.iter());
        edges.try_for_each(|edge| positive("half an edge of an outflow", *edge))?;
        self.outflows = outflows;
        Ok(())
    }

    /// Sets which particles have left: these, given in order. All others flow.
    pub(super) fn set_drained(&mut self, drained: &[u32]) {
        let mut all = std::mem::take(&mut self.flowing);
        all.append(&mut self.drained);
        all.sort_unstable();
        let is_drained = |i: &u32| drained.binary_search(i).is_ok();
        (self.drained, self.flowing) = all.into_iter().partition(is_drained);
    }

    /// Returns the numbers of the particles that have not left, in order.
    #[must_use]
    pub fn flowing(&self) -> &[u32] {
        &self.flowing
    }

    /// Returns the numbers of the particles that have left, in order.
    #[must_use]
    pub fn drained(&self) -> &[u32] {
        &self.drained
    }

    /// Returns the boxes in which particles leave.
    #[must_use]
    pub fn outflows(&self) -> &[Outflow] {
        &self.outflows
    }

    /// Returns whether particle i has left.
    #[must_use]
    pub fn has_left(&self, i: usize) -> bool {
        self.drained.binary_search(&(i as u32)).is_ok()
    }

    /// Returns whether particle i is one of these, or has left.
    #[must_use]
    pub fn contains(&self, i: usize) -> bool {
        self.flowing.binary_search(&(i as u32)).is_ok() || self.has_left(i)
    }
}
