//! Cords: springs that only pull. A cord of rest length r whose ends are farther apart than that
//! pulls them together with the force k (L - r) + c L', unless that is negative. Otherwise it hangs
//! slack, without force. The force is continuous where a cord tightens slowly; its damping begins
//! there at once.

use super::axial::{self, Elastic};
use super::force::{At, Cost, Force, Matter, check_ends, ends};
use crate::coupling::Coupling;
use crate::energy::Energy;
use crate::error::Error;
use crate::spring::Spring;

/// Springs that only pull.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cords(Vec<Cord>);

impl Cords {
    /// Creates cords with the laws of springs, in the order given.
    pub fn new(springs: impl IntoIterator<Item = Spring>) -> Self {
        Self(springs.into_iter().map(Cord).collect())
    }

    /// Returns the springs that the cords are while they are taut, in their order.
    pub fn springs(&self) -> impl Iterator<Item = Spring> {
        self.0.iter().map(|cord| cord.0)
    }
}

impl Force for Cords {
    fn name(&self) -> &'static str {
        "springs that only pull"
    }

    fn matter(&self) -> Option<Matter> {
        Some(Matter::Elastic)
    }

    fn check(&self, particles: usize) -> Result<(), Error> {
        self.0.iter().try_for_each(|cord| check_ends(cord.ends(), particles))
    }

    fn add_forces(&self, at: &At, f: &mut [f64]) {
        axial::add_all(&self.0, at.x, at.v, f);
    }

    fn add_differential(&self, at: &At, d: [&[f64]; 2], df: &mut [f64]) {
        for cord in &self.0 {
            axial::add_differential(cord, at, d, df);
        }
    }

    fn couplings(&self, _t: f64, x: &[f64], clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        for cord in &self.0 {
            visit(axial::coupling(cord, x, clamped));
        }
    }

    fn energy(&self, at: &At) -> Energy {
        axial::energy(self.0.iter().copied(), at.x)
    }

    fn reads_velocity(&self) -> bool {
        self.0.iter().any(|cord| cord.0.law.damping > 0.0)
    }

    fn cost(&self) -> Cost {
        let couplings = self.0.len() as f64;
        Cost { couplings, price: couplings }
    }

    fn scale(&mut self, stiffness: f64, damping: f64) {
        for cord in &mut self.0 {
            cord.0.law.scale(stiffness, damping);
        }
    }

    fn remove_springs(&mut self, torn: &[[usize; 2]]) {
        self.0.retain(|cord| torn.binary_search(&ends(&cord.0)).is_err());
    }
}

/// Spring that only pulls.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cord(Spring);

impl Cord {
    fn is_taut(&self, length: f64) -> bool {
        length > self.0.law.rest_length
    }
}

impl Elastic for Cord {
    const ONLY_PULLS: bool = true;

    #[inline]
    fn ends(&self) -> [usize; 2] {
        self.0.ends()
    }

    #[inline]
    fn pull(&self, length: f64) -> f64 {
        self.0.pull(length).max(0.0)
    }

    #[inline]
    fn stiffness(&self, length: f64) -> f64 {
        if self.is_taut(length) { self.0.law.stiffness } else { 0.0 }
    }

    fn energy(&self, length: f64) -> f64 {
        if self.is_taut(length) { self.0.energy(length) } else { 0.0 }
    }

    #[inline]
    fn damping(&self, length: f64) -> f64 {
        if self.is_taut(length) { self.0.law.damping } else { 0.0 }
    }
}
