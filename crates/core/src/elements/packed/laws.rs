//! The laws of springs in blocks, and the forces that follow from them and a few scalar products.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::collections::HashMap;

use pulp::Scalar;

use crate::coupling::Matrix;
use crate::elements::inverse_root::inverse_root;
use crate::fused::mul_add;
use crate::spring::Spring;

/// Number of springs of a block, whose numbers stay in the first-level cache between the passes
/// over it.
pub(super) const BLOCK: usize = 64;

/// Quantity that is summed over springs.
#[derive(Clone, Copy, Debug)]
pub(super) enum Quantity {
    /// Forces.
    Forces,
    /// Differential of the forces.
    Differential,
    /// Product with the matrix of an implicit step, without its masses.
    Product(Factors),
}

/// Factors of stiffness and of damping in a product, and the least stiffness across a spring (N/m).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Factors {
    stiffness: f64,
    damping: f64,
    least: f64,
}

impl Quantity {
    /// Creates the product with a matrix.
    pub fn product(matrix: &Matrix) -> Self {
        // The differential of forces has the opposite sign.
        Self::Product(Factors {
            stiffness: -matrix.stiffness,
            damping: -matrix.damping,
            least: if matrix.clamped { 0.0 } else { f64::NEG_INFINITY },
        })
    }
}

/// Kernels for the springs of a block: forces, and quantities like their differential.
pub(super) trait Kernels: Sized {
    fn forces<const DAMPED: bool>(self);

    fn changes<const DAMPED: bool, const PRODUCT: bool>(self, factors: Factors);

    /// Calls the kernel of a quantity.
    #[inline(always)]
    fn run(self, quantity: Quantity, is_damped: bool) {
        let none = Factors::default();
        match (quantity, is_damped) {
            (Quantity::Forces, false) => self.forces::<false>(),
            (Quantity::Forces, true) => self.forces::<true>(),
            (Quantity::Differential, false) => self.changes::<false, false>(none),
            (Quantity::Differential, true) => self.changes::<true, false>(none),
            (Quantity::Product(factors), false) => self.changes::<false, true>(factors),
            (Quantity::Product(factors), true) => self.changes::<true, true>(factors),
        }
    }
}

/// A number for each spring of a block.
pub(super) type Each<T> = [T; BLOCK];

/// Numbers aligned to a cache line, so that no vector of them straddles two.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Aligned(pub Each<f64>);

impl Aligned {
    pub const ZERO: Self = Self([0.0; BLOCK]);
}

/// Laws of springs. Each of the three numbers has a list of its own, which the processor
/// prefetches.
#[derive(Debug, Default)]
pub(super) struct Laws {
    /// k (N/m).
    stiffness: Shared,
    /// k r (N).
    push: Shared,
    /// c (N s/m).
    damping: Shared,
}

/// A number for each spring, block by block. Blocks with equal numbers share them, so that these
/// stay in the cache.
#[derive(Debug, Default)]
struct Shared {
    different: Vec<Aligned>,
    /// Index of each block's numbers among these.
    of_blocks: Vec<u32>,
    /// Index by the bits of the numbers, until all blocks are added.
    places: HashMap<Each<u64>, u32>,
}

impl Shared {
    fn push(&mut self, numbers: &Each<f64>) {
        let next = self.different.len() as u32;
        let place = *self.places.entry(numbers.map(f64::to_bits)).or_insert(next);
        if place == next {
            self.different.push(Aligned(*numbers));
        }
        self.of_blocks.push(place);
    }

    #[inline(always)]
    fn of(&self, block: usize) -> &Each<f64> {
        &self.different[self.of_blocks[block] as usize].0
    }
}

/// The laws of a block.
#[derive(Clone, Copy)]
pub(super) struct Law<'a> {
    stiffness: &'a Each<f64>,
    push: &'a Each<f64>,
    damping: &'a Each<f64>,
}

/// Scalar products of d = xi - xj, w = vi - vj and their changes e and g.
#[derive(Clone, Copy, Default)]
pub(super) struct Products {
    pub dd: f64,
    pub de: f64,
    pub wd: f64,
    pub we: f64,
    pub gd: f64,
}

impl Laws {
    /// Adds a block with springs at the places given. Springs at other places have no stiffness.
    pub fn push<'a>(&mut self, springs: impl Iterator<Item = (usize, &'a Spring)>) {
        let [mut stiffness, mut push, mut damping] = [[0.0; BLOCK]; 3];
        for (m, Spring { law, .. }) in springs {
            stiffness[m] = law.stiffness;
            push[m] = law.stiffness * law.rest_length;
            damping[m] = law.damping;
        }
        self.stiffness.push(&stiffness);
        self.push.push(&push);
        self.damping.push(&damping);
    }

    /// Drops the data that only further blocks would need.
    pub fn end(&mut self) {
        for numbers in [&mut self.stiffness, &mut self.push, &mut self.damping] {
            numbers.places = HashMap::new();
        }
    }

    #[inline(always)]
    pub fn of(&self, block: usize) -> Law<'_> {
        Law {
            stiffness: self.stiffness.of(block),
            push: self.push.of(block),
            damping: self.damping.of(block),
        }
    }
}

/// Returns the factor s of the force -s d on end i of spring m: s = k - k r / L + c (w . d) / L^2.
#[inline(always)]
pub(super) fn force<const DAMPED: bool>(law: Law, m: usize, of: Products) -> f64 {
    // Finite for a spring of length 0, whose force is a multiple of d.
    let inverse = inverse_root(Scalar::new(), of.dd);
    let s = mul_add(-law.push[m], inverse, law.stiffness[m]);
    if DAMPED { mul_add(law.damping[m] * of.wd * inverse, inverse, s) } else { s }
}

/// Returns the factors a and b of -(a e + b d): the differential of the force on end i of spring m,
/// or its part in a product.
#[inline(always)]
pub(super) fn change<const DAMPED: bool, const PRODUCT: bool>(
    law: Law,
    m: usize,
    of: Products,
    factors: Factors,
) -> [f64; 2] {
    let root = inverse_root(Scalar::new(), of.dd);
    // A spring of length 0 has no direction.
    let inverse = if of.dd == 0.0 { 0.0 } else { root };
    let k = law.stiffness[m];
    let across = mul_add(-law.push[m], inverse, k);
    let share = of.de * inverse * inverse;
    if PRODUCT {
        let across = across.max(factors.least);
        let along = factors.stiffness * (k - across);
        let along = if DAMPED { mul_add(law.damping[m], factors.damping, along) } else { along };
        [factors.stiffness * across, along * share]
    } else if DAMPED {
        differential_of_damped(law.damping[m], [across, (k - across) * share], inverse, share, of)
    } else {
        [across, (k - across) * share]
    }
}

/// Adds the differential of damping: with p = (e - d (d . e) / L^2) / L, damping adds c (((g . d) /
/// L + w . p) d + (w . d) p) / L.
#[inline(always)]
fn differential_of_damped(
    damping: f64,
    [a, b]: [f64; 2],
    inverse: f64,
    share: f64,
    Products { wd, we, gd, .. }: Products,
) -> [f64; 2] {
    let c = damping * inverse * inverse;
    let turned = mul_add(-wd, share, we);
    let b = mul_add(c, mul_add(-wd, share, gd + turned), b);
    [mul_add(c, wd, a), b]
}
