//! Impacts of bodies that joints hold: what joints make of impulses, and the energy of such a step.

use std::cell::Cell;

use crate::constraints::{Constraint, Joint};
use crate::contact::{Bodies, Joints};
use crate::network::{Network, has_joints, project_velocities};
use crate::rigid::ROTATION;
use crate::system::Mechanics;

/// Largest share by which jumps of velocities are changed.
const MAX_SHARE: f64 = 0.05;

/// Share of a sum of impulses that is a rounding error.
const ROUNDING: f64 = 1e-12;

/// Joints of the rigid bodies of a network.
pub(super) struct JointsOf<'a> {
    network: &'a Network,
    /// Sum of the magnitudes of the impulses that they have passed on (N s), and their work (J).
    noted: Cell<[f64; 2]>,
}

impl<'a> JointsOf<'a> {
    pub fn new(network: &'a Network) -> Self {
        Self {
            network,
            noted: Cell::default(),
        }
    }

    pub fn network(&self) -> &'a Network {
        self.network
    }

    /// Returns what impulses of contact act on, in a step that has impulses in it already or not.
    pub fn bodies(&self, are_struck: bool) -> Bodies<'_> {
        Bodies {
            inverse_masses: self.network.inverse_masses(),
            joints: has_joints(self.network).then_some(self),
            are_struck,
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
    fn hold(&self, center: usize) -> bool {
        joints(self.network).any(|joint| joint.first == center || joint.second == Some(center))
    }

    fn fit(&self, y: &mut [f64]) {
        project_velocities(self.network, y);
    }

    fn note(&self, impulse: f64, work: f64) {
        let [impulses, works] = self.noted.get();
        self.noted.set([impulses + impulse, works + work]);
    }
}

/// Returns the joints of a network.
fn joints(network: &Network) -> impl Iterator<Item = &Joint> {
    let all = network.constraints().iter();
    all.filter_map(|constraint| match constraint {
        Constraint::Joint(joint) => Some(joint),
        _ => None,
    })
}
