//! Balance of energy: the energy that a run has gained beyond the work done on it, and the largest
//! error of its constraints.
//!
//! The forces take energy from a motion or conserve it, unless something [works](super::power) on
//! the run: a pin or an obstacle that moves, wind, or a hand. Any energy beyond that work is an
//! error of the method: its step is too long.

use serde::{Deserialize, Serialize};

use super::power::{energy_of, fastest_particle};
use crate::error::{Cause, Unmet};
use crate::network::{Network, is_nearly_singular};

/// Shortest time between two checks of the energy (s).
const INTERVAL: f64 = 0.1;

/// Gain, over the energy of the scene, from which on users are warned that the run gains energy.
const NOTABLE_GAIN: f64 = 0.5;

/// Gain, over the energy of the scene, at which a run counts as blown up.
const MAX_GAIN: f64 = 100.0;

/// Speed below which motion counts as rounding noise, in radii of the scene per second (1/s).
const ROUNDING_SPEED: f64 = 1e-9;

/// Energy that nothing put into a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gain {
    /// The energy (J).
    pub energy: f64,
    /// The energy over that of the scene: the energy of its motion at the beginning, its weight
    /// times its size, and the work done on it and by it.
    pub share: f64,
}

/// Balance of energy of a run (J).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Balance {
    /// Time of the last check (s).
    time: f64,
    /// Energy at the beginning, with what hands and tears have changed since.
    begin: f64,
    /// Energy of the scene: kinetic and elastic at the beginning, its weight times its radius, and
    /// that of motion at the rounding speed; at least that of the errors that its tolerance allows.
    own: f64,
    /// Kinetic and elastic energy at the beginning.
    moving: f64,
    /// Largest loss of gravitational energy so far, and the gravitational energy at the beginning.
    fall: f64,
    gravitational: f64,
    /// Work done on the run, less the work that it did.
    work: f64,
    /// Sum of the amounts of all work, done on the run and by it.
    turnover: f64,
    /// Gain at the last check, and its share.
    gain: f64,
    share: f64,
    /// Largest gain.
    most: Option<Gain>,
    /// Number of the constraint with the largest error so far, and that error, as a share.
    worst: Option<(usize, f64)>,
    /// Whether constraints were nearly singular at a check.
    singular: bool,
    /// Whether hands, contact or tears may have changed the energy.
    open: bool,
}

impl Balance {
    /// Creates the balance of a run that starts at y at time t (s), in a scene of that radius (m).
    pub(super) fn new(network: &Network, (t, y): (f64, &[f64]), radius: f64) -> Self {
        let energy = energy_of(network, t, y);
        let mass = network.masses().iter().sum::<f64>();
        let weight = network.gravity().map_or(0.0, |g| g.norm()) * mass;
        let rounding = 0.5 * mass * (ROUNDING_SPEED * radius).powi(2);
        // Rounding may leave a fluid at rest with a slightly negative energy.
        let moving = (energy.kinetic + energy.elastic + energy.contact).max(0.0);
        Self {
            time: t,
            begin: energy.total(),
            own: moving + weight * radius + rounding,
            moving,
            gravitational: energy.gravitational,
            ..Self::default()
        }
    }

    /// Forgets all gains and constraint errors so far.
    pub(super) fn start_over(&mut self) {
        (self.most, self.gain, self.share) = (None, 0.0, 0.0);
        (self.worst, self.singular) = (None, false);
    }

    /// Returns the energy of the scene, which gains are compared with (J): its own, what gravity
    /// has added to its motion, and the work done on it and by it.
    fn scale(&self) -> f64 {
        let put_in = 0.5 * (self.turnover + self.work).max(0.0);
        let had = self.own + self.fall + put_in;
        // A run can lose no more energy than it had: losses beyond that are of energy that it
        // gained from nowhere, and do not widen the scale.
        had + (self.turnover - put_in).max(0.0).min(had)
    }

    /// Returns whether the gain was small at the last check.
    pub(super) fn is_sound(&self) -> bool {
        self.share < NOTABLE_GAIN
    }

    /// Returns whether another check is due at time t (s).
    pub(super) fn is_due(&self, t: f64) -> bool {
        t - self.time >= INTERVAL
    }

    /// Adds work (J) that was done on the run.
    pub(super) fn add(&mut self, work: f64) {
        self.work += work;
        self.turnover += work.abs();
    }

    /// Subtracts work (J) that was added but not done.
    pub(super) fn take_back(&mut self, work: f64) {
        self.work -= work;
    }

    /// Changes the reference energy by the change (J) that a tear or a release caused: that is no
    /// gain, and what it adds is of the scene from then on.
    pub(super) fn allow(&mut self, change: f64) {
        self.begin += change;
        self.own += change.max(0.0);
        self.open = true;
    }

    /// Sets the reference energy so that the energy now (J), which a hand may have changed, leaves
    /// the gain as it was at the last check.
    pub(super) fn forgive(&mut self, energy: f64) {
        self.begin = energy - self.work - self.gain;
    }

    /// Raises the energy of the scene to at least that (J) of the errors that a run is allowed to
    /// make.
    pub(super) fn tolerate(&mut self, errors: f64) {
        self.own = self.own.max(errors);
    }

    /// Notes that hands or contact may have changed the energy.
    pub(super) fn leave_open(&mut self) {
        self.open = true;
    }

    /// Records a constraint's error, if it is the largest so far.
    pub(super) fn note(&mut self, unmet: &Unmet) {
        if self.worst.is_none_or(|(_, share)| unmet.share > share) {
            self.worst = Some((unmet.number, unmet.share));
        }
    }

    /// Returns whether the kinetic energy alone exceeds the energy that a run may gain.
    pub(super) fn is_exceeded(&self, network: &Network, y: &[f64]) -> bool {
        let (_, v) = network.halves(y);
        let squared = |axis: usize| {
            let v = &v[axis * network.particles()..];
            let terms = network.masses().iter().zip(v).map(|(m, v)| m * v * v);
            terms.sum::<f64>()
        };
        0.5 * (0..3).map(squared).sum::<f64>() > MAX_GAIN * self.scale()
    }

    /// Checks the energy of y at time t (s), with scratch for forces. Returns the cause of a
    /// blow-up, if the gain is too large.
    pub(super) fn check(
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

    /// Returns the largest gain, if it is large enough for a warning.
    pub(super) fn notable_gain(&self) -> Option<Gain> {
        self.most.filter(|gain| gain.share > NOTABLE_GAIN)
    }

    /// Returns the energy gained or lost, over the energy of the motion; `None` if nothing moves,
    /// or if hands, contact or tears may have changed it.
    pub(super) fn change(&self) -> Option<f64> {
        let motion = self.moving + self.fall;
        let moves = motion > ROUNDING_SPEED * self.own;
        let energy = self.gain + self.work;
        (moves && !self.open).then_some(energy / motion)
    }

    /// Returns the constraint with the largest error so far, and that error.
    pub(super) fn worst_constraint(&self, network: &Network) -> Option<Unmet> {
        let (number, share) = self.worst?;
        let constraint = network.constraints().get(number)?.name();
        Some(Unmet {
            number,
            constraint,
            share,
        })
    }

    /// Returns whether constraints were nearly singular at a check.
    pub(super) fn was_singular(&self) -> bool {
        self.singular
    }
}
