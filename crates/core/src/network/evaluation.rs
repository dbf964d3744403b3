//! Parts that evaluations of a network share: its forces, with gravity and drag in them or in
//! drifts, and prescribed motion.

use std::ops::Range;

use nalgebra::Vector3;

use super::parts::Network;
use super::surfaces::Prescribed;
use crate::elements::force::{At, DriftForces};
use crate::elements::{Finish, Flow, flow_each};
use crate::rows::Terms;

/// Returns the arguments of the elements of a network.
pub(super) fn at<'a>(network: &'a Network, t: f64, x: &'a [f64], v: &'a [f64]) -> At<'a> {
    At {
        t,
        x,
        v,
        masses: network.particles.masses(),
        triangles: &network.surfaces.triangles,
    }
}

/// Writes all forces except those of constraints to f.
pub(super) fn other_forces(network: &Network, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
    let finish = finish(network, Terms::AllForces);
    network.elements.evaluate(&at(network, t, x, v), f, &finish);
}

/// Returns whether drifts apply gravity and drag, and kicks the other forces: not with constraints,
/// which hold against all forces together, nor with a particle whose inertia is not its mass.
pub(super) fn is_split(network: &Network, terms: Terms) -> bool {
    let together = !network.constraints.all().is_empty() || network.particles.is_burdened();
    terms == Terms::KickForces && !together
}

/// Returns gravity and drag where drifts apply them; otherwise nothing.
pub(super) fn drift_forces(network: &Network, terms: Terms) -> DriftForces {
    if is_split(network, terms) {
        network.elements.drift_forces()
    } else {
        DriftForces::default()
    }
}

/// Returns gravity and drag where no drift applies them, to be added last; otherwise nothing.
pub(super) fn finish(network: &Network, terms: Terms) -> Finish<'_> {
    if is_split(network, terms) {
        return Finish::default();
    }
    let DriftForces { gravity, drag } = network.elements.drift_forces();
    let masses = network.particles.masses();
    Finish {
        gravity: (gravity != Vector3::zeros()).then_some((gravity, masses)),
        drag: (drag > 0.0).then_some(drag),
        ..Finish::default()
    }
}

/// Moves particles by a drift. Pins are put in their places afterwards.
pub(super) fn flow(
    network: &Network,
    terms: Terms,
    h: f64,
    particles: Range<usize>,
    x: [&mut [f64]; 3],
    v: [&mut [f64]; 3],
) {
    let DriftForces { drag, gravity } = drift_forces(network, terms);
    if let Some(w) = network.particles.uniform_inverse_mass() {
        Flow::new(drag, gravity, w, h).apply(x, v);
    } else {
        let inverse_masses = &network.particles.inverse_masses()[particles];
        flow_each(drag, gravity, inverse_masses, h, x, v);
    }
}

/// Returns the motion that the scene prescribes.
pub(super) fn prescribed(network: &Network) -> Prescribed<'_> {
    Prescribed {
        particles: &network.particles,
        obstacles: network.surfaces.obstacles(),
        wind: network.elements.wind(),
    }
}
