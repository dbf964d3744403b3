//! Jumps of velocities in a network at one time: at the start, where the velocity of a pin jumps,
//! after a hand has changed something, and where ropes tighten; and which ropes are taut.

use nalgebra::{Matrix3, Vector3};

use super::evaluation::Loads;
use super::holding::project_velocities;
use super::parts::Network;
use super::{evaluation, rigid};
use crate::columns::{row, set_row};
use crate::constraints;
use crate::constraints::{
    Constraint, Constraints, Moved, OneSided, Pushed, Struck, Turning, beyond,
};
use crate::contact::{rebound_speed, shortest_rebound};
use crate::rows::Terms;
use crate::system::ParticleSystem;

/// Largest number of impacts at one time: an impact may tighten further ropes.
const MAX_IMPACTS: usize = 100;

/// Largest number of impacts at one time with rebounds, which may follow one another without end.
const MAX_REBOUNDS: usize = 10;

/// Half of the interval of the difference quotient for the acceleration past an end of a joint (s).
const HALF_MOMENT: f64 = 1e-7;

/// Conditions for a rebound: heights (m) and times (s) that are too small for one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Least {
    /// Distance from its length that counts as zero.
    pub none: f64,
    /// Change of length up to which a rebound is left out.
    pub height: f64,
    /// Time up to which a rebound is left out.
    pub time: f64,
    /// Whether there are rebounds at all.
    pub rebounds: bool,
}

impl Least {
    /// Conditions at the start of a run: every rope that is at its length rebounds.
    pub const AT_START: Self = Self { none: 0.0, height: 0.0, time: 0.0, rebounds: true };

    /// Returns the speed (m/s) at which nothing moves farther than what counts as zero in the time
    /// up to which rebounds are left out.
    fn still(&self) -> f64 {
        if self.time > 0.0 { self.none / self.time } else { 0.0 }
    }
}

/// Largest change of a velocity, over the fastest one, that is left to the feedback of the
/// constraints: methods leave errors of that size, and a run may start from a state of another.
const MAX_DRIFT: f64 = 1e-6;

/// Result of jumps at one time.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Jump {
    /// Work (J) of the impulses at pins.
    pub work: f64,
    /// Largest change of a velocity (m/s).
    pub change: f64,
    /// Whether ropes tightened, or joints reached their ends.
    pub tightened: bool,
}

/// Makes the velocities in the state y at time t (s) fit the constraints and the velocities of
/// pins, by the least impulses, and lets ropes tighten that have to. Returns `None` if they fit.
pub(crate) fn fit(network: &mut Network, t: f64, y: &mut [f64], least: Least) -> Option<Jump> {
    if !network.is_constrained() || y.iter().any(|y| !y.is_finite()) {
        return None;
    }
    let before = network.halves(y).1.to_vec();
    network.hold(t, y);
    loosen_where(network, y, |rate| rate > 0.0);
    let mut all = Jump::default();
    all.add(strike(network, (t, &before), y, &[], least));
    if let Some(tightened) = tighten(network, t, y, least) {
        all.add(tightened);
    }
    (all.change > 0.0).then_some(all)
}

/// Makes the taut ropes slack, and leaves the ends of joints, that part at such a rate (m/s) in the
/// state y.
fn loosen_where(network: &mut Network, y: &[f64], is_loose: impl Fn(f64) -> bool) {
    let rates =
        constraints::rates(&network.constraints, halves(network, y), &|k| turned(network, k, y));
    for (number, _) in rates.into_iter().filter(|(_, rate)| is_loose(*rate)) {
        constraints::set_taut(&mut network.constraints, number, false);
    }
}

/// Makes the taut ropes slack, and leaves the ends of joints, whose ends clearly approach in the
/// state y: faster than `still` (m/s), and than a small share of the fastest velocity.
fn loosen_approaching(network: &mut Network, y: &[f64], still: f64) {
    let none = still.max(MAX_DRIFT * fastest(network, y));
    loosen_where(network, y, |rate| rate < -none);
}

/// Applies the impacts of the ropes that tighten in the state y at time t (s), if there are any.
pub(crate) fn tighten(network: &mut Network, t: f64, y: &mut [f64], least: Least) -> Option<Jump> {
    let mut all: Option<Jump> = None;
    for number in 0..MAX_IMPACTS {
        let may_rebound = least.rebounds && number < MAX_REBOUNDS;
        let turned = |k| turned(network, k, y);
        let state = halves(network, y);
        let mut ropes = beyond(&network.constraints, state, &turned, least.none);
        ropes.retain(|rope| rope.rate > 0.0);
        if ropes.is_empty() {
            break;
        }
        let mut rates = vec![];
        if may_rebound && ropes.iter().any(|rope| rope.restitution > 0.0) {
            rates.resize(y.len(), 0.0);
            network.eval_f(t, y, &mut rates);
        }
        let speeds = ropes.iter().map(|rope| {
            let (number, restitution) = (rope.number, rope.restitution);
            let speed = if may_rebound && restitution > 0.0 {
                let press = parting(network, number, y, &rates);
                let shortest = shortest_rebound(press, [least.height, least.time]);
                rebound_speed(restitution, rope.rate, press, shortest)
            } else {
                0.0
            };
            Struck { number, speed }
        });
        let struck: Vec<_> = speeds.collect();
        let before = network.halves(y).1.to_vec();
        let jump = strike(network, (t, &before), y, &struck, least);
        all.get_or_insert_default().add(jump);
    }
    all
}

impl Jump {
    /// Adds a later jump at the same time.
    fn add(&mut self, later: Self) {
        self.work += later.work;
        self.change = self.change.max(later.change);
        self.tightened |= later.tightened;
    }
}

/// Changes the velocities in the state y, which an impulse alone has given, by what the constraints
/// pass on of it, without ropes and ends of joints.
pub(crate) fn pass_on(network: &Network, y: &mut [f64]) {
    if !has_ropes(network) {
        return project_velocities(network, y);
    }
    let mut lasting = network.constraints.clone();
    constraints::set_all_taut(&mut lasting, &[]);
    let pushed = pushed(network, &mut lasting, y, &[]);
    add(network, &pushed, y);
    network.bodies.settle(y);
}

/// Returns the numbers of the ropes at their lengths and of the joints at an end, and the effects
/// of an impulse of each, in the state y.
pub(crate) fn pulls(network: &Network, y: &[f64]) -> Vec<(usize, Vec<Pushed>)> {
    if !has_ropes(network) {
        return vec![];
    }
    let mut all = network.constraints.clone();
    constraints::hold_at_ends(&mut all, halves(network, y), &|k| turned(network, k, y));
    solving(network, y, |weight, turning, state| constraints::pulls(&all, weight, turning, state))
}

/// Returns whether constraints hold a particle, or the body whose centre it is.
pub(crate) fn is_held(network: &Network, i: usize) -> bool {
    network.constraints.moves(i)
}

/// Applies a jump at time t (s), in which ropes tighten, to the state y. `before` are the
/// velocities (m/s) before it, n x 3.
fn strike(
    network: &mut Network,
    (t, before): (f64, &[f64]),
    y: &mut [f64],
    struck: &[Struck],
    least: Least,
) -> Jump {
    let n = network.particles();
    let speed = fastest(network, y);
    let mut all = std::mem::take(&mut network.constraints);
    let pushed = pushed(network, &mut all, y, struck);
    network.constraints = all;
    let mut jump = Jump { tightened: !struck.is_empty(), ..Jump::default() };
    for pushed in &pushed {
        jump.change = jump.change.max(match pushed.moved {
            Moved::Body(k) => pushed.change.norm() * network.bodies()[k].radius(),
            Moved::Nothing | Moved::Particle(_) => pushed.change.norm(),
        });
    }
    if struck.is_empty() && jump.change <= MAX_DRIFT * speed {
        jump.change = 0.0;
    } else {
        let v = &y[3 * n..6 * n];
        for pushed in &pushed {
            if let Moved::Particle(i) = pushed.moved
                && network.particles.inverse_masses()[i] == 0.0
            {
                jump.work -= 0.5 * pushed.impulse.dot(&(row(before, n, i) + row(v, n, i)));
            }
        }
        add(network, &pushed, y);
        network.hold(t, y);
    }
    // A rope does not push: it lets its ends approach. Where everything comes to rest, rounding
    // errors are small beside the velocities before the impact, but not beside those after it.
    loosen_approaching(network, y, least.still().max(MAX_DRIFT * speed));
    jump
}

/// Returns the largest component of a velocity (m/s) in the state y, of bodies also at their
/// radius.
fn fastest(network: &Network, y: &[f64]) -> f64 {
    let bodies = network.bodies().iter().enumerate();
    let turning = bodies.map(|(k, body)| turned(network, k, y).1.amax() * body.radius());
    let v = network.halves(y).1.iter().map(|v| v.abs());
    v.chain(turning).fold(0.0, f64::max)
}

/// Returns the effects of the impulses of constraints on the velocities in the state y, where these
/// ropes tighten.
fn pushed(network: &Network, all: &mut Constraints, y: &[f64], struck: &[Struck]) -> Vec<Pushed> {
    solving(network, y, |weight, turning, state| {
        constraints::jump(all, struck, weight, turning, state)
    })
}

/// Calls `solve` with the inverse masses (1/kg), the rotations of bodies, and the positions and
/// velocities of the state y.
fn solving<R>(
    network: &Network,
    y: &[f64],
    solve: impl FnOnce(&dyn Fn(usize) -> f64, &dyn Fn(usize) -> Turning, [&[f64]; 2]) -> R,
) -> R {
    let (x, v) = network.halves(y);
    let weight = |i: usize| network.particles.inverse_masses()[i];
    let loads =
        Loads { x, f: &vec![0.0; x.len()], torques: &vec![0.0; 3 * network.bodies().len()] };
    let turning = |k: usize| evaluation::turning(network, k, y, Terms::KickForces, loads).0;
    solve(&weight, &turning, [x, v])
}

/// Adds these effects to the velocities in the state y.
pub(crate) fn add(network: &Network, pushed: &[Pushed], y: &mut [f64]) {
    let n = network.particles();
    for pushed in pushed {
        match pushed.moved {
            Moved::Nothing => {}
            Moved::Particle(i) => {
                let v = &mut y[3 * n..6 * n];
                let changed = row(v, n, i) + pushed.change;
                set_row(v, n, i, changed);
            }
            Moved::Body(k) => {
                let numbers = network.bodies.numbers(k);
                for (y, push) in y[numbers.end - 3..numbers.end].iter_mut().zip(&pushed.impulse) {
                    *y += push;
                }
            }
        }
    }
}

/// Returns the acceleration (m/s2) at which the ends of a slack rope part, or a joint passes its
/// end, with the rates of change of the state y.
fn parting(network: &Network, number: usize, y: &[f64], rates: &[f64]) -> f64 {
    if let Constraint::Stop(_) = network.constraints()[number] {
        let rate_at = |moment: f64| {
            let state: Vec<_> = y.iter().zip(rates).map(|(y, r)| y + moment * r).collect();
            let ends = open_ends(network, &state);
            let own = ends.iter().find(|end| end.number == number);
            own.map_or(0.0, |end| end.rate)
        };
        return (rate_at(HALF_MOMENT) - rate_at(-HALF_MOMENT)) / (2.0 * HALF_MOMENT);
    }
    let (i, j) = network.constraints()[number].ends();
    let (n, j) = (network.particles(), j.unwrap_or(i));
    let between = |a: &[f64]| -> Vector3<f64> { row(a, n, i) - row(a, n, j) };
    let [d, v, a] = [between(y), between(&y[3 * n..]), between(&rates[3 * n..])];
    let along = d / d.norm();
    let across = v - along * along.dot(&v);
    a.dot(&along) + across.norm_squared() / d.norm()
}

/// Returns whether there are ropes.
pub(crate) fn has_ropes(network: &Network) -> bool {
    network.is_constrained() && constraints::has_ropes(&network.constraints)
}

/// Returns the numbers of the constraints that are taut ropes, in order.
pub(crate) fn taut(network: &Network) -> impl Iterator<Item = usize> {
    constraints::taut(&network.constraints)
}

/// Makes these ropes taut, and all others slack.
pub(crate) fn set_taut(network: &mut Network, taut: &[usize]) {
    constraints::set_all_taut(&mut network.constraints, taut);
}

/// Returns the slack ropes, as their ends and lengths (m).
pub(crate) fn slack(network: &Network) -> impl Iterator<Item = ([usize; 2], f64)> {
    let taut: Vec<_> = taut(network).collect();
    let all = network.constraints().iter().enumerate();
    all.filter_map(move |(number, constraint)| match *constraint {
        Constraint::Rope { i, j, length, .. } if taut.binary_search(&number).is_err() => {
            Some(([i, j], length))
        }
        _ => None,
    })
}

/// Returns the other end and the length (m) of each rope attached to particle i.
pub(crate) fn ropes_of(network: &Network, i: usize) -> impl Iterator<Item = (usize, f64)> {
    network.constraints().iter().filter_map(move |c| match *c {
        Constraint::Rope { i: a, j: b, length, .. } if a == i || b == i => {
            Some((a + b - i, length))
        }
        _ => None,
    })
}

/// Decides which ropes are taut in the state y at time t (s): those that pull. Returns the number
/// of evaluations.
pub(crate) fn settle(network: &mut Network, t: f64, y: &[f64], none: f64) -> u64 {
    if !has_ropes(network) {
        return 0;
    }
    let turned = |k| turned(network, k, y);
    for rope in beyond(&network.constraints, halves(network, y), &turned, none) {
        constraints::set_taut(&mut network.constraints, rope.number, true);
    }
    let_go(network, t, y)
}

/// Lets go of the taut ropes, and of the ends of joints, that an impact has left slack in the state
/// y at time t (s). Returns the number of evaluations.
pub(crate) fn slacken(network: &mut Network, t: f64, y: &[f64]) -> u64 {
    if !has_ropes(network) {
        return 0;
    }
    loosen_approaching(network, y, 0.0);
    let_go(network, t, y)
}

/// Lets go of the taut ropes, and of the ends of joints, that do not pull in the state y at time
/// t (s). Returns the number of evaluations.
fn let_go(network: &mut Network, t: f64, y: &[f64]) -> u64 {
    let mut all = std::mem::take(&mut network.constraints);
    let turned = |k| turned(network, k, y);
    constraints::loosen(&mut all, halves(network, y)[0], &turned);
    network.constraints = all;
    let mut evaluated = 0;
    while taut(network).next().is_some() {
        evaluated += 1;
        match least_tension(network, t, y) {
            Some((number, tension)) if tension < 0.0 => {
                constraints::set_taut(&mut network.constraints, number, false);
            }
            _ => break,
        }
    }
    evaluated
}

/// Returns the taut rope with the least tension in the state y at time t (s), and a number of the
/// sign of that tension.
pub(crate) fn least_tension(network: &Network, t: f64, y: &[f64]) -> Option<(usize, f64)> {
    constraints::least(tensions(network, t, y))
}

/// Lists the tensions of taut ropes and of held ends of joints in the state y at time t (s), each
/// with the number of the constraint. A tension times a duration (s) is an impulse, in multiples of
/// the one whose effects [`pulls`] returns.
pub(crate) fn tensions(network: &Network, t: f64, y: &[f64]) -> Vec<(usize, f64)> {
    if taut(network).next().is_none() { vec![] } else { rigid::tensions(network, t, y) }
}

/// Returns the ends of joints that are not held in the state y.
pub(crate) fn open_ends(network: &Network, y: &[f64]) -> Vec<OneSided> {
    let turned = |k| turned(network, k, y);
    constraints::open_ends(&network.constraints, halves(network, y), &turned).collect()
}

/// Returns the rotation matrix and the angular velocity (rad/s) of body k in the state y.
pub(super) fn turned(network: &Network, k: usize, y: &[f64]) -> (Matrix3<f64>, Vector3<f64>) {
    let moving = network.bodies()[k].moving(&network.rotation(k, y));
    (moving.rotation, moving.spin)
}

/// Returns the positions and velocities in the state y.
pub(super) fn halves<'a>(network: &Network, y: &'a [f64]) -> [&'a [f64]; 2] {
    network.halves(y).into()
}
