//! What a network's forces and couplings cost, for those who choose between ways to solve.

use super::Network;
use crate::elements::force::{Force, GATHERING};

impl Network {
    /// Sum over the elements of a number of each.
    fn sum_of(&self, number: impl Fn(&dyn Force) -> f64) -> f64 {
        let each = self.elements.iter().map(|element| number(element.force()));
        each.sum()
    }

    /// Time that the forces would take coupling by coupling over the time that they take.
    pub(super) fn speed_of_forces(&self) -> f64 {
        let couplings = self.sum_of(|force| force.cost().couplings);
        if couplings > 0.0 {
            couplings / self.sum_of(|force| force.cost().price)
        } else {
            1.0
        }
    }

    /// Price of gathering the couplings, in evaluations of the forces.
    pub(super) fn price_of_gathering(&self) -> f64 {
        let price = self.sum_of(|force| force.cost().price);
        if price > 0.0 {
            self.sum_of(|force| force.gathering()) / price
        } else {
            GATHERING
        }
    }
}
