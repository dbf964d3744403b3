//! Impacts of bodies that joints hold: what joints make of impulses, and the energy of such a step.

use std::cell::Cell;

use crate::constraints::{Constraint, Joint};
use crate::contact::{Bodies, Joints};
use crate::network::{Network, has_joints, project_velocities};
use crate::rigid::{ROTATION, rotation_vector};
use crate::system::Mechanics;

/// Largest share by which jumps of velocities are changed.
const MAX_SHARE: f64 = 0.05;

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

    /// Returns what impulses of contact act on.
    pub fn bodies(&self) -> Bodies<'_> {
        Bodies {
            inverse_masses: self.network.inverse_masses(),
            joints: has_joints(self.network).then_some(self),
        }
    }

    /// Gives y, the end of a step of h (s) from time t (s), the energy of the step without
    /// impacts and of the work of their impulses, if these were all impulses of contact (N s):
    /// `ends` are the states at both ends without impacts. The forces of the rest of the step are
    /// those on the course without impacts, from which joints turn the bodies. The jump of the
    /// velocities is made a little larger or smaller.
    pub fn balance(&self, (t, h): (f64, f64), all: f64, ends: [&[f64]; 2], y: &mut [f64]) {
        let (t, [impulse, work]) = (t + h, self.noted.get());
        if impulse == 0.0 || impulse < (1.0 - 1e-12) * all {
            return;
        }
        let (first, unstruck) = (3 * self.network.particles(), ends[1]);
        let after = y.to_vec();
        let lags = self.lags(h, ends);
        let mut energy = |share: f64, lag: f64| {
            for k in first..y.len() {
                y[k] = after[k] + lags[k] * lag;
                let of_rotation = k.checked_sub(2 * first).map(|number| number % ROTATION);
                if of_rotation.is_none_or(|number| number >= 4) {
                    y[k] += (after[k] - unstruck[k]) * share;
                }
            }
            self.network.energy_of(t, y).total()
        };
        let [less, same, more] = [-1.0, 0.0, 1.0].map(|share| energy(share, 1.0));
        // The energy is quadratic in the share.
        let (slope, bend) = (0.5 * (more - less), 0.5 * (more + less) - same);
        let begun: Vec<_> = unstruck.iter().zip(&lags).map(|(y, lag)| y + lag).collect();
        let lacks = self.network.energy_of(t, &begun).total() + work - same;
        let root = (slope * slope + 4.0 * bend * lacks).sqrt();
        let share = 2.0 * lacks / (slope + root);
        energy(if share.abs() < MAX_SHARE { share } else { 0.0 }, 0.0);
        project_velocities(self.network, y);
    }

    /// Returns how far the velocities and the angular momenta at the end of a step of h (s) are
    /// behind those of its parabola, whose velocities change evenly: much with methods of order 1.
    fn lags(&self, h: f64, ends: [&[f64]; 2]) -> Vec<f64> {
        let (network, [y0, y1]) = (self.network, ends);
        let first = 3 * network.particles();
        let mut lags = vec![0.0; y1.len()];
        for (k, lag) in lags[first..2 * first].iter_mut().enumerate() {
            *lag = (y1[k] - y0[k]) / h - 0.5 * (y0[first + k] + y1[first + k]);
        }
        for (k, body) in network.bodies().iter().enumerate() {
            let both = ends.map(|y| network.rotation(k, y));
            let [begun, ended] = both.map(|rotation| body.moving(&rotation).spin);
            let way = rotation_vector(both[1].q, both[0].q);
            let lag = body.momentum(both[1].q, way / h - (begun + ended) * 0.5);
            let momentum = 2 * first + ROTATION * k + 4;
            lags[momentum..momentum + 3].copy_from_slice(lag.as_slice());
        }
        lags
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
