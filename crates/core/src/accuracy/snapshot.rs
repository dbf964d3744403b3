//! Snapshot of a state: the quantities by which states are compared.

use nalgebra::Vector3;

use super::errors::{Errors, Scope};
use super::hermite::weights;
use super::impact::Impact;
use crate::elements::force::distance;
use crate::integrators::add_scaled;
use crate::network::Network;
use crate::scene::Model;
use crate::spring::SpringKind;
use crate::system::Mechanics;

/// Quantities of a state that are compared.
#[derive(Clone, Debug, Default)]
pub(super) struct Snapshot {
    /// Number of particles.
    particles: usize,
    /// Positions (m): all x, all y, all z. Without particles, all numbers of the state.
    positions: Vec<f64>,
    /// Velocities (m/s): the rates of change of these.
    velocities: Vec<f64>,
    /// Total energy (J); 0 for a first-order scene.
    energy: f64,
    /// Momentum of the particles that are not pinned (kg m/s); 0 for a first-order scene.
    momentum: Vector3<f64>,
    /// Length over rest length of each structural spring.
    strains: Vec<f64>,
    /// Largest depth of penetration over the thickness.
    penetration: f64,
    /// First impact so far.
    impact: Impact,
}

impl Snapshot {
    /// Creates a snapshot of the state y of a model at time t (s), at which a run starts.
    pub fn of(model: &Model, t: f64, y: &[f64]) -> Self {
        let Some(network) = model.network() else {
            let (positions, velocities) = model.motion(t, y);
            return Self {
                particles: model.particles(),
                positions: positions.to_vec(),
                velocities: velocities.into_owned(),
                ..Self::default()
            };
        };
        let penetration = network.contact_layer();
        let penetration =
            penetration.map_or(0.0, |layer| layer.penetration(t, network.halves(y).0));
        Self {
            energy: network.energy_of(t, y).total(),
            penetration,
            impact: Impact::at_start(t),
            ..Self::of_motion(network, y)
        }
    }

    /// Creates a snapshot of the quantities that follow from positions and velocities alone; the
    /// rest is 0.
    fn of_motion(network: &Network, y: &[f64]) -> Self {
        let (positions, velocities) = network.halves(y);
        let inverse_masses = network.inverse_masses();
        let momentum = Vector3::from_fn(|axis, _| {
            let n = inverse_masses.len();
            let column = velocities[axis * n..(axis + 1) * n].iter();
            let free = column.zip(inverse_masses).filter(|(_, w)| **w > 0.0);
            free.map(|(v, w)| v / w).sum()
        });
        Self {
            momentum,
            strains: structural(network)
                .map(|s| distance(positions, s.i, s.j) / s.law.rest_length)
                .collect(),
            particles: inverse_masses.len(),
            positions: positions.to_vec(),
            velocities: velocities.to_vec(),
            ..Self::default()
        }
    }

    /// Creates a snapshot of the state y of a model at time t (s), of the quantities that are
    /// compared between frames: without those of contact, and without the energy if contact or
    /// rotations contribute to it.
    pub fn between_frames(model: &Model, t: f64, y: &[f64]) -> Self {
        let Some(network) = model.network() else {
            return Self::of(model, t, y);
        };
        let of_more = network.contact_layer().is_some() || !network.bodies().is_empty();
        Self {
            energy: if of_more {
                f64::INFINITY
            } else {
                network.energy_of(t, y).total()
            },
            ..Self::of_motion(network, y)
        }
    }

    /// Creates a snapshot at time t (s), interpolated from known times (s): positions by the
    /// polynomial through positions and velocities, all other quantities by that through the
    /// values.
    pub fn interpolated(model: &Model, known: &[(f64, &Self)], t: f64) -> Self {
        // Times are in units of their distance, so that the weights are of ordinary size.
        let (first, last) = (known[0].0, known[known.len() - 1].0);
        let unit = (last - first) / (known.len() - 1) as f64;
        let nodes: Vec<_> = known
            .iter()
            .map(|(time, _)| (time - first) / unit)
            .collect();
        let [of_values, of_both] = [1, 2].map(|count| weights(&nodes, count, (t - first) / unit));
        let mut y = vec![0.0; known[0].1.positions.len() + known[0].1.velocities.len()];
        let (x, v) = y.split_at_mut(known[0].1.positions.len());
        let (mut energy, mut momentum) = (0.0, Vector3::zeros());
        for (k, (_, node)) in known.iter().enumerate() {
            add_scaled(x, of_both[2 * k], &node.positions);
            add_scaled(x, of_both[2 * k + 1] * unit, &node.velocities);
            add_scaled(v, of_values[k], &node.velocities);
            energy += of_values[k] * node.energy;
            momentum += of_values[k] * node.momentum;
        }
        let at = match model.network() {
            Some(network) => Self::of_motion(network, &y),
            None => Self {
                particles: model.particles(),
                positions: x.to_vec(),
                velocities: v.to_vec(),
                ..Self::default()
            },
        };
        Self {
            energy,
            momentum,
            ..at
        }
    }

    /// Creates the next snapshot of a run after this one, of the state y of a model at time t (s).
    pub fn next(&self, model: &Model, t: f64, y: &[f64]) -> Self {
        let mut next = Self::of(model, t, y);
        if let Some(layer) = model.network().and_then(Network::contact_layer) {
            let ends = [self, &next].map(|s| [&*s.positions, &*s.velocities]);
            let touch = [self, &next].map(|s| s.penetration > 0.0);
            next.impact = self.impact.next(layer, t, ends, touch);
        } else {
            next.impact = self.impact.later(t);
        }
        next
    }

    /// Returns the snapshot at time t (s) if nothing moves any more.
    pub fn still(&self, t: f64) -> Self {
        Self {
            impact: self.impact.still(t, self.penetration > 0.0),
            ..self.clone()
        }
    }

    /// Returns the positions (m): all x, all y, all z.
    pub fn positions(&self) -> &[f64] {
        &self.positions
    }

    /// Returns the positions (m) and velocities (m/s), or the numbers of the state and their rates
    /// of change.
    pub fn motion(&self) -> [Vec<f64>; 2] {
        [self.positions.clone(), self.velocities.clone()]
    }

    /// Returns the errors of another snapshot of the same scene against this one, which is exact.
    /// The phase is not yet divided by the [`square_speed`](Self::square_speed).
    pub fn errors_of(&self, other: &Self, scope: Scope) -> Errors {
        let springs = self.strains.len().max(1) as f64;
        let stretch = self.strains.iter().zip(&other.strains);
        let moved = || {
            let pairs = self.positions.iter().zip(&other.positions);
            pairs.map(|(own, other)| other - own)
        };
        let along = moved().zip(&self.velocities).map(|(d, v)| d * v);
        let distance = self.mean(scope, moved().map(|d| d * d)).sqrt();
        let (position, state) = match self.particles {
            0 => (0.0, distance),
            _ => (distance, 0.0),
        };
        Errors {
            position,
            state,
            energy: (self.energy - other.energy).abs(),
            strain: (stretch.map(|(a, b)| (a - b).powi(2)).sum::<f64>() / springs).sqrt(),
            momentum: (self.momentum - other.momentum).norm(),
            phase: self.mean(scope, along).abs(),
            penetration: (self.penetration - other.penetration).abs(),
            impact: self.impact.error_of(&other.impact),
        }
    }

    /// Returns the mean square speed of the particles in the scope (m2/s2).
    pub fn square_speed(&self, scope: Scope) -> f64 {
        self.mean(scope, self.velocities.iter().map(|v| v * v))
    }

    /// Returns the sum over the axes of the mean over the particles in the scope; without
    /// particles, the mean.
    fn mean(&self, scope: Scope, numbers: impl Iterator<Item = f64>) -> f64 {
        let n = match self.particles {
            0 => self.positions.len(),
            n => n,
        };
        match scope.particle {
            None => numbers.sum::<f64>() / n as f64,
            Some(i) => numbers.skip(i).step_by(n).sum(),
        }
    }

    /// Extrapolates each quantity to fine + (fine - coarse) * `share`.
    pub fn extrapolate(coarse: &Self, fine: &Self, share: f64) -> Self {
        let both = |coarse: &f64, fine: &f64| fine + (fine - coarse) * share;
        let all = |coarse: &[f64], fine: &[f64]| {
            let pairs = coarse.iter().zip(fine);
            pairs.map(|(c, f)| both(c, f)).collect()
        };
        Self {
            particles: fine.particles,
            positions: all(&coarse.positions, &fine.positions),
            velocities: all(&coarse.velocities, &fine.velocities),
            energy: both(&coarse.energy, &fine.energy),
            momentum: fine.momentum + (fine.momentum - coarse.momentum) * share,
            strains: all(&coarse.strains, &fine.strains),
            penetration: both(&coarse.penetration, &fine.penetration),
            impact: Impact::extrapolate(&coarse.impact, &fine.impact, both),
        }
    }
}

/// Lists the structural springs of a network whose rest length is above 0.
fn structural(network: &Network) -> impl Iterator<Item = crate::Spring> {
    network
        .springs()
        .filter(|s| s.kind == SpringKind::Structural && s.law.rest_length > 0.0)
}
