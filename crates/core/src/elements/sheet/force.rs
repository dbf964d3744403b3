//! The springs of a sheet as a force.

use super::super::axial;
use super::super::finish::Finish;
use super::super::force::{At, Cost, Force, Matter, check_particle};
use super::super::springs::add_runs;
use super::model::Sheet;
use super::offsets::OFFSETS;
use super::strips::{Quantity, set};
use crate::coupling::{Coupling, Diagonal, Matrix};
use crate::energy::Energy;
use crate::error::Error;
use crate::spring::Spring;

/// Time of the same springs one by one, over that of the kernel, on grids of usual sizes.
const SPEED: f64 = 3.0;

impl Force for Sheet {
    fn name(&self) -> &'static str {
        "springs"
    }

    fn matter(&self) -> Option<Matter> {
        Some(Matter::Springs)
    }

    fn check(&self, particles: usize) -> Result<(), Error> {
        check_particle(self.particles().end - 1, particles)
    }

    fn add_forces(&self, at: &At, f: &mut [f64]) {
        let finish = Finish::default();
        set(Quantity::Forces, self, &[at.x, at.v], f, true, &finish);
    }

    fn add_differential(&self, at: &At, [dx, dv]: [&[f64]; 2], df: &mut [f64]) {
        let is_zero = |a: &[f64]| a.iter().all(|a| *a == 0.0);
        let finish = Finish::default();
        if self.is_damped() && !(is_zero(at.v) && is_zero(dv)) {
            let fields = [at.x, at.v, dx, dv];
            set(Quantity::Differential, self, &fields, df, true, &finish);
        } else {
            let (quantity, sheet) = (Quantity::Tangent { clamped: false }, self.scaled(1.0, 0.0));
            set(quantity, &sheet, &[at.x, dx], df, true, &finish);
        }
    }

    fn couplings(&self, _t: f64, x: &[f64], clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        for (direction, begins, further) in self.runs() {
            let (kind, law) = (OFFSETS[direction].0, self.laws()[direction]);
            for i in begins {
                let j = i + further;
                visit(axial::coupling(&Spring { kind, i, j, law }, x, clamped));
            }
        }
    }

    fn multiplies_together(&self) -> bool {
        !self.is_empty()
    }

    fn add_diagonal(&self, matrix: &Matrix, diagonal: &mut Diagonal) -> usize {
        let runs = self.runs();
        let with_laws = runs.map(|(direction, begins, further)| {
            let law = self.laws()[direction];
            (law, begins, further)
        });
        add_runs(with_laws, matrix, diagonal);
        self.len()
    }

    fn energy(&self, at: &At) -> Energy {
        axial::energy(self.springs(), at.x)
    }

    fn reads_velocity(&self) -> bool {
        self.is_damped()
    }

    fn cost(&self) -> Cost {
        let couplings = self.len() as f64;
        Cost { couplings, price: couplings / SPEED }
    }

    fn scale(&mut self, stiffness: f64, damping: f64) {
        Sheet::scale(self, stiffness, damping);
    }

    fn remove_springs(&mut self, torn: &[[usize; 2]]) {
        self.remove(torn);
    }
}
