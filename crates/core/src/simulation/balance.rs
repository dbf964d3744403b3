//! Balance of energy: the energy that a run has gained beyond the work done on it, and the largest
//! error of its constraints.
//!
//! The forces take energy from a motion or conserve it, unless something [works](super::power) on
//! the run: a pin or an obstacle that moves, wind, or a hand. Any energy beyond that work is an
//! error of the method: its step is too long.

use serde::{Deserialize, Serialize};

use super::power::energy_of;
use crate::error::{Cause, Unmet};
use crate::network::{Network, is_loose, is_nearly_singular};

/// Interval of time (s): the energy is checked once in each.
const INTERVAL: f64 = 0.1;

/// Gain, over the energy that moves, from which on users are warned that the run gains energy.
const NOTABLE_GAIN: f64 = 0.1;

/// Gain, over the energy that moves, at which a run counts as blown up.
const MAX_GAIN: f64 = 10.0;

/// Speed below which motion counts as rounding noise, in radii of the scene per second (1/s).
const ROUNDING_SPEED: f64 = 1e-6;

/// Least energy that gains are compared with, over the weight times the size of the scene: the work
/// of friction on what hardly moves is known no better.
const LEAST_SHARE: f64 = 0.01;

/// Change of a coordinate, over itself, that shows how large rounding errors of the energy are: 8
/// units in the last place.
const NUDGE: f64 = 8.0 * f64::EPSILON;

/// Number of states that differ from the first by such changes.
const NUDGES: u32 = 4;

/// Energy of rounding errors in a run over that in a single state.
const ROUNDING: f64 = 1000.0;

/// Energy that nothing put into a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gain {
    /// The energy (J).
    pub energy: f64,
    /// The energy over the energy that moves: the largest exchange so far between kinetic, elastic
    /// and gravitational energy and work.
    pub share: f64,
}

/// Range of values so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Range {
    least: f64,
    most: f64,
}

impl Range {
    fn at(value: f64) -> Self {
        let [least, most] = [value; 2];
        Self { least, most }
    }

    fn add(&mut self, value: f64) {
        self.least = self.least.min(value);
        self.most = self.most.max(value);
    }

    fn width(&self) -> f64 {
        self.most - self.least
    }
}

/// Balance of energy of a run (J).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Balance {
    /// Time of the last check (s).
    time: f64,
    /// Energy at the beginning, with what hands and tears have changed since.
    begin: f64,
    /// Energy that rounding errors, and the errors that a tolerance allows, may add.
    floor: f64,
    /// Least energy that gains are compared with.
    least: f64,
    /// Kinetic energy at checks, from 0 on, without the motion that all share if nothing holds
    /// them; elastic energy, and that of repulsion; gravitational energy.
    kinetic: Range,
    elastic: Range,
    gravitational: Range,
    /// Work done on the run, less the work that it did.
    work: f64,
    /// Sum of the amounts of all work, done on the run and by it.
    turnover: f64,
    /// Gain at the last check, and the largest one.
    gain: f64,
    most: f64,
    /// Number of the constraint with the largest error so far, and that error, as a share.
    worst: Option<(usize, f64)>,
    /// Whether constraints were nearly singular at a check.
    singular: bool,
    /// Whether hands, contact or tears may have changed the energy.
    open: bool,
    /// Whether something has changed the run since its last step, which is no gain.
    disturbed: bool,
}

impl Balance {
    /// Creates the balance of a run that starts at y at time t (s), in a scene of that radius (m).
    pub(super) fn new(network: &Network, (t, y): (f64, &[f64]), radius: f64) -> Self {
        let energy = energy_of(network, t, y);
        let mass = network.masses().iter().sum::<f64>();
        let slow = 0.5 * mass * (ROUNDING_SPEED * radius).powi(2);
        let weight = network.gravity().map_or(0.0, |g| g.norm()) * mass;
        let mut balance = Self {
            time: t,
            least: LEAST_SHARE * weight * radius,
            begin: energy.total(),
            floor: slow + ROUNDING * rounding(network, t, y),
            elastic: Range::at(energy.elastic + energy.contact),
            gravitational: Range::at(energy.gravitational),
            ..Self::default()
        };
        balance.kinetic.add(energy.kinetic - adrift(network, network.halves(y).1));
        balance
    }

    /// Forgets all gains and constraint errors so far.
    pub(super) fn start_over(&mut self) {
        (self.most, self.gain) = (0.0, 0.0);
        (self.worst, self.singular) = (None, false);
        self.disturbed = true;
    }

    /// Returns the energy that moves (J): the largest exchange so far between kinetic, elastic and
    /// gravitational energy and work, less the energy that came from nowhere.
    fn scale(&self) -> f64 {
        let ranges = [self.kinetic, self.elastic, self.gravitational];
        let exchanged = ranges.iter().map(Range::width).fold(0.0, f64::max);
        let put_in = 0.5 * (self.turnover + self.work).max(0.0);
        let had = (exchanged - self.most).max(put_in).max(self.floor);
        // A run can lose no more energy than it had: losses beyond that are of energy that it
        // gained from nowhere, and do not widen the scale.
        had.max((self.turnover - put_in).min(2.0 * had))
    }

    /// Returns the energy that gains are compared with (J).
    pub(super) fn stake(&self) -> f64 {
        self.scale().max(self.least)
    }

    /// Returns whether the gain was small at the last check.
    pub(super) fn is_sound(&self) -> bool {
        self.gain <= NOTABLE_GAIN * self.stake()
    }

    /// Returns whether another check is due at time t (s): one in each interval, so that a run that
    /// goes back is checked at the same times again.
    pub(super) fn is_due(&self, t: f64) -> bool {
        (t / INTERVAL).floor() > (self.time / INTERVAL).floor()
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
    /// gain.
    pub(super) fn allow(&mut self, change: f64) {
        self.begin += change;
        self.open = true;
    }

    /// Sets the reference energy so that the energy now (J), which a hand may have changed, leaves
    /// the gain as it was at the last check.
    pub(super) fn forgive(&mut self, energy: f64) {
        self.begin = energy - self.work - self.gain;
        self.disturbed = false;
    }

    /// Raises the energy up to which gains are no faults to that (J) of the errors that a run is
    /// allowed to make, or of the motion in its first step.
    pub(super) fn tolerate(&mut self, errors: f64) {
        self.floor = self.floor.max(errors);
    }

    /// Notes that something changes the run before its next step.
    pub(super) fn disturb(&mut self) {
        (self.disturbed, self.open) = (true, true);
    }

    /// Returns whether something has changed the run since its last step.
    pub(super) fn is_disturbed(&self) -> bool {
        self.disturbed
    }

    /// Notes that contact may have changed the energy.
    pub(super) fn leave_open(&mut self) {
        self.open = true;
    }

    /// Records a constraint's error, if it is the largest so far.
    pub(super) fn note(&mut self, unmet: &Unmet) {
        if self.worst.is_none_or(|(_, share)| unmet.share > share) {
            self.worst = Some((unmet.number, unmet.share));
        }
    }

    /// Widens the ranges of energy to those of another check.
    pub(super) fn widen(&mut self, other: &Self) {
        let Self { kinetic, elastic, gravitational, .. } = *other;
        (self.kinetic, self.elastic, self.gravitational) = (kinetic, elastic, gravitational);
    }

    /// Returns whether the kinetic energy alone exceeds the energy that a run may gain.
    pub(super) fn is_exceeded(&self, network: &Network, y: &[f64]) -> bool {
        let (_, v) = network.halves(y);
        let squared = |axis: usize| {
            let v = &v[axis * network.particles()..];
            let terms = network.masses().iter().zip(v).map(|(m, v)| m * v * v);
            terms.sum::<f64>()
        };
        let kinetic = 0.5 * (0..3).map(squared).sum::<f64>();
        kinetic - adrift(network, v) > MAX_GAIN * self.stake()
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
        let (x, v) = network.halves(y);
        self.kinetic.add(energy.kinetic - adrift(network, v));
        self.elastic.add(energy.elastic + energy.contact);
        self.gravitational.add(energy.gravitational);
        self.gain = energy.total() - self.begin - self.work;
        self.most = self.most.max(self.gain);
        self.time = t;
        self.singular |= is_nearly_singular(network, t, x, v, f);
        (self.gain > MAX_GAIN * self.stake()).then(|| {
            let (particle, speed) = fastest_particle(v);
            Cause::Gained { energy: self.gain, particle, speed }
        })
    }

    /// Returns the largest gain, if it is large enough for a warning.
    pub(super) fn notable_gain(&self) -> Option<Gain> {
        let gain = Gain { energy: self.most, share: self.most / self.stake() };
        (gain.share > NOTABLE_GAIN).then_some(gain)
    }

    /// Returns the energy gained or lost, over the energy that moves; `None` if nothing moves, or
    /// if hands, contact or tears may have changed it.
    pub(super) fn change(&self) -> Option<f64> {
        let (scale, energy) = (self.scale(), self.gain + self.work);
        (scale > self.floor && !self.open).then_some(energy / scale)
    }

    /// Returns the constraint with the largest error so far, and that error.
    pub(super) fn worst_constraint(&self, network: &Network) -> Option<Unmet> {
        let (number, share) = self.worst?;
        let constraint = network.constraints().get(number)?.name();
        Some(Unmet { number, constraint, share })
    }

    /// Returns whether constraints were nearly singular at a check.
    pub(super) fn was_singular(&self) -> bool {
        self.singular
    }
}

/// Returns the kinetic energy (J) of the motion that all share at the velocities v (m/s), n x 3, if
/// nothing holds the network in the world: an observer who moves along sees none of it.
fn adrift(network: &Network, v: &[f64]) -> f64 {
    if !is_loose(network) {
        return 0.0;
    }
    let masses = network.masses();
    let momentum = |axis: usize| {
        let v = &v[axis * masses.len()..];
        masses.iter().zip(v).map(|(m, v)| m * v).sum::<f64>()
    };
    let squared: f64 = (0..3).map(|axis| momentum(axis).powi(2)).sum();
    0.5 * squared / masses.iter().sum::<f64>()
}

/// Returns the rounding error (J) of the energy of y at time t (s): its largest change if all
/// coordinates change in their last places.
fn rounding(network: &Network, t: f64, y: &[f64]) -> f64 {
    let energy = |y: &[f64]| network.energy_of(t, y).total();
    let (n, same) = (3 * network.particles(), energy(y));
    let changes = (0..NUDGES).map(|number| {
        // Signs that look random, and differ for each number.
        let sign =
            |k: usize| f64::from((k as u32 + 1).wrapping_mul(0x9e37_79b9) >> (31 - number) & 1);
        let nudged = y.iter().enumerate().map(|(k, y)| {
            let change = if k < n { NUDGE * (2.0 * sign(k) - 1.0) } else { 0.0 };
            y * (1.0 + change)
        });
        (energy(&nudged.collect::<Vec<_>>()) - same).abs()
    });
    changes.fold(0.0, f64::max)
}

/// Returns the particle with the largest of the velocities v, n x 3, and its speed (m/s).
fn fastest_particle(v: &[f64]) -> (usize, f64) {
    let n = v.len() / 3;
    let speed = |i: usize| (0..3).map(|axis| v[axis * n + i].powi(2)).sum::<f64>().sqrt();
    let speeds = (0..n).map(|i| (i, speed(i)));
    speeds.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default()
}
