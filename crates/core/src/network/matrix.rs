//! The part of an implicit step's matrix whose couplings are multiplied together: that of springs
//! in sheets, and of single springs if there are many.

use super::element::Element;
use super::elements::Elements;
use crate::coupling::{Coupling, Diagonal, Matrix};
use crate::elements::sheet::{Quantity, set};
use crate::elements::{Finish, Sheet, Springs};
use crate::system::divide_by_masses;

/// Writes the product of the matrix of these springs with p to out. Returns their number.
pub(super) fn multiply(elements: &Elements, matrix: &Matrix, p: &[f64], out: &mut [f64]) -> usize {
    let in_sheets: usize = elements.sheets().map(Sheet::len).sum();
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
    let Some(packed) = elements.of::<Springs>().find_map(Springs::packed) else {
        return in_sheets;
    };
    packed.add_product(matrix, p, out);
    // The product is 0 on pinned particles.
    divide_by_masses(matrix.free, out);
    in_sheets + packed.len()
}

/// Adds the blocks of these springs to the diagonal of the matrix. Returns their number.
pub(super) fn add_diagonal(elements: &Elements, matrix: &Matrix, diagonal: &mut Diagonal) -> usize {
    let all = elements.all().iter();
    all.map(|element| element.force().add_diagonal(matrix, diagonal))
        .sum()
}

/// Visits all other couplings.
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
