//! Pins of a network that let go. Which pins hold is a function of time alone.

use super::evaluation::prescribed;
use super::parts::Network;

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
