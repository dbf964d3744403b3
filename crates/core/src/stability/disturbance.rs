//! Largest step with which a small disturbance of a scene at rest does not grow, as runs show it.

use super::budget::Budget;
use super::checks::take_checked;
use super::limit::{GROWTH, Limit};
use super::observation::Observation;
use super::own_rest::own_rest;
use super::rest::RestState;
use super::search::{bisect, steps};
use crate::control::Control;
use crate::error::Error;
use crate::integrators::{Method, add_scaled};
use crate::network::Network;
use crate::random::SplitMix;
use crate::scene::Scene;
use crate::simulation::Simulation;
use crate::system::ParticleSystem;

/// Relative precision of the largest step found by runs.
const PRECISION: f64 = 0.01;
/// Size of the disturbance of a scene at rest: the root of twice its energy (J^1/2).
const DISTURBANCE: f64 = 1e-6;
/// Random part of that disturbance, relative to its part in the limiting mode.
const RANDOM_SHARE: f64 = 0.1;
/// Displacement at which the potential energy of a disturbance is computed, over the scene's
/// radius.
const DISPLACEMENT: f64 = 1e-6;

/// Finds the largest step with which a small disturbance of the scene at rest grows less than
/// [`GROWTH`] times in [`HORIZON`](super::HORIZON).
///
/// The disturbance is in the mode that limits the method, with a small random part, and its run is
/// compared with one without it. Both start in the method's own state of rest, which may differ
/// from the scene's: a splitting method balances forces over a step, not at its ends. Bisection
/// begins at the predicted limit. `None` if no limit is given, if the runs would take too long, and
/// soon after `go_on` returns false.
///
/// # Errors
/// The method does not support the scene.
pub fn observe_at_rest(
    rest: &RestState,
    method: &'static Method,
    limit: Option<&Limit>,
    budget: &Budget,
    go_on: impl Fn() -> bool,
) -> Result<Option<Observation>, Error> {
    let still = &rest.scene;
    let (Some(network), Some(limit)) = (still.model.network(), limit) else {
        return Ok(None);
    };
    let guess = limit.step;
    let energy = EnergyNorm::new(still, network);
    let nudge = energy.disturbance(rest.shape(limit.mode));
    let holds = |h: f64| {
        let start = own_rest(still, method, h)?;
        let begin = |share: f64| {
            let mut scene = still.clone();
            scene.state.clone_from(&start);
            add_scaled(&mut scene.state, share, &nudge);
            network.hold(0.0, &mut scene.state);
            Simulation::new(scene, method, Control::Step(h))
        };
        let (mut run, mut beside) = (begin(1.0)?, begin(0.0)?);
        let held = take_checked(steps(h, guess), |count| {
            let held = budget.take(&mut run, count).filter(|_| go_on())?;
            let held = held && budget.take(&mut beside, count)?;
            let both = run.state().iter().zip(beside.state());
            let apart: Vec<_> = both.map(|(a, b)| a - b).collect();
            Some(held && energy.of(&apart) < GROWTH * DISTURBANCE)
        });
        budget.check().map(|()| held)
    };
    let seen = bisect(guess, still.model.work(), PRECISION, true, holds)?;
    Ok(seen.filter(|_| go_on()))
}

/// Norm of disturbances of a state of rest: the root of twice their energy (J^1/2).
struct EnergyNorm<'a> {
    network: &'a Network,
    rest: &'a [f64],
    /// Displacement at which potential energy is computed (m).
    displacement: f64,
    /// Potential energy at rest (J).
    potential: f64,
}

impl<'a> EnergyNorm<'a> {
    fn new(scene: &'a Scene, network: &'a Network) -> Self {
        let mut norm = Self {
            network,
            rest: &scene.state,
            displacement: DISPLACEMENT * scene.extent().1,
            potential: 0.0,
        };
        norm.potential = norm.energies(0.0, &vec![0.0; scene.state.len()])[1];
        norm
    }

    /// Returns the kinetic and the potential energy (J) of the state of rest with a share of a
    /// change.
    fn energies(&self, share: f64, change: &[f64]) -> [f64; 2] {
        let mut y = self.rest.to_vec();
        add_scaled(&mut y, share, change);
        self.network.hold(0.0, &mut y);
        let energy = self.network.energy_of(0.0, &y);
        [energy.kinetic, energy.total() - energy.kinetic]
    }

    fn of(&self, change: &[f64]) -> f64 {
        let [kinetic, _] = self.energies(1.0, change);
        let farthest = change[..3 * self.network.particles()].iter();
        let farthest = farthest.fold(0.0, |m: f64, x| m.max(x.abs()));
        let potential = if farthest > 0.0 {
            let share = self.displacement / farthest;
            let ends = [share, -share].map(|share| self.energies(share, change)[1]);
            (ends[0] + ends[1] - 2.0 * self.potential) / (share * share)
        } else {
            0.0
        };
        (2.0 * kinetic + potential).abs().sqrt()
    }

    /// Returns a disturbance in the shape of a mode, if there is one, with a small random part.
    fn disturbance(&self, shape: Option<Vec<f64>>) -> Vec<f64> {
        let network = self.network;
        let (n, size) = (network.particles(), self.rest.len());
        let mut random = SplitMix(5);
        let mut all = vec![0.0; size];
        for k in 0..3 * n {
            let mass = network.masses()[k % n];
            if mass > 0.0 && !network.is_pinned(k % n) {
                all[3 * n + k] = random.between(-1.0, 1.0) / mass.sqrt();
            }
        }
        let scale = |change: &mut [f64], wanted: f64| {
            let own = self.of(change);
            for change in change {
                *change *= if own > 0.0 { wanted / own } else { 0.0 };
            }
        };
        scale(&mut all, RANDOM_SHARE);
        if let Some(mut shape) = shape {
            scale(&mut shape, 1.0);
            add_scaled(&mut all, 1.0, &shape);
        }
        scale(&mut all, DISTURBANCE);
        all
    }
}
