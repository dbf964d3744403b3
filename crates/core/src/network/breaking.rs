//! How springs of a network break.

use super::parts::Network;

/// Breaks the springs between pairs of particles, given with the lower number first. Returns the
/// number of new pairs.
pub(super) fn break_between(
    network: &mut Network,
    pairs: impl IntoIterator<Item = [usize; 2]>,
) -> usize {
    let new = network.tears.add(pairs);
    remove_torn(network);
    network.surfaces.leave_out_holes(&network.tears);
    network.renew_contact();
    new
}

/// Removes the springs between particles where one has broken.
pub(super) fn remove_torn(network: &mut Network) {
    let torn = network.tears.torn();
    if !torn.is_empty() {
        network.strain_limits.forget();
        network.elements.remove_springs(torn);
    }
}
