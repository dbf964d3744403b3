//! What evaluations of a network share: its forces, gravity and drag in them or in drifts, and the
//! motion that is prescribed.

use std::ops::Range;

use nalgebra::Vector3;

use super::parts::Network;
use super::surfaces::Prescribed;
use crate::elements::force::{At, Carried};
use crate::elements::{Finish, Flow, flow_each};
use crate::rows::Terms;

/// The arguments of elements.
pub(super) fn at<'a>(network: &'a Network, t: f64, x: &'a [f64], v: &'a [f64]) -> At<'a> {
    At {
        t,
        x,
        v,
        masses: network.particles.masses(),
        triangles: &network.surfaces.triangles,
    }
}

/// Writes all forces but those of constraints to f.
pub(super) fn other_forces(network: &Network, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
    let finish = finish(network, Terms::AllForces);
    network.elements.evaluate(&at(network, t, x, v), f, &finish);
}

/// Whether drifts carry gravity and drag: not with constraints, which hold against all forces
/// together.
pub(super) fn drifts_carry(network: &Network, terms: Terms) -> bool {
    terms == Terms::KickForces && network.constraints.all().is_empty()
}

/// The gravity and drag that a drift carries.
pub(super) fn drifting(network: &Network, terms: Terms) -> Carried {
    if drifts_carry(network, terms) {
        network.elements.carried()
    } else {
        Carried::default()
    }
}

/// The gravity and drag that no drift carries.
pub(super) fn finish(network: &Network, terms: Terms) -> Finish<'_> {
    if drifts_carry(network, terms) {
        return Finish::default();
    }
    let Carried { gravity, drag } = network.elements.carried();
    let masses = network.particles.masses();
    Finish {
        gravity: (gravity != Vector3::zeros()).then_some((gravity, masses)),
        drag: (drag > 0.0).then_some(drag),
        ..Finish::default()
    }
}

/// Moves particles by what a drift carries. Pins are put in their places afterwards.
pub(super) fn flow(
    network: &Network,
    terms: Terms,
    h: f64,
    particles: Range<usize>,
    x: [&mut [f64]; 3],
    v: [&mut [f64]; 3],
) {
    let Carried { drag, gravity } = drifting(network, terms);
    if let Some(w) = network.particles.uniform_inverse_mass() {
        Flow::new(drag, gravity, w, h).apply(x, v);
    } else {
        let inverse_masses = &network.particles.inverse_masses()[particles];
        flow_each(drag, gravity, inverse_masses, h, x, v);
    }
}

/// Motion that the scene prescribes.
pub(super) fn prescribed(network: &Network) -> Prescribed<'_> {
    Prescribed {
        particles: &network.particles,
        obstacles: network.surfaces.obstacles(),
        wind: network.elements.wind(),
    }
}
