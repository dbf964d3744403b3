//! Energy of a state, by kind.

use std::ops::AddAssign;

/// Energy of a state by kind (J). The gravitational energy is zero at the origin.
///
/// ```
/// let energy = a3_core::Energy { kinetic: 2.0, gravitational: -3.0, ..Default::default() };
/// assert_eq!(energy.total(), -1.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Kinetic energy, m v2 / 2 (J).
    pub kinetic: f64,
    /// Elastic energy (J) of springs, k (L - r)2 / 2, of bent arcs, of solids and of compressed
    /// fluid.
    pub elastic: f64,
    /// Energy of the repulsion of surfaces that are nearer than their thickness (J).
    pub contact: f64,
    /// Gravitational energy, -m g . x (J).
    pub gravitational: f64,
}

impl Energy {
    /// Returns the sum of all kinds (J).
    #[must_use]
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic + self.contact + self.gravitational
    }
}

impl AddAssign for Energy {
    fn add_assign(&mut self, other: Self) {
        self.kinetic += other.kinetic;
        self.elastic += other.elastic;
        self.contact += other.contact;
        self.gravitational += other.gravitational;
    }
}
