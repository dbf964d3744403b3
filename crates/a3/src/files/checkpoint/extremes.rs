//! Extremes of a run, which its checkpoints store for the summary at its end.

use a3_core::Simulation;
use serde::{Deserialize, Serialize};

/// Total energy (J).
#[derive(Clone, Copy, Serialize, Deserialize)]
pub struct Energy {
    /// At the start.
    pub begin: f64,
    /// At the end.
    pub end: f64,
    /// Largest distance from the energy at the start.
    pub largest_drift: f64,
}

/// Extremes of energy and stretch.
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
pub struct Extremes {
    /// The total energy; none for a system without forces.
    pub energy: Option<Energy>,
    /// Largest length over rest length of a spring; none without springs.
    pub stretch: Option<f64>,
}

impl Extremes {
    /// Updates the extremes with the present state.
    pub fn observe(&mut self, simulation: &Simulation) {
        if let Some(total) = simulation.energy().map(|energy| energy.total()) {
            let energy = self.energy.get_or_insert(Energy {
                begin: total,
                end: total,
                largest_drift: 0.0,
            });
            energy.end = total;
            energy.largest_drift = energy.largest_drift.max((total - energy.begin).abs());
        }
        if let Some(stretch) = simulation.largest_stretch() {
            self.stretch = Some(self.stretch.map_or(stretch, |most| most.max(stretch)));
        }
    }

    /// Returns all numbers.
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        let energy = self.energy.into_iter();
        let energies = energy.flat_map(|e| [e.begin, e.end, e.largest_drift]);
        energies.chain(self.stretch)
    }

    /// Returns a copy whose stretch is not a number.
    #[cfg(test)]
    pub fn spoiled(self) -> Self {
        Self {
            stretch: Some(f64::NAN),
            ..self
        }
    }
}
