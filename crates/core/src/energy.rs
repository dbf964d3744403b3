//! Energy by kind.

use std::ops::AddAssign;

/// Energy by kind (J). That of gravity is zero at the origin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Kinetic energy, m v2 / 2 (J).
    pub kinetic: f64,
    /// Elastic energy, k (L - r)2 / 2 of a spring, and that of bent arcs and of compressed fluid
    /// (J).
    pub elastic: f64,
    /// Energy of surfaces that are nearer than their thickness (J).
    pub contact: f64,
    /// Gravitational energy, -m g . x (J).
    pub gravitational: f64,
}

impl Energy {
    /// Sum of all kinds (J).
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
