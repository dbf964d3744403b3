//! The energy in a state of a network.

use super::Network;
use crate::energy::Energy;

impl Network {
    /// The energy in the state (x, v) at time 0, and at all times if no obstacle moves. Drag,
    /// damping and wind have none.
    #[must_use]
    pub fn energy(&self, x: &[f64], v: &[f64]) -> Energy {
        self.energy_at(0.0, x, v)
    }

    /// The energy in the state (x, v) at time t (s), where obstacles are then.
    #[must_use]
    pub fn energy_at(&self, t: f64, x: &[f64], v: &[f64]) -> Energy {
        let of_axis = |v: &[f64]| -> f64 {
            let of_one = |(v, m): (&f64, &f64)| 0.5 * m * v * v;
            v.iter().zip(&self.masses).map(of_one).sum()
        };
        let mut energy = Energy {
            kinetic: v.chunks_exact(self.particles()).map(of_axis).sum(),
            ..Energy::default()
        };
        for element in &self.elements {
            energy += element.force().energy(&self.at(t, x, v));
        }
        energy
    }

    /// Energy of the state y at time t (s), that of rotations included.
    #[must_use]
    pub fn energy_of(&self, t: f64, y: &[f64]) -> Energy {
        let (x, v) = self.halves(y);
        let mut energy = self.energy_at(t, x, v);
        for (k, body) in self.bodies.iter().enumerate() {
            energy.kinetic += body.energy(&self.rotation(k, y));
        }
        energy
    }
}
