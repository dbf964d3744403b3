//! Balance of energy: what a run gains beyond the work that was done on it, and how far constraints
//! are from being met.
//!
//! The forces take energy from a motion or leave it as it is, unless something
//! [works](super::power) on it: a pin or an obstacle that moves, wind, a hand. What a run has
//! beyond that work was made by its method, by a step that is too long.

use serde::{Deserialize, Serialize};

use super::power::{energy_of, fastest_particle};
use crate::error::{Cause, Unmet};
use crate::network::{Network, is_nearly_singular};

/// Time from one look at the energy to the next (s), at least.
const INTERVAL: f64 = 0.1;

/// Gain, in energies of the scene, from which on a run is said to gain energy.
const NOTABLE_GAIN: f64 = 0.5;

/// Gain, in energies of the scene, from which on a run is lost.
const MAX_GAIN: f64 = 100.0;

/// Speed below which motion is rounding noise, in radii of the scene (1/s).
const UNSEEN_SPEED: f64 = 1e-9;

/// Energy that nothing put into a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gain {
    /// The energy (J).
    pub energy: f64,
    /// The energy over that of the scene: what it began with, what its weight gives it over its own
    /// size, and the work that was done on it and by it.
    pub share: f64,
}

/// Balance of energy of a run (J).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Balance {
    /// Time of the last look (s).
    time: f64,
    /// Energy at the beginning, with what hands and tears have changed since.
    begin: f64,
    /// Energy of the scene: kinetic and elastic at the beginning, its weight times its radius, and
    /// that of a motion that nobody sees; at least that of the errors that its tolerance allows.
    own: f64,
    /// Kinetic and elastic energy at the beginning.
    moving: f64,
    /// Largest fall of the gravitational energy, and that energy at the beginning.
    fall: f64,
    gravitational: f64,
    /// Work that was done on the run, less that which it did.
    work: f64,
    /// Work that was done on the run and by it.
    turnover: f64,
    /// Gain at the last look, and its share.
    gain: f64,
    share: f64,
    /// Largest gain.
    most: Option<Gain>,
    /// Number of the constraint that was farthest from being met, and its share.
    worst: Option<(usize, f64)>,
    /// Whether constraints were nearly singular at a look.
    singular: bool,
    /// Whether hands, contact or tears may have changed the energy.
    open: bool,
}

impl Balance {
    /// Balance of a run at y at time t (s), whose scene has that radius (m).
    pub(super) fn new(network: &Network, (t, y): (f64, &[f64]), radius: f64) -> Self {
        let energy = energy_of(network, t, y);
        let mass = network.masses().iter().sum::<f64>();
        let weight = network.gravity().map_or(0.0, |g| g.norm()) * mass;
        let unseen = 0.5 * mass * (UNSEEN_SPEED * radius).powi(2);
        // Rounding leaves a fluid at rest with less than none.
        let moving = (energy.kinetic + energy.elastic + energy.contact).max(0.0);
        Self {
            time: t,
            begin: energy.total(),
            own: moving + weight * radius + unseen,
            moving,
            gravitational: energy.gravitational,
            ..Self::default()
        }
    }

    /// Forgets what the run gained.
    pub(super) fn start_over(&mut self) {
        (self.most, self.gain, self.share) = (None, 0.0, 0.0);
        (self.worst, self.singular) = (None, false);
    }

    /// Energy that the gain of a run is compared with (J).
    fn scale(&self) -> f64 {
        let put_in = 0.5 * (self.turnover + self.work).max(0.0);
        let had = self.own + self.fall + put_in;
        // A run can lose no more energy than it had: losses beyond that are of energy that it
        // gained from nowhere, and do not widen the scale.
        had + (self.turnover - put_in).max(0.0).min(had)
    }

    /// Whether the run had gained little when it was last looked at.
    pub(super) fn is_sound(&self) -> bool {
        self.share < NOTABLE_GAIN
    }

    /// Whether the last look was so long before time t (s) that another is due.
    pub(super) fn is_due(&self, t: f64) -> bool {
        t - self.time >= INTERVAL
    }

    /// Adds work (J) that was done on the run.
    pub(super) fn add(&mut self, work: f64) {
        self.work += work;
        self.turnover += work.abs();
    }

    /// Takes back work (J) that was added and not done.
    pub(super) fn take_back(&mut self, work: f64) {
        self.work -= work;
    }

    /// Takes a change of the energy (J) by a tear as no gain.
    pub(super) fn allow(&mut self, change: f64) {
        self.begin += change;
        self.open = true;
    }

    /// Takes the energy (J), which a hand has changed since the last look, as no gain.
    pub(super) fn forgive(&mut self, energy: f64) {
        self.begin = energy - self.work - self.gain;
    }

    /// Takes the energy (J) of errors that a run is allowed to make as the scene's own.
    pub(super) fn tolerate(&mut self, errors: f64) {
        self.own = self.own.max(errors);
    }

    /// Notes that hands or contact may have changed the energy.
    pub(super) fn leave_open(&mut self) {
        self.open = true;
    }

    /// Notes the constraint that is farthest from being met at the end of a step.
    pub(super) fn note(&mut self, unmet: &Unmet) {
        if self.worst.is_none_or(|(_, share)| unmet.share > share) {
            self.worst = Some((unmet.number, unmet.share));
        }
    }

    /// Whether the particles alone move with more energy than a run may gain.
    pub(super) fn is_exceeded(&self, network: &Network, y: &[f64]) -> bool {
        let (_, v) = network.halves(y);
        let squared = |axis: usize| {
            let v = &v[axis * network.particles()..];
            let terms = network.masses().iter().zip(v).map(|(m, v)| m * v * v);
            terms.sum::<f64>()
        };
        0.5 * (0..3).map(squared).sum::<f64>() > MAX_GAIN * self.scale()
    }

    /// Looks at the energy of y at time t (s), with room for forces. Returns the gain by which the
    /// run is lost.
    pub(super) fn look(
        &mut self,
        network: &Network,
        (t, y): (f64, &[f64]),
        f: &mut Vec<f64>,
    ) -> Option<Cause> {
        let energy = energy_of(network, t, y);
        self.fall = self.fall.max(self.gravitational - energy.gravitational);
        self.gain = energy.total() - self.begin - self.work;
        (self.time, self.share) = (t, self.gain / self.scale());
        if self.gain > 0.0 && self.most.is_none_or(|most| self.share > most.share) {
            self.most = Some(Gain {
                energy: self.gain,
                share: self.share,
            });
        }
        let (x, v) = network.halves(y);
        self.singular |= is_nearly_singular(network, t, x, v, f);
        (self.share > MAX_GAIN).then(|| {
            let (particle, speed) = fastest_particle(v);
            Cause::Gained {
                energy: self.gain,
                particle,
                speed,
            }
        })
    }

    /// Largest gain, if it is so large that the step is too long.
    pub(super) fn notable_gain(&self) -> Option<Gain> {
        self.most.filter(|gain| gain.share > NOTABLE_GAIN)
    }

    /// Energy that the run has gained or lost, over that of its motion: `None` if nothing moves, or
    /// hands, contact or tears may have changed it.
    pub(super) fn change(&self) -> Option<f64> {
        let motion = self.moving + self.fall;
        let moves = motion > UNSEEN_SPEED * self.own;
        let energy = self.gain + self.work;
        (moves && !self.open).then_some(energy / motion)
    }

    /// The constraint of a network that was farthest from being met, with its largest error.
    pub(super) fn worst_constraint(&self, network: &Network) -> Option<Unmet> {
        let (number, share) = self.worst?;
        let constraint = network.constraints().get(number)?.name();
        Some(Unmet {
            number,
            constraint,
            share,
        })
    }

    /// Whether constraints were nearly singular at a look.
    pub(super) fn was_singular(&self) -> bool {
        self.singular
    }
}
