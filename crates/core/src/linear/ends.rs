//! Lists of couplings by their ends, and contributions of couplings at both of their ends.

use super::block::Block;
use crate::coupling::{AxialCoupling, Diagonal, GeneralCoupling};

/// Adds a coupling's block to those of its ends on the diagonal, and its largest eigenvalue.
pub fn add_own(diagonal: &mut Diagonal, [i, j]: [usize; 2], block: Block, largest: f64) {
    let [columns @ .., sums] = &mut diagonal.columns;
    for (column, part) in columns.iter_mut().zip(block) {
        column[i] += part;
        if j != i {
            column[j] += part;
        }
    }
    sums[i] += largest;
    sums[j] += largest;
}

/// Adds (iso + along u uT) d at one end of a coupling, and subtracts it at the other.
#[inline]
pub fn add_axial(c: &AxialCoupling, iso: f64, along: f64, p: &[f64], out: &mut [f64]) {
    let (d, u) = (difference(p, c.i, c.j), c.direction);
    let share = along * (d[0] * u[0] + d[1] * u[1] + d[2] * u[2]);
    add(c.i, c.j, |axis| iso * d[axis] + share * u[axis], out);
}

/// Adds a block times d at one end of a coupling, and subtracts it at the other, unless the other
/// is a place.
pub fn add_block(c: &GeneralCoupling, block: [f64; 9], p: &[f64], out: &mut [f64]) {
    let n = p.len() / 3;
    let anchored = c.i == c.j;
    let d = if anchored {
        [0, n, 2 * n].map(|column| p[column + c.i])
    } else {
        difference(p, c.i, c.j)
    };
    for (axis, row) in block.as_chunks::<3>().0.iter().enumerate() {
        out[axis * n + c.i] += row[0] * d[0] + row[1] * d[1] + row[2] * d[2];
        if !anchored {
            let row = [block[axis], block[3 + axis], block[6 + axis]];
            out[axis * n + c.j] -= row[0] * d[0] + row[1] * d[1] + row[2] * d[2];
        }
    }
}

#[inline]
fn difference(p: &[f64], i: usize, j: usize) -> [f64; 3] {
    let n = p.len() / 3;
    [0, n, 2 * n].map(|column| p[column + i] - p[column + j])
}

#[inline]
fn add(i: usize, j: usize, force: impl Fn(usize) -> f64, out: &mut [f64]) {
    let n = out.len() / 3;
    for axis in 0..3 {
        out[axis * n + i] += force(axis);
        out[axis * n + j] -= force(axis);
    }
}

/// Puts a coupling in its place in a list. Returns whether there was one of the same ends.
#[inline]
pub fn put<C>(list: &mut Vec<C>, place: usize, new: C, ends: impl Fn(&C) -> [usize; 2]) -> bool {
    if let Some(old) = list.get_mut(place) {
        let same = ends(old) == ends(&new);
        *old = new;
        same
    } else {
        list.push(new);
        false
    }
}
