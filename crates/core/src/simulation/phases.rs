//! Phases after an integrator's step: springs that are too long are shortened, particles are moved
//! out of obstacles, surfaces are kept from passing through one another, and pins are put in their
//! places. Where constraints hold what meets something, they change the impulses, and the energy of
//! such a step.

use std::cell::Cell;
use std::convert::Infallible;

use super::depths::Depths;
use crate::columns::row;
use crate::constraints::{Constraint, Pushed};
use crate::contact::{
    Bodies, ContactPhase, Course, Impulses, Joints, Obstacle, Pinched, Statistics, Step,
    StrainLimiter, Strained, bulge, earliest, guard, resolve,
};
use crate::error::Cause;
use crate::interval::Interval;
use crate::network::{
    Network, add, has_ropes, is_held, outflows, pass_on, project, project_velocities, pulls,
    tensions,
};
use crate::rigid::ROTATION;
use crate::scene::Model;
use crate::system::{Mechanics, ParticleSystem};

/// Largest number of turns of contact and joints.
const MAX_ROUNDS: usize = 40;

/// Displacement by contact, over the first one, that ends these turns.
const SETTLED_SHARE: f64 = 1e-2;

/// Phases after a step, with their scratch.
pub(super) struct Phases {
    limiter: StrainLimiter,
    pub contact: ContactPhase,
    /// Excess length of the longest limited spring at the beginning of the step, if it is needed.
    excess: f64,
    /// Whether velocities may lag behind the displacement of the step: they do with fixed steps of
    /// order 1, and never with a tolerance.
    pub may_lag: bool,
}

/// Result of the phases after a step.
#[derive(Clone, Copy, Default)]
pub(super) struct Settled {
    pub strained: Strained,
    pub met: Statistics,
    /// Growth in the step of the excess length of the longest limited spring.
    pub grown: f64,
}

impl Phases {
    /// Creates phases with room for states of that length.
    pub fn new(dim: usize) -> Self {
        Self {
            limiter: StrainLimiter::new(dim),
            contact: ContactPhase::new(dim),
            excess: 0.0,
            may_lag: true,
        }
    }

    /// Remembers the parts of the state y0 at the beginning of a step that the phases need or, with
    /// `retry`, that are needed to take the step again.
    pub fn begin(&mut self, model: &Model, y0: &[f64], retry: bool) {
        let Some(network) = model.network() else {
            return;
        };
        self.excess = 0.0;
        let limit = network.strained().filter(|_| retry);
        if let Some(limit) = limit {
            self.excess = limit.excess(network.halves(y0).0);
        }
        let changes = network.tear_limit().is_some() || has_ropes(network);
        let changes = retry && (changes || !outflows(network).is_empty());
        let passes_on = network.is_constrained() && network.can_touch();
        if limit.is_some() || changes || passes_on || network.contact_layer().is_some() {
            self.contact.remember(y0);
        } else {
            self.contact.begin(network.solids(), y0, retry);
        }
    }

    /// Returns the state at the beginning of the step, as far as it was remembered.
    pub fn y0(&self) -> &[f64] {
        self.contact.y0()
    }

    /// Returns the largest distance of vertices of surfaces from the chords of their courses in a
    /// step of h (s) from time t (s) to y1, over the least thickness; 0 if nothing touches. Soft
    /// surfaces count if `soft_count`.
    pub fn bulge(
        &self,
        model: &Model,
        Interval { t, h }: Interval,
        y1: &[f64],
        soft_count: bool,
    ) -> f64 {
        let layer = model.network().and_then(Network::contact_layer);
        let states = [self.y0(), y1];
        let is_known = states[0].len() == states[1].len();
        layer
            .filter(|_| is_known)
            .map_or(0.0, |layer| bulge(layer, Interval { t, h }, states, soft_count))
    }

    /// Applies impacts to the particles that touch an obstacle at the end of a step of h (s) that
    /// ends at time t (s), with `times` = (t, h). Rebounds that the depths leave out do not begin.
    pub fn strike(&mut self, network: &Network, times: (f64, f64), depths: Depths, y: &mut [f64]) {
        let left_out = |restitution, place| depths.left_out(restitution, place);
        let joints = JointsOf::new(network, self.may_lag);
        let (obstacles, bodies) = (network.solids(), joints.bodies(false));
        let least = (depths.none, &left_out as &dyn Fn(f64, _) -> f64);
        self.contact.strike(obstacles, bodies, times, least, y);
    }

    /// Settles y1, the end of a step of h (s) from time t (s).
    ///
    /// # Errors
    /// Prescribed motions leave surfaces no room.
    pub fn settle(
        &mut self,
        model: &Model,
        Interval { t, h }: Interval,
        y1: &mut [f64],
    ) -> Result<Settled, Cause> {
        let mut settled = Settled::default();
        let Some(network) = model.network() else {
            model.system().hold(t + h, y1);
            return Ok(settled);
        };
        self.shorten(network, h, y1, &mut settled);
        settled.met = self.part(network, Interval { t, h }, y1)?;
        Ok(settled)
    }

    /// Settles a state that is shown, h (s) after the beginning of a step from t (s). The
    /// polynomial of a step ignores surfaces. That of an adaptive step ignores obstacles too; that
    /// of a fixed step ends where contact with them has moved the particles, so with
    /// `knows_obstacles` they are left as they are.
    pub fn settle_shown(
        &self,
        network: &Network,
        Interval { t, h }: Interval,
        knows_obstacles: bool,
        y: &mut [f64],
    ) {
        let y0 = self.y0();
        if y0.len() != y.len() {
            return;
        }
        let joints = JointsOf::new(network, self.may_lag);
        let meet = |y: &mut [f64], are_struck: bool| {
            if let Some(layer) = network.contact_layer() {
                // If prescribed motions leave no room, the step itself has ended the run.
                let none = &mut Impulses::default();
                let _ = guard(layer, joints.bodies(are_struck), Interval { t, h }, y0, y, none);
            } else if !knows_obstacles {
                let step = Step { t, h, y0 };
                resolve(network.solids(), network.inverse_masses(), &step, y);
            }
            network.hold(t + h, y);
            Ok::<_, Infallible>(())
        };
        let Ok(()) = if network.is_constrained() && network.can_touch() {
            network.hold(t + h, y);
            project(network, y, true);
            in_turns(network, y, meet)
        } else {
            meet(y, false)
        };
    }

    /// Returns the contact forces (N), n x 3, on the particles of a network at y at time t (s):
    /// those of surfaces, and the impulses of the last step, divided by its length.
    pub fn contact_forces(&self, network: &Network, t: f64, y: &[f64]) -> Vec<f64> {
        let mut f = vec![0.0; 3 * network.particles()];
        if let Some(layer) = network.contact_layer() {
            let (x, v) = network.halves(y);
            layer.add_repulsion(t, x, v, &mut f);
        }
        self.contact.add_forces(&mut f);
        f
    }

    /// Returns an upper bound of the impulses (N s) of moving obstacles in the last step, which
    /// ended with y at time t (s); 0 if no obstacle moves.
    pub fn reaction(&self, network: &Network, t: f64, y: &[f64]) -> f64 {
        if network.obstacles().iter().all(Obstacle::is_still) {
            return 0.0;
        }
        let n = network.particles();
        let mut rates = vec![0.0; y.len()];
        network.eval_f(t, y, &mut rates);
        let forces = &mut rates[3 * n..6 * n];
        for (k, force) in forces.iter_mut().enumerate() {
            *force *=
                if network.inverse_masses()[k % n] > 0.0 { network.masses()[k % n] } else { 0.0 };
        }
        self.contact.reaction(forces)
    }

    /// Shortens springs that are too long.
    fn shorten(&mut self, network: &Network, h: f64, y1: &mut [f64], settled: &mut Settled) {
        if let Some(limit) = network.strained() {
            settled.strained = self.limiter.resolve(limit, network.inverse_masses(), h, y1);
            settled.grown = settled.strained.excess - self.excess;
        }
    }

    /// Moves particles out of obstacles, or keeps surfaces from passing through one another; where
    /// constraints are, in turns.
    fn part(
        &mut self,
        network: &Network,
        times: Interval,
        y1: &mut [f64],
    ) -> Result<Statistics, Cause> {
        let joints = JointsOf::new(network, self.may_lag);
        let touches = network.contact_layer().is_some();
        let takes_turns = network.is_constrained() && (touches || !network.solids().is_empty());
        if touches || takes_turns {
            network.hold(times.t + times.h, y1);
        }
        if !takes_turns {
            return self.meet((&joints, false), times, y1);
        }
        let unstruck = y1.to_vec();
        let meet = |y: &mut [f64], are_struck: bool| self.meet((&joints, are_struck), times, y);
        let met = in_turns(network, y1, meet)?;
        joints.balance(times.t + times.h, met.impulse, &unstruck, y1);
        Ok(met)
    }

    /// Moves particles out of obstacles, or keeps surfaces from passing through one another, in a
    /// step that has impulses in it already or not.
    fn meet(
        &mut self,
        (joints, are_struck): (&JointsOf, bool),
        Interval { t, h }: Interval,
        y1: &mut [f64],
    ) -> Result<Statistics, Cause> {
        let network = joints.network();
        let Some(layer) = network.contact_layer() else {
            let (obstacles, bodies) = (network.solids(), joints.bodies(are_struck));
            let met = self.contact.resolve(obstacles, bodies, Interval { t, h }, y1);
            network.hold(t + h, y1);
            return Ok(met);
        };
        // A state that is not finite is reported afterwards.
        if y1.iter().any(|y| !y.is_finite()) {
            return Ok(Statistics::default());
        }
        let guarded = self.contact.guard(layer, joints.bodies(are_struck), Interval { t, h }, y1);
        let met = guarded.map_err(|Pinched { vertices }| Cause::Pinched { vertices })?;
        if !network.bodies().is_empty() {
            network.hold(t + h, y1);
        }
        Ok(met)
    }
}

/// Moves what touches in the state y at the end of a step, by `meet`. That moves a particle or a
/// body alone: others that constraints join to it are moved after it. Both alternate until contact
/// moves hardly anything any more. `meet` is told whether the step has impulses of an earlier turn;
/// returns its result in the first one.
fn in_turns<T, E>(
    network: &Network,
    y: &mut [f64],
    mut meet: impl FnMut(&mut [f64], bool) -> Result<T, E>,
) -> Result<T, E> {
    let mut before = y.to_vec();
    let met = meet(y, false)?;
    let first = largest_shift(network, [&before, y]);
    let mut last = first;
    for _ in 0..MAX_ROUNDS {
        // A state that is not finite is reported later.
        if last.is_nan() || last <= SETTLED_SHARE * first {
            break;
        }
        project(network, y, true);
        before.copy_from_slice(y);
        meet(y, true)?;
        last = largest_shift(network, [&before, y]);
    }
    Ok(met)
}

/// Returns the largest displacement (m) between two states of anything that constraints hold.
fn largest_shift(network: &Network, [a, b]: [&[f64]; 2]) -> f64 {
    let n = network.particles();
    let ends = network.constraints().iter().map(Constraint::ends);
    let held = ends.flat_map(|(first, second)| [Some(first), second]);
    let shifts = held.flatten().map(|i| (row(b, n, i) - row(a, n, i)).norm());
    shifts.fold(0.0, f64::max)
}

/// Shortest interval in the search for a spring that is too long, as a share of the piece.
const MIN_INTERVAL: f64 = 1e-4;

/// Number of intervals of a piece at whose ends the lengths of ropes are looked at.
const INTERVALS: u32 = 8;

/// Number of bisections of such an interval.
const BISECTIONS: u32 = 45;

/// Finds the share of a piece at which a vector is first longer than `longest` (m).
pub(super) fn first_longer(apart: &Course, longest: f64) -> Option<f64> {
    let [speed, _] = apart.bounds();
    earliest([0.0, 1.0], MIN_INTERVAL, |[a, b]| {
        let middle = apart.position(0.5 * (a + b));
        middle.norm() + speed * 0.5 * (b - a) >= longest
    })
}

/// Finds the share of a piece at which a vector becomes longer than `longest` (m), unless that
/// lasts for less than one of the intervals of the piece. A rope that has just rebounded begins at
/// its length.
pub(super) fn first_beyond(apart: &Course, longest: f64) -> Option<f64> {
    let is_longer = |share: f64| apart.position(share).norm() > longest;
    let end = |k: u32| f64::from(k) / f64::from(INTERVALS);
    let k = (1..=INTERVALS).find(|k| is_longer(end(*k)))?;
    let (mut low, mut high) = (end(k - 1), end(k));
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        *(if is_longer(middle) { &mut high } else { &mut low }) = middle;
    }
    Some(high)
}

/// Largest share by which jumps of velocities are changed.
const MAX_SHARE: f64 = 0.05;

/// Share of a sum of impulses that is a rounding error.
const ROUNDING: f64 = 1e-12;

/// Constraints of a network.
struct JointsOf<'a> {
    network: &'a Network,
    may_lag: bool,
    /// Sum of the magnitudes of the impulses that they have passed on (N s), and their work (J).
    noted: Cell<[f64; 2]>,
}

impl<'a> JointsOf<'a> {
    pub fn new(network: &'a Network, may_lag: bool) -> Self {
        Self { network, may_lag, noted: Cell::default() }
    }

    pub fn network(&self) -> &'a Network {
        self.network
    }

    /// Returns what impulses of contact act on, in a step that has impulses in it already or not.
    pub fn bodies(&self, are_struck: bool) -> Bodies<'_> {
        Bodies {
            inverse_masses: self.network.inverse_masses(),
            joints: self.network.is_constrained().then_some(self),
            are_struck,
            may_lag: self.may_lag,
        }
    }

    /// Gives y, the end of a step at time t (s), the energy of the step without impacts, which ends
    /// at `unstruck`, and of the work of their impulses, if these were all impulses of contact
    /// (N s): the forces of the rest of the step are those on the course without impacts, from
    /// which joints turn the bodies. The jump of the velocities is made a little larger or smaller.
    pub fn balance(&self, t: f64, all: f64, unstruck: &[f64], y: &mut [f64]) {
        let [impulse, work] = self.noted.get();
        if impulse == 0.0 || impulse < (1.0 - ROUNDING) * all {
            return;
        }
        let first = 3 * self.network.particles();
        let after = y.to_vec();
        let mut energy = |share: f64| {
            for k in first..y.len() {
                let of_rotation = k.checked_sub(2 * first).map(|number| number % ROTATION);
                if of_rotation.is_none_or(|number| number >= 4) {
                    y[k] = after[k] + (after[k] - unstruck[k]) * share;
                }
            }
            self.network.energy_of(t, y).total()
        };
        let [less, same, more] = [-1.0, 0.0, 1.0].map(&mut energy);
        // The energy is quadratic in the share.
        let (slope, bend) = (0.5 * (more - less), 0.5 * (more + less) - same);
        let lacks = self.network.energy_of(t, unstruck).total() + work - same;
        let root = (slope * slope + 4.0 * bend * lacks).sqrt();
        let share = 2.0 * lacks / (slope + root);
        energy(if share.abs() < MAX_SHARE { share } else { 0.0 });
        project_velocities(self.network, y);
    }
}

impl Joints for JointsOf<'_> {
    fn hold(&self, i: usize) -> bool {
        is_held(self.network, i)
    }

    fn fit(&self, y: &mut [f64]) {
        pass_on(self.network, y);
    }

    fn pulls(&self, y: &[f64]) -> Vec<(usize, Vec<Pushed>)> {
        pulls(self.network, y)
    }

    fn tensions(&self, t: f64, y: &[f64]) -> Vec<(usize, f64)> {
        tensions(self.network, t, y)
    }

    fn push(&self, effects: &[Pushed], y: &mut [f64]) {
        add(self.network, effects, y);
    }

    fn note(&self, impulse: f64, work: f64) {
        let [impulses, works] = self.noted.get();
        self.noted.set([impulses + impulse, works + work]);
    }
}
