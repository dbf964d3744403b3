//! The laws of springs in blocks, and what follows from them and a few scalar products.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use pulp::Scalar;

use crate::elements::inverse_root::inverse_root;
use crate::spring::Spring;

/// Springs of a block: what is kept of them between the passes over it stays in the nearest cache.
pub(super) const BLOCK: usize = 64;

/// A number of each spring of a block.
pub(super) type Each<T> = [T; BLOCK];

/// Laws of springs, each of their numbers in a list of its own, which the processor reads ahead.
#[derive(Debug, Default)]
pub(super) struct Laws {
    /// k (N/m).
    stiffness: Vec<Each<f64>>,
    /// k r (N).
    push: Vec<Each<f64>>,
    /// c (N s/m).
    damping: Vec<Each<f64>>,
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
    /// Adds a block with springs at these places. At the others there are springs without
    /// stiffness.
    pub fn push<'a>(&mut self, springs: impl Iterator<Item = (usize, &'a Spring)>) {
        let [mut stiffness, mut push, mut damping] = [[0.0; BLOCK]; 3];
        for (m, Spring { law, .. }) in springs {
            stiffness[m] = law.stiffness;
            push[m] = law.stiffness * law.rest_length;
            damping[m] = law.damping;
        }
        self.stiffness.push(stiffness);
        self.push.push(push);
        self.damping.push(damping);
    }

    #[inline(always)]
    pub fn of(&self, block: usize) -> Law<'_> {
        Law {
            stiffness: &self.stiffness[block],
            push: &self.push[block],
            damping: &self.damping[block],
        }
    }
}

/// The force on i of spring m is -s d: s = k - k r / L + c (w . d) / L^2.
#[inline(always)]
pub(super) fn force<const DAMPED: bool>(law: Law, m: usize, of: Products) -> f64 {
    // Finite for a spring without a length, whose force is a multiple of d.
    let inverse = inverse_root(Scalar::new(), of.dd);
    let s = (-law.push[m]).mul_add(inverse, law.stiffness[m]);
    if DAMPED {
        (law.damping[m] * of.wd * inverse).mul_add(inverse, s)
    } else {
        s
    }
}

/// With p = (e - d (d . e) / L^2) / L, the change of the force on i of spring m is
/// -(s e + (k - s) d (d . e) / L^2) - c (((g . d) / L + w . p) d + (w . d) p) / L, where s is
/// k - k r / L; that is -(a e + b d). A spring without a length has no direction.
#[inline(always)]
pub(super) fn differential<const DAMPED: bool>(law: Law, m: usize, of: Products) -> [f64; 2] {
    let Products { dd, de, wd, we, gd } = of;
    let root = inverse_root(Scalar::new(), dd);
    let inverse = if dd == 0.0 { 0.0 } else { root };
    let k = law.stiffness[m];
    let s = (-law.push[m]).mul_add(inverse, k);
    let share = de * inverse * inverse;
    let [a, b] = [s, (k - s) * share];
    if DAMPED {
        let c = law.damping[m] * inverse * inverse;
        let turned = (-wd).mul_add(share, we);
        let b = c.mul_add((-wd).mul_add(share, gd + turned), b);
        [c.mul_add(wd, a), b]
    } else {
        [a, b]
    }
}
