//! The matrix of an implicit step, as far as it is known without its couplings one by one: those of
//! springs in sheets, and of single ones if there are many.

use super::element::Element;
use super::elements::Elements;
use crate::coupling::{Coupling, Diagonal, Matrix};
use crate::elements::sheet::{Quantity, set};
use crate::elements::{Finish, Sheet, Springs};
use crate::system::divide_by_masses;

/// Writes the product of the known part of the matrix and p to out. Returns the number of springs
/// in it; 0 if out was left as it is.
pub(super) fn multiply(elements: &Elements, matrix: &Matrix, p: &[f64], out: &mut [f64]) -> usize {
    let in_sheets: usize = elements.sheets().map(Sheet::len).sum();
    let packed = elements.of::<Springs>().find_map(Springs::packed);
    if in_sheets == 0 && packed.is_none() {
        return 0;
    }
    let clamped = matrix.clamped;
    let finish = Finish {
        inertia: Some(matrix.masses),
        inverse_masses: Some(matrix.free),
        ..Finish::default()
    };
    elements.clear_single(out);
    for sheet in elements.sheets() {
        let quantity = Quantity::Tangent { clamped };
        let sheet = sheet.scaled(matrix.stiffness, matrix.damping);
        set(quantity, &sheet, &[matrix.x, p], out, false, &finish);
    }
    elements.finish_single(p, out, &finish);
    let Some(packed) = packed else {
        return in_sheets;
    };
    packed.add_product(matrix, p, out);
    // Nothing is left on pinned particles.
    divide_by_masses(matrix.free, out);
    in_sheets + packed.len()
}

/// Adds the diagonal of the known part of the matrix. Returns the number of springs in it.
pub(super) fn add_diagonal(elements: &Elements, matrix: &Matrix, diagonal: &mut Diagonal) -> usize {
    let all = elements.all().iter();
    all.map(|element| element.force().add_diagonal(matrix, diagonal))
        .sum()
}

/// Visits the couplings of the rest of the matrix.
pub(super) fn other_couplings(
    elements: &Elements,
    t: f64,
    x: &[f64],
    clamped: bool,
    visit: &mut dyn FnMut(Coupling),
) {
    let all = elements.all().iter().map(Element::force);
    for force in all.filter(|force| !force.multiplies_together()) {
        force.couplings(t, x, clamped, visit);
    }
}
