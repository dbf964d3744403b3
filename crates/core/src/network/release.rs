//! Pins of a network that let go. Which pins hold is a function of time alone.

use super::evaluation::prescribed;
use super::parts::Network;
use crate::contact::Obstacle;

/// Lets the pins hold that hold at time t (s), and lets go of all others. Returns whether that
/// changes any.
pub(crate) fn pass_to(network: &mut Network, t: f64) -> bool {
    let changes = network.particles.pass_to(t);
    if changes {
        network.strain_limits.forget();
    }
    changes
}

/// Returns the time (s) at which particle i is let go, if a pin holds it until a time.
pub(crate) fn release_of(network: &Network, i: usize) -> Option<f64> {
    network.particles.pins_of(i..i + 1).first()?.until
}

/// Returns the first time (s) at which a pin lets go; infinite if none does.
pub(crate) fn next_release(network: &Network) -> f64 {
    network.particles.next_release()
}

/// Returns the first time after t (s) at which the velocity of a pin that constraints hold may
/// jump; infinite if there is none.
fn next_jump(network: &Network, t: f64) -> f64 {
    if !network.is_constrained() {
        return f64::INFINITY;
    }
    let pins = network.particles.pins().iter();
    let held = pins.filter(|pin| network.constraints.moves(pin.particle));
    let times = held.flat_map(|pin| pin.path.known_times());
    times.filter(|time| *time > t).fold(f64::INFINITY, f64::min)
}

/// Returns a time within `none` (s) of t (s) at which the velocity of a pin that constraints hold
/// may jump, if there is one.
pub(crate) fn jump_near(network: &Network, t: f64, none: f64) -> Option<f64> {
    let jump = next_jump(network, (t - none).next_down());
    (jump <= t + none).then_some(jump)
}

/// Returns the first time (s) past which no step of any method goes that begins at t (s): where a
/// pin lets go or, after more than `none` (s), the velocity of one jumps that constraints hold, or
/// that of an obstacle with restitution. Infinite if there is none.
pub(crate) fn next_break(network: &Network, t: f64, none: f64) -> f64 {
    let jump = next_jump(network, t + none).min(next_blow(network, t + none));
    next_release(network).min(jump)
}

/// Returns the first time after t (s) at which an obstacle with restitution begins or ends to move,
/// and may strike what lies on it; infinite if there is none.
fn next_blow(network: &Network, t: f64) -> f64 {
    let elastic = network.solids().iter().filter(|it| it.restitution > 0.0);
    let times = elastic.flat_map(Obstacle::known_times);
    times.filter(|time| *time > t).fold(f64::INFINITY, f64::min)
}

/// Returns whether a step between two times (s) would go past such a time, or end within `none` (s)
/// of a jump.
pub(crate) fn breaks_between(network: &Network, [t, end]: [f64; 2], none: f64) -> bool {
    let jump = next_jump(network, t + none).min(next_blow(network, t + none));
    next_release(network) < end || jump <= end + none
}

/// Forgets the pins that have let go: none of them holds again at an earlier time.
pub(crate) fn forget_released(network: &mut Network) {
    network.particles.forget_released();
}

/// Returns the first time after t (s) at which a path or a turn begins or ends, or a pin lets go;
/// infinite if there is none.
pub(crate) fn next_known_time(network: &Network, t: f64) -> f64 {
    prescribed(network).next_known_time(t)
}

/// Returns the longest step (s) that resolves the prescribed motion and the wind from time t (s) to
/// `end` (s): a quarter of the shortest period.
pub(crate) fn quarter_period(network: &Network, t: f64, end: f64) -> f64 {
    prescribed(network).quarter_period(t, end)
}
