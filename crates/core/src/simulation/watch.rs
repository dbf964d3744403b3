//! Watch over a run: finds blow-ups at the ends of steps and where something changes the run.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::balance::Balance;
use super::power::{End, Evaluated, Power, energy_of};
use super::state::RunState;
use crate::columns::row;
use crate::contact::{Obstacle, Statistics};
use crate::control::Control;
use crate::error::{Cause, Error};
use crate::interval::Interval;
use crate::network::{Network, energy_of_errors};
use crate::scene::{Model, StepLimits};
use crate::system::{Mechanics, ParticleSystem};

/// Error of a constraint over its length at which a run counts as blown up.
const MAX_CONSTRAINT_ERROR: f64 = 0.1;

/// Memory of a watch, beside the state of its run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Watched {
    /// Time of the beginning of the last step (s), and its work (J).
    last: (f64, f64),
    power: Option<Evaluated>,
}

impl Watched {
    /// Checks that this belongs to a run of a model.
    ///
    /// # Errors
    /// It belongs to another one, or has numbers that are not finite.
    pub fn check(&self, model: &Model) -> Result<(), Error> {
        if !(self.last.0.is_finite() && self.last.1.is_finite()) {
            let why = "the work in a checkpoint must be finite";
            return Err(Error::Invalid(why.into()));
        }
        let mut power = self.power.iter();
        power.try_for_each(|power| power.check(model.network()))
    }
}

/// Watch over the energy and the constraints of a run.
#[derive(Debug)]
pub(super) struct Watch {
    power: Power,
    /// Radius of the scene (m).
    radius: f64,
    limits: StepLimits,
    /// Time of the beginning of the last step (s), and its work (J).
    last: (f64, f64),
    /// Forces (N), or rates of change of a state.
    scratch: Vec<f64>,
}

impl Watch {
    /// Creates a watch over runs of a scene with that radius (m).
    pub fn new(radius: f64, limits: StepLimits) -> Self {
        Self { power: Power::default(), radius, limits, last: (0.0, 0.0), scratch: vec![] }
    }

    /// Starts to watch a run at the beginning of its steps.
    pub fn begin(&mut self, model: &Model, state: &mut RunState) {
        if let Some(network) = model.network() {
            let (t, y) = (state.since, &state.y[..]);
            // Allocated here, so that steps allocate nothing.
            *self = Self {
                scratch: Vec::with_capacity(y.len()),
                ..Self::new(self.radius, self.limits)
            };
            self.power.begin(network, t, y);
            state.balance = Balance::new(network, (t, y), self.radius);
        }
        self.tolerate(model, state);
    }

    /// Forgets the gains of a run that continues with another step or method.
    pub fn start_over(&mut self, model: &Model, state: &mut RunState) {
        state.balance.start_over();
        self.power.forget();
        self.tolerate(model, state);
    }

    /// Counts the energy of errors within the tolerance as no gain: at rest, an adaptive method
    /// takes steps so long that it only just meets its tolerance. A method of order 1 may gain all
    /// energy of the motion in its first step.
    fn tolerate(&mut self, model: &Model, state: &mut RunState) {
        let Some(network) = model.network() else {
            return;
        };
        let (t, y) = (state.time(), &state.y[..]);
        let errors = match state.control {
            Control::Step(h) => kick(network, Interval { t, h }, y, &mut self.scratch),
            Control::Tolerance(relative) => {
                let error = self.limits.absolute.unwrap_or(relative * self.radius);
                energy_of_errors(network, t, y, error)
            }
        };
        state.balance.tolerate(errors);
    }

    /// Starts to watch the run from another state.
    pub fn forget(&mut self) {
        self.power.forget();
    }

    /// Returns the memory of the watch.
    pub fn watched(&self) -> Watched {
        let power = self.power.evaluated();
        let last = self.last;
        Watched { last, power }
    }

    /// Continues a watch over a run of a model from the end of its last step.
    pub fn resume(&mut self, model: &Model, end: End, watched: &Watched) {
        self.last = watched.last;
        if let (Some(network), Some(last)) = (model.network(), &watched.power) {
            self.power.resume(network, end, last);
        }
    }

    /// Checks a run at time t (s), before something changes it, within or at the end of a step that
    /// ends at `end` (s).
    pub fn disturb(&mut self, model: &Model, state: &mut RunState, t: f64, end: f64) {
        let (y, order) = (&state.y[..], state.method.order);
        let is_adaptive = state.control.step().is_none();
        let network = model.network().filter(|_| !state.balance.is_disturbed());
        let rest =
            network.map(|network| self.power.rest(network, End { order, is_adaptive, t, y }));
        self.power.forget();
        let Some(network) = network else {
            return;
        };
        state.balance.add(rest.unwrap_or_default());
        let (begin, work) = self.last;
        if t < end && begin < end {
            let rest = work * (end - t) / (end - begin);
            state.balance.take_back(rest);
        }
        state.balance.check(network, (t, &state.y), &mut self.scratch);
        state.balance.disturb();
    }

    /// Accounts for changes by hands since the last check: they count as no gain, and neither does
    /// the energy that forces then give in the first step.
    pub fn forgive(&mut self, model: &Model, state: &mut RunState) {
        if let Some(network) = model.network()
            && state.balance.is_disturbed()
        {
            let energy = energy_of(network, state.time(), &state.y).total();
            state.balance.forgive(energy);
            if let Control::Step(h) = state.control {
                let step = Interval { t: state.time(), h };
                let energy = kick(network, step, &state.y, &mut self.scratch);
                state.balance.tolerate(energy);
            }
        }
    }

    /// Prepares for a step from y at time t (s).
    pub fn begin_step(&mut self, model: &Model, t: f64, y: &[f64]) {
        if let Some(network) = model.network() {
            self.power.begin(network, t, y);
        }
        self.last = (t, 0.0);
    }

    /// Forgets the forces that work on the scene, because springs have torn.
    pub fn forget_power(&mut self) {
        self.power.forget();
    }

    /// Returns the cause of a blow-up, if the particles move with more kinetic energy than a run
    /// may gain. This is checked before the collision safeguard acts: a particle that flies through
    /// the whole scene in one step meets all of it, which would cost as much as thousands of steps.
    pub fn check_before_safeguard(
        &self,
        model: &Model,
        balance: &mut Balance,
        end: End,
    ) -> Option<Cause> {
        let network = model.network()?;
        if network.contact_layer().is_none()
            || balance.is_disturbed()
            || !balance.is_exceeded(network, end.y)
        {
            return None;
        }
        // The points of bodies are at their places only now.
        let mut y = end.y.to_vec();
        network.hold(end.t, &mut y);
        let work = self.power.clone().work(network, End { y: &y, ..end }, true, 0.0);
        let mut checked = *balance;
        checked.add(work);
        // The safeguard takes back how far surfaces have got into one another.
        checked.allow(network.energy_of(end.t, &y).contact);
        let cause = checked.check(network, (end.t, &y), &mut vec![]);
        balance.widen(&checked);
        cause
    }

    /// Records the end of a step, with its contacts, and what `SceneBounds` has found. Returns the
    /// cause of a blow-up, if there is one: a particle that is far away because it fell or was
    /// thrown has gained no energy, and is none.
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
        let is_due = balance.is_due(t) || away;
        let impulse = met.impulse.max(met.guarded.impulse);
        // Between velocities before and after an impact, constraints would not be met.
        let is_smooth = impulse == 0.0 || !network.is_constrained();
        let order = if is_smooth { end.order } else { 1 };
        let mut work = self.power.work(network, End { order, ..end }, is_due, balance.stake());
        if impulse > 0.0 {
            // Upper bound of the work of obstacles.
            let n = network.particles();
            let reach = |from: Vector3<f64>| {
                let away = (0..n).map(|i| (row(y, n, i) - from).norm());
                away.fold(0.0, f64::max) + self.radius
            };
            let speed = |obstacle: &Obstacle| fastest(obstacle, t, reach);
            let speeds = network.obstacles().iter().map(speed);
            work += impulse * speeds.fold(0.0, f64::max);
            balance.leave_open();
        }
        balance.add(work);
        self.last.1 = work;
        let worst = network.worst_constraint(y, self.radius);
        if let Some(unmet) = &worst {
            balance.note(unmet);
        }
        let gained = if is_due { balance.check(network, (t, y), &mut self.scratch) } else { None };
        let broken = worst.filter(|unmet| unmet.share > MAX_CONSTRAINT_ERROR).map(Cause::Unmet);
        let lost = lost.filter(|_| !balance.is_sound());
        broken.or(lost).or(gained)
    }

    /// Returns the balance of a run at the end of its last step, at y at time t (s), and the cause
    /// of a blow-up, if there is one.
    pub fn balance_at(
        &self,
        model: &Model,
        mut balance: Balance,
        end: End,
    ) -> (Balance, Option<Cause>) {
        // Changes by hands since the last check are no gain.
        let network = model.network().filter(|_| !balance.is_disturbed());
        let lost = network.and_then(|network| {
            balance.add(self.power.rest(network, end));
            balance.check(network, (end.t, end.y), &mut vec![])
        });
        (balance, lost)
    }
}

/// Returns the kinetic energy (J) that the forces at y at time t (s) give to particles at rest in a
/// step of h (s), with scratch for rates of change.
fn kick(network: &Network, Interval { t, h }: Interval, y: &[f64], rates: &mut Vec<f64>) -> f64 {
    let n = network.particles();
    rates.clear();
    rates.resize(y.len(), 0.0);
    network.eval_f(t, y, rates);
    let squared = |k: usize| rates[3 * n + k].powi(2) * network.masses()[k % n];
    let pulled = (0..3 * n).filter(|k| network.inverse_masses()[k % n] > 0.0);
    let energy = 0.5 * h * h * pulled.map(squared).sum::<f64>();
    if energy.is_finite() { energy } else { 0.0 }
}

/// Returns an upper bound of the speed (m/s) of the points of an obstacle that something can touch.
/// `reach` returns a distance (m) from a place up to which there is something.
fn fastest(obstacle: &Obstacle, t: f64, reach: impl Fn(Vector3<f64>) -> f64) -> f64 {
    let pose = obstacle.at(t);
    let spin = pose.orientation.map_or(0.0, |turned| turned.spin.norm());
    let turning = if spin > 0.0 { spin * reach(pose.place.position) } else { 0.0 };
    pose.place.velocity.norm() + turning
}
