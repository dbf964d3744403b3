//! Balance of energy: what a run gains beyond the work that was done on it.
//!
//! The forces take energy from a motion or leave it as it is, unless something works on it: a pin
//! or an obstacle that moves, wind, a hand. The power of all that together is the rate at which the
//! energy of the exact motion grows, dE/dt = (E(t + e, y + e f) - E(t - e, y - e f)) / 2e. What a
//! run has beyond the integral of that was made by its method, by a step that is too long.

use serde::{Deserialize, Serialize};

use super::Simulation;
use crate::contact::{Obstacle, Statistics};
use crate::elements::Element;
use crate::energy::Energy;
use crate::error::Cause;
use crate::network::Network;
use crate::path::Path;
use crate::scene::Model;
use crate::system::ParticleSystem;

/// Time from one look at the energy to the next (s), at least, while nothing works on the scene ...
const REST: f64 = 0.1;

/// ... and while something does.
const DRIVEN: f64 = 1.0 / 60.0;

/// Half of the time over which the power is found (s).
const MOMENT: f64 = 1e-7;

/// Gain, in energies of the scene, from which on a run is said to gain energy.
const NOTED: f64 = 0.5;

/// Gain, in energies of the scene, from which on a run is lost.
const LOST: f64 = 100.0;

/// Speed that nobody sees, in radii of the scene (1/s): rounding moves what is at rest more slowly.
const UNSEEN: f64 = 1e-9;

/// Energy that nothing put into a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gain {
    /// The energy (J).
    pub energy: f64,
    /// The energy over that of the scene: what it began with, what its weight gives it over its own
    /// size, and the work done on it.
    pub share: f64,
}

/// Balance of energy of a run (J).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Balance {
    /// Time of the last look (s).
    time: f64,
    /// Energy at the last look.
    energy: f64,
    /// Energy at the beginning, with what hands have changed since.
    begin: f64,
    /// Energy of the scene: kinetic and elastic at the beginning, its weight times its radius, and
    /// that of a motion that nobody sees.
    own: f64,
    /// Largest fall of the gravitational energy, and that energy at the beginning.
    fall: f64,
    gravitational: f64,
    /// Most work that was done on the run.
    work: f64,
    /// Power at the last look (W).
    power: f64,
    /// Share of the last look's gain.
    share: f64,
    /// Largest gain.
    most: Option<Gain>,
}

impl Balance {
    /// Energy that the gain of a run is compared with (J).
    fn scale(&self) -> f64 {
        self.own + self.fall + self.work
    }

    /// Whether the run had gained little when it was last looked at.
    pub(super) fn is_sound(&self) -> bool {
        self.share < NOTED
    }

    /// Whether the particles alone move with more energy than a run may gain. What flies through a
    /// whole scene in a step meets all of it, and costs thousands of steps.
    fn is_exceeded(&self, network: &Network, y: &[f64]) -> bool {
        let (_, v) = network.halves(y);
        let squared = |axis: usize| {
            let v = &v[axis * network.particles()..];
            let terms = network.masses().iter().zip(v).map(|(m, v)| m * v * v);
            terms.sum::<f64>()
        };
        0.5 * (0..3).map(squared).sum::<f64>() > LOST * self.scale()
    }
}

/// Scratch of a balance, and what it is found by.
#[derive(Debug, Default)]
pub(super) struct Watch {
    /// Whether a hand has changed the run since the last look.
    pub disturbed: bool,
    /// Radius of the scene (m).
    radius: f64,
    /// A state, and f.
    scratch: [Vec<f64>; 2],
}

impl Watch {
    /// Balance of a run at y at time t (s), whose scene has that radius (m).
    pub fn begin(&mut self, network: &Network, (t, y): (f64, &[f64]), radius: f64) -> Balance {
        let energy = energy_of(network, t, y);
        let mass = network.masses().iter().sum::<f64>();
        let weight = network.gravity().map_or(0.0, |g| g.norm()) * mass;
        let unseen = 0.5 * mass * (UNSEEN * radius).powi(2);
        (self.disturbed, self.radius) = (false, radius);
        // A step allocates nothing.
        self.scratch = [(); 2].map(|()| vec![0.0; y.len()]);
        Balance {
            time: t,
            energy: energy.total(),
            begin: energy.total(),
            own: energy.kinetic + energy.elastic + energy.contact + weight * radius + unseen,
            gravitational: energy.gravitational,
            ..Balance::default()
        }
    }

    /// Goes on from another state.
    pub fn resume(&mut self) {
        self.disturbed = false;
    }

    /// Forgets what the run gained: it goes on by other steps.
    pub fn start_over(&mut self, balance: &mut Balance) {
        (balance.most, self.disturbed) = (None, true);
    }

    /// Takes what hands changed since the last look as theirs.
    pub fn forgive(&mut self, network: &Network, balance: &mut Balance, t: f64, y: &[f64]) {
        if std::mem::take(&mut self.disturbed) {
            let energy = energy_of(network, t, y).total();
            balance.begin += energy - balance.energy;
            (balance.time, balance.energy, balance.power) = (t, energy, 0.0);
            balance.share = 0.0;
        }
    }

    /// Notes a step to y at time t (s), in which obstacles were met, and after which a particle
    /// seems lost. Returns why the run is lost: what is far away because it fell or was thrown
    /// there has gained nothing, and is not.
    pub fn met(
        &mut self,
        model: &Model,
        balance: &mut Balance,
        now: (f64, &[f64]),
        met: &Statistics,
        lost: Option<Cause>,
    ) -> Option<Cause> {
        let Some(network) = model.network() else {
            return lost;
        };
        let impulse = met.impulse.max(met.guarded.impulse);
        if impulse > 0.0 {
            // Most of the work that obstacles did.
            let speed = |obstacle: &Obstacle| fastest(obstacle, now.0, self.radius);
            let speeds = network.obstacles().iter().map(speed);
            balance.work += impulse * speeds.fold(0.0, f64::max);
        }
        match lost {
            Some(Cause::Away { .. }) => {
                self.look(network, balance, now, true);
                lost.filter(|_| !balance.is_sound())
            }
            Some(_) => lost,
            None => self.look(network, balance, now, false),
        }
    }

    /// Looks at the energy of y at time t (s), if it is time to, or at once. Returns the gain by
    /// which the run is lost.
    fn look(
        &mut self,
        network: &Network,
        balance: &mut Balance,
        (t, y): (f64, &[f64]),
        at_once: bool,
    ) -> Option<Cause> {
        let driven = is_driven(network);
        let since = t - balance.time;
        let early = !at_once && since < if driven { DRIVEN } else { REST };
        if early && !(network.contact_layer().is_some() && balance.is_exceeded(network, y)) {
            return None;
        }
        let energy = energy_of(network, t, y);
        let power = if driven {
            power(network, t, y, &mut self.scratch).max(0.0)
        } else {
            0.0
        };
        balance.work += 0.5 * (balance.power + power) * since;
        balance.fall = balance
            .fall
            .max(balance.gravitational - energy.gravitational);
        (balance.time, balance.energy, balance.power) = (t, energy.total(), power);
        let gain = balance.energy - balance.begin - balance.work;
        let share = gain / balance.scale();
        balance.share = share;
        if gain > 0.0 && balance.most.is_none_or(|most| share > most.share) {
            balance.most = Some(Gain {
                energy: gain,
                share,
            });
        }
        (share > LOST).then(|| {
            let (particle, speed) = fastest_particle(network.halves(y).1);
            Cause::Gained {
                energy: gain,
                particle,
                speed,
            }
        })
    }
}

impl Simulation {
    /// Begins the balance with the state as it is now.
    pub(super) fn begin_watch(&mut self) {
        if let Model::Network(network) = &self.model {
            let (now, radius) = ((self.state.since, &self.state.y[..]), self.radius);
            self.state.balance = self.watch.begin(network, now, radius);
        }
    }

    /// Energy that the method put into the run, if it is more than the scene has of its own: the
    /// step is too long.
    #[must_use]
    pub fn gained(&self) -> Option<Gain> {
        self.state.balance.most.filter(|gain| gain.share > NOTED)
    }
}

/// Most of the speed of an obstacle's points within reach of a scene of that radius (m), in m/s.
fn fastest(obstacle: &Obstacle, t: f64, radius: f64) -> f64 {
    let pose = obstacle.at(t);
    let spin = pose.orientation.map_or(0.0, |turned| turned.spin.norm());
    pose.place.velocity.norm() + spin * 2.0 * radius
}

/// The fastest of particles with velocities v, n x 3, and its speed (m/s).
fn fastest_particle(v: &[f64]) -> (usize, f64) {
    let n = v.len() / 3;
    let speed = |i: usize| {
        (0..3)
            .map(|axis| v[axis * n + i].powi(2))
            .sum::<f64>()
            .sqrt()
    };
    let speeds = (0..n).map(|i| (i, speed(i)));
    speeds
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or_default()
}

/// Whether something may work on a network, beside obstacles that particles meet.
fn is_driven(network: &Network) -> bool {
    let moves = |path: &Path| !matches!(path, Path::Still(_));
    let touches = network.contact_layer().is_some();
    let mut obstacles = network.obstacles().iter().filter(|_| touches);
    network.wind().is_some()
        || network.pins().any(|(_, path)| moves(&path))
        || network
            .elements()
            .iter()
            .any(|element| matches!(element, Element::Attraction(_)))
        || obstacles.any(|obstacle| moves(&obstacle.path) || obstacle.turn.is_some())
}

/// Energy of y at time t (s), without that of the motion of pins, which is given and may begin at
/// once.
fn energy_of(network: &Network, t: f64, y: &[f64]) -> Energy {
    let (_, v) = network.halves(y);
    let (n, masses) = (network.particles(), network.masses());
    let mut energy = network.energy_of(t, y);
    for (i, _) in network.pins() {
        let squared: f64 = (0..3).map(|axis| v[axis * n + i].powi(2)).sum();
        energy.kinetic -= 0.5 * masses[i] * squared;
    }
    energy
}

/// Rate at which the energy of the exact motion grows at y at time t (W).
fn power(network: &Network, t: f64, y: &[f64], [state, f]: &mut [Vec<f64>; 2]) -> f64 {
    network.eval_f(t, y, f);
    let mut at = |moment: f64| {
        state.clear();
        state.extend(y.iter().zip(&*f).map(|(y, f)| y + moment * f));
        energy_of(network, t + moment, state).total()
    };
    (at(MOMENT) - at(-MOMENT)) / (2.0 * MOMENT)
}
