//! Outflow of the fluid of a network. Particles that have left the fluid are pinned where they are,
//! and act on nothing.

use super::parts::Network;
use crate::columns::row;
use crate::elements::{Fluid, Outflow};
use crate::path::Path;
use crate::system::Mechanics;

/// Returns the boxes in which particles leave the fluid.
pub(crate) fn outflows(network: &Network) -> &[Outflow] {
    network.fluid().map_or(&[], |fluid| fluid.members().outflows())
}

/// Returns the particles that have left the fluid, in order.
pub(crate) fn drained(network: &Network) -> &[u32] {
    network.fluid().map_or(&[], |fluid| fluid.members().drained())
}

/// Returns whether particle i has left the fluid.
pub(super) fn is_drained(network: &Network, i: usize) -> bool {
    network.fluid().is_some_and(|fluid| fluid.members().has_left(i))
}

/// Lists the free particles of the fluid that are in an outflow in the state y, or less than
/// `slack` (m) outside.
pub(crate) fn entered<'a>(
    network: &'a Network,
    y: &'a [f64],
    slack: f64,
) -> impl Iterator<Item = u32> + 'a {
    let outflows = outflows(network);
    let fluid = network.fluid().filter(|_| !outflows.is_empty());
    let all = fluid.map_or(&[][..], Fluid::particles).iter().copied();
    let n = network.particles();
    let is_inside = move |i: usize| {
        let place = row(y, n, i);
        outflows.iter().any(|outflow| outflow.contains(&place, slack))
    };
    all.filter(move |i| network.inverse_masses()[*i as usize] > 0.0 && is_inside(*i as usize))
}

/// Lets particles leave the fluid too, pinned where they are in the state y.
pub(super) fn leave(network: &mut Network, y: &mut [f64], particles: &[u32]) {
    let n = network.particles();
    for i in particles.iter().map(|i| *i as usize) {
        network.particles.pin(i, Path::Still(row(y, n, i)));
        for axis in 3..6 {
            y[axis * n + i] = 0.0;
        }
    }
    let mut all = [drained(network), particles].concat();
    all.sort_unstable();
    set_drained(network, &all);
}

/// Sets which particles have left the fluid: these, given in order. All others flow.
pub(crate) fn set_drained(network: &mut Network, particles: &[u32]) {
    if drained(network) == particles {
        return;
    }
    if let Some(fluid) = network.elements.first_mut::<Fluid>() {
        fluid.set_drained(particles);
    }
    if network.touch().is_some_and(|touch| !touch.drops.is_empty()) {
        network.renew_contact();
    }
}

/// Sets which particles have left the fluid: these, given in order. They are pinned where they are
/// in the state y, and all others that had left are free again. Returns whether any changes.
pub(crate) fn go_back(network: &mut Network, y: &[f64], particles: &[u32]) -> bool {
    let before = drained(network).to_vec();
    set_drained(network, particles);
    let is_new = |i: &&u32| before.binary_search(i).is_err();
    for i in particles.iter().filter(is_new).map(|i| *i as usize) {
        network.particles.pin(i, Path::Still(row(y, network.particles(), i)));
    }
    for i in before.iter().filter(|i| particles.binary_search(i).is_err()) {
        network.particles.unpin(*i as usize);
    }
    before != particles
}
