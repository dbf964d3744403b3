//! Balance of energy: what a run gains beyond the work that was done on it, and how far constraints
//! are from being met.
//!
//! The forces take energy from a motion or leave it as it is, unless something
//! [works](super::drive) on it: a pin or an obstacle that moves, wind, a hand. What a run has
//! beyond that work was made by its method, by a step that is too long.

use serde::{Deserialize, Serialize};

use super::Simulation;
use super::drive::{Drive, End, energy_of, fastest, fastest_particle};
use crate::contact::{Obstacle, Statistics};
use crate::error::{Cause, Error, Unmet};
use crate::network::{Network, energy_of_errors, is_conservative, is_nearly_singular};
use crate::scene::Model;

/// Time from one look at the energy to the next (s), at least.
const INTERVAL: f64 = 0.1;

/// Gain, in energies of the scene, from which on a run is said to gain energy.
const NOTED: f64 = 0.5;

/// Gain, in energies of the scene, from which on a run is lost.
const LOST: f64 = 100.0;

/// Error of a constraint over its length from which on a run is lost.
const BROKEN: f64 = 0.1;

/// Speed that nobody sees, in radii of the scene (1/s): rounding moves what is at rest more slowly.
const UNSEEN: f64 = 1e-9;

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
        self.share < NOTED
    }

    /// Adds work (J) that was done on the run.
    fn add(&mut self, work: f64) {
        self.work += work;
        self.turnover += work.abs();
    }

    /// Takes a change of the energy (J) by a tear as no gain.
    pub(super) fn allow(&mut self, change: f64) {
        self.begin += change;
        self.open = true;
    }

    /// Whether the particles alone move with more energy than a run may gain.
    fn is_exceeded(&self, network: &Network, y: &[f64]) -> bool {
        let (_, v) = network.halves(y);
        let squared = |axis: usize| {
            let v = &v[axis * network.particles()..];
            let terms = network.masses().iter().zip(v).map(|(m, v)| m * v * v);
            terms.sum::<f64>()
        };
        0.5 * (0..3).map(squared).sum::<f64>() > LOST * self.scale()
    }

    /// Looks at the energy of y at time t (s), with room for forces. Returns the gain by which the
    /// run is lost.
    fn look(
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
        (self.share > LOST).then(|| {
            let (particle, speed) = fastest_particle(v);
            Cause::Gained {
                energy: self.gain,
                particle,
                speed,
            }
        })
    }
}

/// What a balance is found by.
#[derive(Debug, Default)]
pub(super) struct Watch {
    drive: Drive,
    /// Whether something has changed the run since its last step.
    disturbed: bool,
    /// Radius of the scene (m).
    radius: f64,
    /// Time of the beginning of the last step (s), and its work (J).
    last: (f64, f64),
    /// Forces (N).
    scratch: Vec<f64>,
}

impl Watch {
    /// Balance of a run at y at time t (s), whose scene has that radius (m).
    fn begin(&mut self, network: &Network, (t, y): (f64, &[f64]), radius: f64) -> Balance {
        let energy = energy_of(network, t, y);
        let mass = network.masses().iter().sum::<f64>();
        let weight = network.gravity().map_or(0.0, |g| g.norm()) * mass;
        let unseen = 0.5 * mass * (UNSEEN * radius).powi(2);
        // A step allocates nothing.
        *self = Self {
            radius,
            scratch: Vec::with_capacity(y.len() / 2),
            ..Self::default()
        };
        self.drive.begin(network, t, y);
        // Rounding leaves a fluid at rest with less than none.
        let moving = (energy.kinetic + energy.elastic + energy.contact).max(0.0);
        Balance {
            time: t,
            begin: energy.total(),
            own: moving + weight * radius + unseen,
            moving,
            gravitational: energy.gravitational,
            ..Balance::default()
        }
    }

    /// Goes on from another state.
    pub fn resume(&mut self) {
        self.disturbed = false;
        self.drive.forget();
    }

    /// Forgets what the run gained.
    fn start_over(&mut self, balance: &mut Balance) {
        (balance.most, balance.gain, balance.share) = (None, 0.0, 0.0);
        (balance.worst, balance.singular) = (None, false);
        self.disturbed = true;
        self.drive.forget();
    }

    /// Looks at the run at y at time t (s), where something is about to change it, on the way or
    /// at the end of a step that ends at `end` (s).
    pub fn disturb(&mut self, model: &Model, balance: &mut Balance, t: f64, end: f64, y: &[f64]) {
        self.drive.forget();
        let Some(network) = model.network().filter(|_| !self.disturbed) else {
            return;
        };
        self.disturbed = true;
        let (begin, work) = self.last;
        if t < end && begin < end {
            balance.work -= work * (end - t) / (end - begin);
        }
        balance.look(network, (t, y), &mut self.scratch);
        balance.open = true;
    }

    /// Takes what was changed as no gain.
    pub fn forgive(&mut self, network: &Network, balance: &mut Balance, t: f64, y: &[f64]) {
        if std::mem::take(&mut self.disturbed) {
            let energy = energy_of(network, t, y).total();
            balance.begin = energy - balance.work - balance.gain;
        }
    }

    /// Gets ready for a step from y at time t (s).
    pub fn begin_step(&mut self, model: &Model, t: f64, y: &[f64]) {
        if let Some(network) = model.network() {
            self.drive.begin(network, t, y);
        }
        self.last = (t, 0.0);
    }

    /// Forgets what works on the scene: springs have torn.
    pub fn forget_drive(&mut self) {
        self.drive.forget();
    }

    /// Why a run is lost whose particles alone move with more energy than it may gain, where
    /// surfaces have not been guarded yet: what flies through a whole scene in a step meets all of
    /// it, and costs thousands of steps.
    pub fn look_before_guard(&self, model: &Model, balance: &Balance, end: End) -> Option<Cause> {
        let network = model.network()?;
        let mut balance = *balance;
        if network.contact_layer().is_none()
            || self.disturbed
            || !balance.is_exceeded(network, end.y)
        {
            return None;
        }
        balance.add(self.drive.clone().work(network, end));
        balance.look(network, (end.t, end.y), &mut vec![])
    }

    /// Notes the end of a step in which obstacles were met, and after which a particle seems lost.
    /// Returns why the run is lost: what is far away because it fell or was thrown there has gained
    /// nothing, and is not.
    pub fn end_step(
        &mut self,
        model: &Model,
        balance: &mut Balance,
        end: End,
        met: &Statistics,
        lost: Option<Cause>,
    ) -> Option<Cause> {
        let Some(network) = model.network() else {
            return lost;
        };
        let away = matches!(lost, Some(Cause::Away { .. }));
        if lost.is_some() && !away {
            return lost;
        }
        let End { t, y, .. } = end;
        let mut work = self.drive.work(network, end);
        let impulse = met.impulse.max(met.guarded.impulse);
        if impulse > 0.0 {
            // Most of the work that obstacles did.
            let speed = |obstacle: &Obstacle| fastest(obstacle, t, self.radius);
            let speeds = network.obstacles().iter().map(speed);
            work += impulse * speeds.fold(0.0, f64::max);
            balance.open = true;
        }
        balance.add(work);
        self.last.1 = work;
        let worst = network.worst_constraint(network.halves(y).0, self.radius);
        if let Some(unmet) = worst
            && balance.worst.is_none_or(|(_, share)| unmet.share > share)
        {
            balance.worst = Some((unmet.number, unmet.share));
        }
        let early = t - balance.time < INTERVAL && !away;
        let gained = if early {
            None
        } else {
            balance.look(network, (t, y), &mut self.scratch)
        };
        let broken = worst.filter(|unmet| unmet.share > BROKEN).map(Cause::Unmet);
        let lost = lost.filter(|_| !balance.is_sound());
        broken.or(lost).or(gained)
    }
}

impl Simulation {
    /// Begins the balance with the state as it is now.
    pub(super) fn begin_watch(&mut self) {
        if let Model::Network(network) = &self.model {
            let (now, radius) = ((self.state.since, &self.state.y[..]), self.radius);
            self.state.balance = self.watch.begin(network, now, radius);
        }
        self.tolerate();
    }

    /// Takes what the errors that a tolerance allows can gain as the scene's own energy: where
    /// nothing moves, an adaptive method makes steps so long that it just meets its tolerance.
    fn tolerate(&mut self) {
        if let (Some(relative), Model::Network(network)) =
            (self.state.control.tolerance(), &self.model)
        {
            let error = self.scene.limits.absolute.unwrap_or(relative * self.radius);
            let (t, y) = self.last_end();
            let errors = energy_of_errors(network, t, y, error);
            self.state.balance.own = self.state.balance.own.max(errors);
        }
    }

    /// Forgets what the run gained: it goes on by other steps.
    pub(super) fn start_watch_over(&mut self) {
        self.watch.start_over(&mut self.state.balance);
        self.tolerate();
    }

    /// Balance at the end of the last step.
    fn balance_now(&self) -> (Balance, Option<Cause>) {
        let mut balance = self.state.balance;
        // What was changed since the last look is no gain.
        let network = self.model.network().filter(|_| !self.watch.disturbed);
        let lost = network.and_then(|network| balance.look(network, self.last_end(), &mut vec![]));
        (balance, lost)
    }

    /// Looks at the energy at the end of a run: a run that is shorter than the time between two
    /// looks may be lost too, and one that is lost since the last look.
    ///
    /// # Errors
    /// The run blew up, now or earlier.
    pub fn conclude(&mut self) -> Result<(), Error> {
        if let Some(blow_up) = self.blow_up {
            return Err(blow_up.into());
        }
        match self.balance_now().1 {
            Some(cause) => self.lose(cause, self.last_end().0),
            None => Ok(()),
        }
    }

    /// Energy that the method put into the run, if it is more than the scene has of its own: the
    /// step is too long.
    #[must_use]
    pub fn gained(&self) -> Option<Gain> {
        self.balance_now().0.most.filter(|gain| gain.share > NOTED)
    }

    /// Energy that the run has gained or, below 0, lost since the beginning, over the kinetic,
    /// elastic and gravitational energy that its motion has had. `None` if the forces do not keep
    /// the energy, if contact, tears or hands may have changed it, or if nothing moves.
    #[must_use]
    pub fn energy_change(&self) -> Option<f64> {
        let conserves = |network: &&Network| is_conservative(network);
        self.model.network().filter(conserves)?;
        let balance = self.balance_now().0;
        let motion = balance.moving + balance.fall;
        let moves = motion > UNSEEN * balance.own;
        let energy = balance.gain + balance.work;
        (moves && !balance.open).then_some(energy / motion)
    }

    /// The constraint that was farthest from being met at the end of a step, with its largest
    /// error.
    #[must_use]
    pub fn worst_constraint(&self) -> Option<Unmet> {
        let (number, share) = self.state.balance.worst?;
        let constraints = self.model.network()?.constraints();
        let constraint = constraints.get(number)?.name();
        Some(Unmet {
            number,
            constraint,
            share,
        })
    }

    /// Whether constraints were so nearly singular that bounded forces could not hold them exactly,
    /// as a chain that is stretched straight between two pins.
    #[must_use]
    pub fn was_nearly_singular(&self) -> bool {
        self.balance_now().0.singular
    }
}
