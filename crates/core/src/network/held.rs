//! The constraints of a network as implicit methods see them.

use super::evaluation::other_forces;
use super::holding::free_motion;
use super::parts::Network;
use crate::constraints;
use crate::held::{Held, Joint};
use crate::system::Mechanics;

impl Held for Network {
    fn free_forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        other_forces(self, t, x, v, f);
    }

    fn joints(&self, x: &[f64], out: &mut Vec<Joint>) {
        constraints::joints(&self.constraints, x, out);
    }

    fn multipliers(&self, t: f64, state: [&[f64]; 2], f: &[f64], out: &mut [f64]) {
        let none = |_, _: &[f64]| unreachable!("there are no bodies");
        let motion = |i: usize, f: &[f64]| free_motion(self, t, &none, i, f);
        constraints::multipliers(&self.constraints, motion, state, f, out);
    }

    fn project(&self, x: &mut [f64], v: &mut [f64]) {
        constraints::project(&self.constraints, self.inverse_masses(), x, v);
    }
}
