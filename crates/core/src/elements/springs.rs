//! Single springs. Few are evaluated one by one, and many in vectors (see `packed`).

use std::sync::OnceLock;

use super::axial::{add_all, add_differential, coupling, energy};
use super::diagonal::add_springs;
use super::force::{At, Cost, Force, Matter, check_ends, ends};
use super::packed::{Packed, SPEED};
use crate::coupling::{Coupling, Diagonal, Matrix};
use crate::energy::Energy;
use crate::error::Error;
use crate::spring::Spring;

/// Single springs, in any order.
#[derive(Debug, Default)]
pub struct Springs {
    all: Vec<Spring>,
    /// Packed copy of the springs, built on first use if there are many.
    packed: OnceLock<Option<Packed>>,
}

impl Springs {
    /// Creates springs in the order given.
    #[must_use]
    pub fn new(all: Vec<Spring>) -> Self {
        Self {
            all,
            packed: OnceLock::new(),
        }
    }

    /// Returns all springs, in their order.
    #[must_use]
    pub fn all(&self) -> &[Spring] {
        &self.all
    }

    /// Adds a spring at the end.
    pub(crate) fn push(&mut self, spring: Spring) {
        self.change().push(spring);
    }

    /// Sorts the springs by their ends, so that neighbours in memory are used one after another.
    pub(crate) fn sort(&mut self) {
        self.change().sort_by_key(ends);
    }

    /// Returns the springs, to be changed, and drops their packed copy.
    fn change(&mut self) -> &mut Vec<Spring> {
        self.packed = OnceLock::new();
        &mut self.all
    }

    /// Returns the packed copy, if there are many springs.
    pub(crate) fn packed(&self) -> Option<&Packed> {
        self.packed.get_or_init(|| Packed::new(&self.all)).as_ref()
    }
}

impl Clone for Springs {
    fn clone(&self) -> Self {
        Self::new(self.all.clone())
    }
}

impl PartialEq for Springs {
    fn eq(&self, other: &Self) -> bool {
        self.all == other.all
    }
}

impl Force for Springs {
    fn name(&self) -> &'static str {
        "springs"
    }

    fn matter(&self) -> Option<Matter> {
        Some(Matter::Springs)
    }

    fn check(&self, particles: usize) -> Result<(), Error> {
        self.all
            .iter()
            .try_for_each(|spring| check_ends([spring.i, spring.j], particles))
    }

    fn add_forces(&self, at: &At, f: &mut [f64]) {
        match self.packed() {
            Some(packed) => packed.add_forces(at, f),
            None => add_all(&self.all, at.x, at.v, f),
        }
    }

    fn add_differential(&self, at: &At, d: [&[f64]; 2], df: &mut [f64]) {
        if let Some(packed) = self.packed() {
            packed.add_differential(at, d, df);
            return;
        }
        for spring in &self.all {
            add_differential(spring, at, d, df);
        }
    }

    fn couplings(&self, _t: f64, x: &[f64], clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        for spring in &self.all {
            visit(coupling(spring, x, clamped));
        }
    }

    fn multiplies_together(&self) -> bool {
        self.packed().is_some()
    }

    fn add_diagonal(&self, matrix: &Matrix, diagonal: &mut Diagonal) -> usize {
        self.packed().map_or(0, |packed| {
            add_springs(&self.all, matrix, diagonal);
            packed.len()
        })
    }

    fn energy(&self, at: &At) -> Energy {
        energy(self.all.iter().copied(), at.x)
    }

    fn reads_velocity(&self) -> bool {
        self.all.iter().any(|spring| spring.law.damping > 0.0)
    }

    fn cost(&self) -> Cost {
        let springs = self.all.len() as f64;
        let speed = if self.packed().is_some() { SPEED } else { 1.0 };
        Cost {
            couplings: springs,
            price: springs / speed,
        }
    }

    fn scale(&mut self, stiffness: f64, damping: f64) {
        for spring in self.change() {
            spring.law.scale(stiffness, damping);
        }
    }

    fn remove_springs(&mut self, torn: &[[usize; 2]]) {
        self.change()
            .retain(|spring| torn.binary_search(&ends(spring)).is_err());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Triangles;
    use crate::random::SplitMix;
    use crate::spring::{SpringKind, SpringLaw};

    #[test]
    fn what_is_packed_follows_every_change() {
        let mut random = SplitMix(3);
        let mut numbers =
            |count: usize| -> Vec<f64> { (0..count).map(|_| random.between(-1.0, 1.0)).collect() };
        let (x, v) = (numbers(150), numbers(150));
        let spring = |k: usize| Spring {
            i: k % 50,
            j: (k + 1 + k / 50) % 50,
            kind: SpringKind::Structural,
            law: SpringLaw::new(1.0 + k as f64, 0.5, 0.1).unwrap(),
        };
        let mut element = Springs::new((0..2000).map(spring).filter(|s| s.i != s.j).collect());
        let check = |element: &Springs| {
            assert!(element.packed().is_some());
            let at = At {
                t: 0.0,
                x: &x,
                v: &v,
                masses: &[],
                triangles: &Triangles::default(),
            };
            let [mut found, mut expected] = [vec![0.0; 150], vec![0.0; 150]];
            element.add_forces(&at, &mut found);
            add_all(&element.all, &x, &v, &mut expected);
            let size = expected.iter().fold(0.0_f64, |most, f| most.max(f.abs()));
            for (found, expected) in found.iter().zip(&expected) {
                assert!(
                    (found - expected).abs() < 1e-13 * size,
                    "{found} {expected}"
                );
            }
        };
        check(&element);
        element.scale(2.0, 3.0);
        check(&element);
        let torn = ends(&element.all()[3]);
        element.remove_springs(&[torn]);
        check(&element);
        element.push(spring(7));
        check(&element);
    }
}
