//! The energy in a state of a network.

use super::Network;
use crate::contact::Obstacle;
use crate::elements::Element;
use crate::energy::Energy;
use crate::path::Path;
use crate::random::SplitMix;

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

    /// Energy (J) of errors of all positions, of up to so much (m), at y at time t (s): elastic,
    /// and of the motion that corrects a drift off constraints.
    pub(crate) fn energy_of_errors(&self, t: f64, y: &[f64], error: f64) -> f64 {
        let (mut off, mut random) = (y.to_vec(), SplitMix(1));
        for x in &mut off[..3 * self.particles()] {
            *x += random.between(-error, error);
        }
        let elastic = self.energy_of(t, &off).elastic - self.energy_of(t, y).elastic;
        let mass = self.masses().iter().sum::<f64>();
        let correction = 0.5 * mass * (error * self.correction_rate()).powi(2);
        let all = elastic.max(0.0) + correction;
        if all.is_finite() { all } else { 0.0 }
    }

    /// Adds the forces of wind (N) in the state (x, v) at time t (s) to f.
    pub(crate) fn add_wind(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        for element in &self.elements {
            if matches!(element, Element::Wind(_) | Element::Airflow(_)) {
                element.force().add_forces(&self.at(t, x, v), f);
            }
        }
    }

    /// Whether the forces leave the energy as it is: nothing is damped, blows or moves by itself,
    /// and no spring is kept short or breaks. What obstacles do is left out.
    pub(crate) fn is_conservative(&self) -> bool {
        let loses = |element: &Element| {
            let force = element.force();
            let carried = force.carried().is_some_and(|carried| carried.drag > 0.0);
            let blows = matches!(element, Element::Wind(_) | Element::Attraction(_));
            carried || blows || force.carried().is_none() && force.reads_velocity()
        };
        let mut paths = self.pins().map(|(_, path)| path);
        !self.elements.iter().any(loses)
            && paths.all(|path| matches!(path, Path::Still(_)))
            && self.obstacles().iter().all(Obstacle::is_still)
            && self.strain_limits.is_empty()
    }
}
