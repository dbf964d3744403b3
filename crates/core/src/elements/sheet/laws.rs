//! The laws of a sheet's springs as its kernel reads them. All springs of a direction have one law,
//! except those that would end beside the sheet, whose law is zero: the vectors of a row have four
//! different laws. A row in which springs are missing has a mask of its own, by which the laws are
//! multiplied.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use pulp::Simd;

use super::lanes::{Columns, Vectors};
use super::missing::Masks;
use super::model::Sheet;
use super::offsets::OFFSETS;
use crate::rows::PAD;

/// Number of kinds of vectors in a row, whose laws differ: the first, the middle ones, the last but
/// one, and the last.
const KINDS: usize = 4;
/// Count of the numbers of all laws: k, k r and c of the springs of each direction, with zeros
/// where none starts, and zeros for rows whose springs would end below the last row.
pub(crate) const LAWS: usize = 3 * (OFFSETS.len() + 1) * KINDS * PAD;

/// Writes the laws of `width` columns from the `first` on.
#[inline(always)]
pub(super) fn fill<S: Simd>(laws: &mut [f64], sheet: &Sheet, first: usize, width: usize) {
    let (cols, lanes) = (sheet.grid().cols(), S::F64_LANES);
    let m = width.div_ceil(lanes);
    let vectors = [0, 1, m.saturating_sub(2), m - 1];
    let directions = laws.chunks_exact_mut(3 * KINDS * PAD).zip(sheet.laws()).zip(OFFSETS);
    for ((three, law), (_, _, right)) in directions {
        // The first ends of springs whose second ends are on the sheet.
        let from = right.min(0).unsigned_abs().saturating_sub(first);
        let to = width.min((cols - first).saturating_sub(right.max(0) as usize));
        let numbers = [law.stiffness, law.stiffness * law.rest_length, law.damping];
        for (column, number) in three.chunks_exact_mut(KINDS * PAD).zip(numbers) {
            for (vector, i) in column.chunks_exact_mut(lanes).zip(vectors) {
                for (lane, law) in vector.iter_mut().enumerate() {
                    let begins = (from..to).contains(&(i * lanes + lane));
                    *law = if begins { number } else { 0.0 };
                }
            }
        }
    }
}

/// Returns the kind of vector i of `count`.
#[inline(always)]
pub(super) fn kind(i: usize, count: usize) -> usize {
    let after = count - 1 - i;
    let kind = if after < 2 { 3 - after } else { i.min(1) };
    kind % KINDS
}

/// The laws of the springs of one direction in a row. With `MASKED`, springs are missing in the
/// row.
pub(super) struct Law<'a, S: Simd, const MASKED: bool> {
    table: Columns<'a, S>,
    numbers: Vectors<S>,
    mask: &'a [S::f64s],
}

impl<'a, S: Simd, const MASKED: bool> Law<'a, S, MASKED> {
    /// Returns the laws of a row with `below` rows below it and `count` vectors.
    #[inline(always)]
    pub fn new(
        simd: S,
        (laws, masks): (&'a [f64], Option<Masks<'a>>),
        direction: usize,
        below: usize,
        count: usize,
    ) -> Self {
        let (_, rows_down, _) = OFFSETS[direction];
        let of = |direction: usize| {
            let three = &laws[3 * direction * KINDS * PAD..][..3 * KINDS * PAD];
            [
                &S::as_simd_f64s(three).0[..KINDS],
                &S::as_simd_f64s(&three[KINDS * PAD..]).0[..KINDS],
                &S::as_simd_f64s(&three[2 * KINDS * PAD..]).0[..KINDS],
            ]
        };
        match masks {
            Some(masks) if MASKED => {
                let zero = of(OFFSETS.len());
                Self {
                    table: zero,
                    numbers: masks.numbers[direction].map(|number| simd.splat_f64s(number)),
                    mask: &S::as_simd_f64s(masks.column(direction)).0[..count],
                }
            }
            _ => Self {
                table: of(if rows_down <= below { direction } else { OFFSETS.len() }),
                numbers: [simd.splat_f64s(0.0); 3],
                mask: &[],
            },
        }
    }

    /// Returns the law of vector i, of a [`kind`].
    #[inline(always)]
    pub fn at(&self, simd: S, i: usize, kind: usize) -> Vectors<S> {
        if MASKED {
            self.numbers.map(|number| simd.mul_f64s(number, self.mask[i]))
        } else {
            [self.table[0][kind], self.table[1][kind], self.table[2][kind]]
        }
    }
}
