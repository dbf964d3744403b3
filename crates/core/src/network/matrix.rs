//! The matrix of an implicit step, as far as it is known without its couplings one by one: those of
//! springs in sheets, and of single ones if there are many.

use super::Network;
use crate::coupling::{Coupling, Diagonal, Matrix};
use crate::elements::sheet::{Quantity, set};
use crate::elements::{Element, Finish, Sheet};
use crate::system::divide_by_masses;

impl Network {
    /// Implements [`multiply`](crate::Linearized::multiply).
    pub(super) fn multiply_fast(&self, matrix: &Matrix, p: &[f64], out: &mut [f64]) -> usize {
        let in_sheets: usize = self.sheets().map(Sheet::len).sum();
        let packed = self.elements.iter().find_map(Element::packed);
        if in_sheets == 0 && packed.is_none() {
            return 0;
        }
        let clamped = matrix.clamped;
        let finish = Finish {
            inertia: Some(matrix.masses),
            inverse_masses: Some(matrix.free),
            ..Finish::default()
        };
        self.clear_single(out);
        for sheet in self.sheets() {
            let quantity = Quantity::Tangent { clamped };
            let sheet = sheet.scaled(matrix.stiffness, matrix.damping);
            set(quantity, &sheet, &[matrix.x, p], out, false, &finish);
        }
        self.finish_single(p, out, &finish);
        let Some(packed) = packed else {
            return in_sheets;
        };
        packed.add_product(matrix, p, out);
        // Nothing is left on pinned particles.
        divide_by_masses(matrix.free, out);
        in_sheets + packed.len()
    }

    /// Implements [`add_diagonal`](crate::Linearized::add_diagonal).
    pub(super) fn add_fast_diagonal(&self, matrix: &Matrix, diagonal: &mut Diagonal) -> usize {
        let elements = self.elements.iter();
        elements
            .map(|element| element.force().add_diagonal(matrix, diagonal))
            .sum()
    }

    /// Implements [`other_couplings`](crate::Linearized::other_couplings).
    pub(super) fn slow_couplings(
        &self,
        t: f64,
        x: &[f64],
        clamped: bool,
        visit: &mut dyn FnMut(Coupling),
    ) {
        let is_fast = |element: &&Element| element.sheet().is_some() || element.packed().is_some();
        for element in self.elements.iter().filter(|element| !is_fast(element)) {
            element.force().couplings(t, x, clamped, visit);
        }
    }
}
