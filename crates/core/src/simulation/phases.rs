//! Phases after an integrator's step: springs that are too long are shortened, particles are moved
//! out of obstacles, surfaces are kept from passing through one another, and pins are put in their
//! places.

use super::depths::Depths;
use super::jointed::JointsOf;
use crate::columns::row;
use crate::constraints::Constraint;
use crate::contact::{
    ContactPhase, Impulses, Pinched, Statistics, Step, StrainLimiter, Strained, bulge, guard,
    resolve,
};
use crate::error::Cause;
use crate::network::{Network, has_ropes, outflows, project};
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
    /// States before contact.
    scratch: [Vec<f64>; 2],
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
            scratch: Default::default(),
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
        if limit.is_some() || changes || network.contact_layer().is_some() {
            self.contact.remember(y0);
        } else {
            self.contact.begin(network.obstacles(), y0, retry);
        }
    }

    /// Returns the state at the beginning of the step, as far as it was remembered.
    pub fn y0(&self) -> &[f64] {
        self.contact.y0()
    }

    /// Returns the largest distance of vertices of surfaces from the chords of their courses in a
    /// step of h (s) from time t (s) to y1, over the least thickness; 0 if nothing touches.
    pub fn bulge(&self, model: &Model, (t, h): (f64, f64), y1: &[f64]) -> f64 {
        let layer = model.network().and_then(Network::contact_layer);
        let states = [self.y0(), y1];
        let is_known = states[0].len() == states[1].len();
        layer
            .filter(|_| is_known)
            .map_or(0.0, |layer| bulge(layer, (t, h), states))
    }

    /// Applies impacts to the particles that touch an obstacle at the end of a step of h (s) that
    /// ends at time t (s), with `times` = (t, h). Rebounds that the depths leave out do not begin.
    pub fn strike(&mut self, network: &Network, times: (f64, f64), depths: Depths, y: &mut [f64]) {
        let left_out = |restitution, place| depths.left_out(restitution, place);
        let (obstacles, inverse_masses) = (network.obstacles(), network.inverse_masses());
        self.contact.strike(
            obstacles,
            inverse_masses,
            times,
            (depths.none, &left_out),
            y,
        );
    }

    /// Settles y1, the end of a step of h (s) from time t (s).
    ///
    /// # Errors
    /// Prescribed motions leave surfaces no room.
    pub fn settle(
        &mut self,
        model: &Model,
        (t, h): (f64, f64),
        y1: &mut [f64],
    ) -> Result<Settled, Cause> {
        let mut settled = Settled::default();
        let Some(network) = model.network() else {
            model.system().hold(t + h, y1);
            return Ok(settled);
        };
        self.shorten(network, h, y1, &mut settled);
        settled.met = self.part(network, (t, h), y1)?;
        Ok(settled)
    }

    /// Settles a state that is shown, h (s) after the beginning of a step from t (s). The
    /// polynomial of a step ignores surfaces. That of an adaptive step ignores obstacles too; that
    /// of a fixed step ends where contact with them has moved the particles, so with
    /// `knows_obstacles` they are left as they are.
    pub fn settle_shown(
        &self,
        network: &Network,
        (t, h): (f64, f64),
        knows_obstacles: bool,
        y: &mut [f64],
    ) {
        let y0 = self.y0();
        if y0.len() != y.len() {
            return;
        }
        let inverse_masses = network.inverse_masses();
        if let Some(layer) = network.contact_layer() {
            // If prescribed motions leave no room, the step itself has ended the run.
            let none = &mut Impulses::default();
            let joints = JointsOf::new(network);
            let _ = guard(layer, joints.bodies(false), (t, h), y0, y, none);
        } else if !knows_obstacles {
            resolve(network.obstacles(), inverse_masses, &Step { t, h, y0 }, y);
        }
        network.hold(t + h, y);
        if network.is_constrained() && network.can_touch() {
            project(network, y, true);
        }
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

    /// Shortens springs that are too long.
    fn shorten(&mut self, network: &Network, h: f64, y1: &mut [f64], settled: &mut Settled) {
        if let Some(limit) = network.strained() {
            settled.strained = self.limiter.resolve(limit, network.inverse_masses(), h, y1);
            settled.grown = settled.strained.excess - self.excess;
        }
    }

    /// Moves particles out of obstacles, or keeps surfaces from passing through one another. That
    /// moves a particle or a body alone: where constraints are, those on which it then pulls are
    /// moved after it, in turns, until contact moves hardly anything any more.
    fn part(
        &mut self,
        network: &Network,
        times: (f64, f64),
        y1: &mut [f64],
    ) -> Result<Statistics, Cause> {
        let joints = JointsOf::new(network);
        let touches = network.contact_layer().is_some();
        let takes_turns = network.is_constrained() && (touches || !network.obstacles().is_empty());
        if touches || takes_turns {
            network.hold(times.0 + times.1, y1);
        }
        if !takes_turns {
            return self.meet((&joints, false), times, y1);
        }
        let [mut unstruck, mut before] = std::mem::take(&mut self.scratch);
        unstruck.clear();
        unstruck.extend_from_slice(y1);
        let met = self.meet((&joints, false), times, y1)?;
        let first = largest_shift(network, [&unstruck, y1]);
        let mut last = first;
        for _ in 0..MAX_ROUNDS {
            // A state that is not finite is reported later.
            if last.is_nan() || last <= SETTLED_SHARE * first {
                break;
            }
            project(network, y1, true);
            before.clear();
            before.extend_from_slice(y1);
            self.meet((&joints, true), times, y1)?;
            last = largest_shift(network, [&before, y1]);
        }
        joints.balance(times.0 + times.1, met.impulse, &unstruck, y1);
        self.scratch = [unstruck, before];
        Ok(met)
    }

    /// Moves particles out of obstacles, or keeps surfaces from passing through one another, in a
    /// step that has impulses in it already or not.
    fn meet(
        &mut self,
        (joints, are_struck): (&JointsOf, bool),
        (t, h): (f64, f64),
        y1: &mut [f64],
    ) -> Result<Statistics, Cause> {
        let network = joints.network();
        let Some(layer) = network.contact_layer() else {
            let obstacles = network.obstacles();
            let inverse_masses = network.inverse_masses();
            let met = self.contact.resolve(obstacles, inverse_masses, (t, h), y1);
            network.hold(t + h, y1);
            return Ok(met);
        };
        // A state that is not finite is reported afterwards.
        if y1.iter().any(|y| !y.is_finite()) {
            return Ok(Statistics::default());
        }
        let guarded = self
            .contact
            .guard(layer, joints.bodies(are_struck), (t, h), y1);
        let met = guarded.map_err(|Pinched { vertices }| Cause::Pinched { vertices })?;
        if !network.bodies().is_empty() {
            network.hold(t + h, y1);
        }
        Ok(met)
    }
}

/// Returns the largest displacement (m) between two states of anything that constraints hold.
fn largest_shift(network: &Network, [a, b]: [&[f64]; 2]) -> f64 {
    let n = network.particles();
    let ends = network.constraints().iter().map(Constraint::ends);
    let held = ends.flat_map(|(first, second)| [Some(first), second]);
    let shifts = held.flatten().map(|i| (row(b, n, i) - row(a, n, i)).norm());
    shifts.fold(0.0, f64::max)
}
