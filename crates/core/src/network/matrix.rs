//! The product with the matrix of an implicit step.

use super::Network;
use crate::elements::sheet::{Quantity, set};
use crate::elements::{Element, Finish, Sheet};
use crate::system::{Matrix, divide_by_masses};

impl Network {
    /// Implements [`multiply`](crate::Linearized::multiply) for springs of sheets, and for single
    /// ones if there are many.
    pub(super) fn multiply_fast(&self, matrix: &Matrix, p: &[f64], out: &mut [f64]) -> usize {
        let in_sheets: usize = self.sheets().map(Sheet::len).sum();
        let packed = self.elements.iter().find_map(Element::packed);
        if in_sheets == 0 && packed.is_none() {
            return 0;
        }
        let (a, clamped) = (matrix.a, matrix.clamped);
        let finish = Finish {
            inertia: Some(matrix.masses),
            inverse_masses: Some(matrix.free),
            ..Finish::default()
        };
        self.clear_single(out);
        for sheet in self.sheets() {
            let quantity = Quantity::Tangent { clamped };
            let sheet = sheet.scaled(a * a, a);
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
}
