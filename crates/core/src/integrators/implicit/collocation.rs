//! The equations of Radau IIA with three stages, solved by simplified Newton's method (Hairer,
//! Wanner, *Solving Ordinary Differential Equations II*, 1996, IV.8). With the nodes c of the
//! formula of order 5 and the inverse of its matrix A, the displacements `z_i` of the stages from y
//! satisfy `sum (A^-1)_ij M z_j = h f(t + c_i h, y + z_i)`, where the mass matrix M is mostly 1. In
//! the basis of the eigenvectors of A^-1, z = T w, Newton's method for them splits into a real
//! linear system and a complex one, each of the size of y. The Jacobian is kept as long as the
//! iterations converge with it.

use nalgebra::Complex;

use super::super::error_norm::ErrorNorm;
use super::super::sweep::add_scaled;
use super::jacobian::Jacobian;
use super::lu::Lu;
use crate::system::ParticleSystem;
use crate::work::Work;

/// Number of stages.
pub(super) const STAGES: usize = 3;

/// Square root of 6.
pub(super) const ROOT6: f64 = 2.449_489_742_783_178;

/// Nodes.
pub(super) const NODES: [f64; STAGES] = [(4.0 - ROOT6) / 10.0, (4.0 + ROOT6) / 10.0, 1.0];

/// Real eigenvalue of A^-1, 3 + 3^(2/3) - 3^(1/3), and the real and imaginary part of the others,
/// 3 + (3^(1/3) - 3^(2/3)) / 2 and -(3^(5/6) + 3^(7/6)) / 2.
pub(super) const REAL: f64 = 3.637_834_252_744_496;
const PAIR: (f64, f64) = (2.681_082_873_627_752_3, -3.050_430_199_247_410_5);

/// Eigenvectors T of A^-1, and their inverse. The last two columns of T are the real and the
/// imaginary part of a vector of the pair.
const TO_STAGES: [[f64; STAGES]; STAGES] = [
    [0.094_438_762_488_975_24, -0.141_255_295_020_954_2, 0.030_029_194_105_147_42],
    [0.250_213_122_965_333_3, 0.204_129_352_293_799_94, -0.382_942_112_757_261_9],
    [1.0, 1.0, 0.0],
];
const TO_PARTS: [[f64; STAGES]; STAGES] = [
    [4.178_718_591_551_904, 0.327_682_820_761_062_4, 0.523_376_445_499_449_5],
    [-4.178_718_591_551_904, -0.327_682_820_761_062_4, 0.476_623_554_500_550_44],
    [0.502_872_634_945_786_8, -2.571_926_949_855_605, 0.596_039_204_828_224_9],
];

/// Largest number of iterations, if a shorter step may follow, and if none may.
pub(super) const MAX_ITERATIONS: [i32; 2] = [7, 30];
/// Rate of convergence up to which the Jacobian is kept for the next step (Hairer, Wanner, IV.8).
const KEPT_RATE: f64 = 1e-3;
/// Largest part of the allowed error that may remain in the equations: the smaller of this and the
/// root of the relative tolerance, which measured well in RADAU5.
const ERROR_SHARE: f64 = 0.03;
/// Relative size of a change that may be rounding.
const ROUNDING: f64 = 10.0 * f64::EPSILON;
/// Power of the last rate with which the first iteration of a step is judged (RADAU5).
const RATE_MEMORY: f64 = 0.8;

/// Solver of the equations, with the Jacobian and the factors that it keeps.
pub(super) struct Collocation {
    pub jacobian: Jacobian,
    /// Time and step (s), and state, for which the Jacobian was formed.
    pub formed: ([f64; 2], Vec<f64>),
    /// Step (s) for which the matrices were factorised; 0 for none.
    pub factored: f64,
    pub real: Lu<f64>,
    complex: Lu<Complex<f64>>,
    /// Displacements of the stages, by stage and in the basis of the eigenvectors.
    pub stages: [Vec<f64>; STAGES],
    parts: [Vec<f64>; STAGES],
    f: [Vec<f64>; STAGES],
    /// Products of the mass matrix with the parts.
    moved: [Vec<f64>; STAGES],
    at: Vec<f64>,
    /// Right-hand sides, then solutions.
    single: Vec<f64>,
    pair: Vec<Complex<f64>>,
    /// Sum of a geometric series of the last rate of convergence, from its first power on.
    pub remaining: f64,
    /// Number of iterations of the last solution, and its rate of convergence.
    pub iterations: i32,
    rate: f64,
}

impl Collocation {
    pub fn new(system: &dyn ParticleSystem) -> Self {
        let jacobian = Jacobian::new(system);
        let (dim, order) = (system.dim(), jacobian.order());
        let zeros = || [(); STAGES].map(|()| vec![0.0; dim]);
        Self {
            jacobian,
            formed: ([0.0; 2], vec![0.0; dim]),
            factored: 0.0,
            real: Lu::new(order),
            complex: Lu::new(order),
            stages: zeros(),
            parts: zeros(),
            f: zeros(),
            moved: zeros(),
            at: vec![0.0; dim],
            single: vec![0.0; order],
            pair: vec![Complex::default(); order],
            remaining: 1.0,
            iterations: 0,
            rate: 0.0,
        }
    }

    /// Forms the Jacobian at y, for steps of about h (s).
    pub fn form(&mut self, system: &dyn ParticleSystem, t: f64, h: f64, y: &[f64]) -> Work {
        self.formed.0 = [t, h];
        self.formed.1.copy_from_slice(y);
        self.factored = 0.0;
        self.remaining = 1.0;
        self.jacobian.form(system, t, h, y)
    }

    /// Forms and factorises the Jacobian again where it was formed before, which was counted as
    /// work then.
    pub fn form_again(&mut self, system: &dyn ParticleSystem) {
        let ([t, h], at) = &self.formed;
        let _ = self.jacobian.form(system, *t, *h, at);
        let factored = std::mem::take(&mut self.factored);
        if factored > 0.0 {
            let _ = self.factorise(factored);
        }
    }

    /// Factorises the matrices of a step of h (s), unless they are. Returns the cost, and whether
    /// that succeeded.
    pub fn factorise(&mut self, h: f64) -> (Work, bool) {
        if self.factored.to_bits() == h.to_bits() {
            return (Work::default(), true);
        }
        let shift = Complex::new(PAIR.0, PAIR.1) / h;
        let of_use = self.jacobian.factorise(&mut self.real, REAL / h, 1.0)
            && self.jacobian.factorise(&mut self.complex, shift, 1.0);
        self.factored = if of_use { h } else { 0.0 };
        let work = Work {
            factorizations: 2,
            ..self.jacobian.algebra(self.real.cost() + self.complex.cost())
        };
        (work, of_use)
    }

    /// Returns the rate of convergence of the last solution.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Returns whether a new Jacobian would help the next step.
    pub fn converges_slowly(&self) -> bool {
        self.iterations > 1 && self.rate > KEPT_RATE
    }

    /// Solves the equations of a step of h (s) from y, starting from the displacements in `stages`,
    /// by at most `most` iterations. They end when, by their rate of convergence, the remaining
    /// error is a small part of the allowed error of a step. Returns the cost, and whether that
    /// succeeded.
    pub fn solve(&mut self, (t, y): (f64, &[f64]), norm: &ErrorNorm, most: i32) -> (Work, bool) {
        let (h, relative) = (norm.h, norm.tolerance.relative);
        let enough = (ROUNDING / relative).max(ERROR_SHARE.min(relative.sqrt()));
        let mut work = Work::default();
        combine(&TO_PARTS, &self.stages, &mut self.parts);
        self.remaining = self.remaining.max(f64::EPSILON).powf(RATE_MEMORY);
        let mut last: Option<f64> = None;
        self.rate = 0.0;
        for left in (0..most).rev() {
            self.iterations = most - left;
            work += self.correct(norm.system, (t, y), h);
            let sizes = self.f.iter().map(|change| norm.of(y, y, change));
            // NaN stays.
            let size = sizes.fold(0.0, |most: f64, size| if size <= most { most } else { size });
            if let Some(last) = last {
                let found = if last > 0.0 { size / last } else { 0.0 };
                // The rate is smoothed over two iterations, as it oscillates.
                self.rate = if self.iterations > 2 { (found * self.rate).sqrt() } else { found };
                self.remaining = self.rate / (1.0 - self.rate);
                let predicted = self.remaining * size * self.rate.powi(left);
                if !(self.rate < 0.99 && predicted < enough) {
                    // Iterations that diverge say nothing about the next ones.
                    self.remaining = 1.0;
                    return (work, false);
                }
            } else if !size.is_finite() {
                return (work, false);
            }
            for (part, change) in self.parts.iter_mut().zip(&self.f) {
                add_scaled(part, 1.0, change);
            }
            combine(&TO_STAGES, &self.parts, &mut self.stages);
            if self.remaining * size <= enough {
                return (work, true);
            }
            last = Some(size);
        }
        (work, false)
    }

    /// Makes one iteration: replaces f by the change of the parts. Returns the cost.
    fn correct(&mut self, system: &dyn ParticleSystem, (t, y): (f64, &[f64]), h: f64) -> Work {
        let Self { jacobian, stages, parts, f, moved, at, single, pair, .. } = self;
        for ((z, f), node) in stages.iter().zip(&mut *f).zip(NODES) {
            at.copy_from_slice(y);
            add_scaled(at, 1.0, z);
            system.eval_f(t + node * h, at, f);
        }
        for (part, moved) in parts.iter().zip(&mut *moved) {
            jacobian.multiply_mass(part, moved);
        }
        let (real, shift) = (REAL / h, Complex::new(PAIR.0, PAIR.1) / h);
        for (k, &i) in jacobian.unknowns.iter().enumerate() {
            let of = |row: &[f64; STAGES]| row[0] * f[0][i] + row[1] * f[1][i] + row[2] * f[2][i];
            single[k] = of(&TO_PARTS[0]) - real * moved[0][i];
            let w = Complex::new(moved[1][i], moved[2][i]);
            pair[k] = Complex::new(of(&TO_PARTS[1]), of(&TO_PARTS[2])) - shift * w;
        }
        self.real.solve(single);
        self.complex.solve(pair);
        for f in &mut *f {
            f.fill(0.0);
        }
        for ((single, pair), &i) in single.iter().zip(&*pair).zip(&jacobian.unknowns) {
            (f[0][i], f[1][i], f[2][i]) = (*single, pair.re, pair.im);
        }
        let solutions = self.real.cost_of_solution() + self.complex.cost_of_solution();
        Work { evaluations: STAGES as u64, solves: 2, ..self.jacobian.algebra(solutions) }
    }

    /// Replaces a vector by its product with the inverse of REAL / h M - J. Returns the cost.
    pub fn filter(&mut self, error: &mut [f64]) -> Work {
        let unknowns = &self.jacobian.unknowns;
        for (single, &i) in self.single.iter_mut().zip(unknowns) {
            *single = error[i];
        }
        self.real.solve(&mut self.single);
        error.fill(0.0);
        for (single, &i) in self.single.iter().zip(unknowns) {
            error[i] = *single;
        }
        self.jacobian.algebra(self.real.cost_of_solution())
    }
}

/// Writes the products of a matrix with three vectors, number by number.
fn combine(
    matrix: &[[f64; STAGES]; STAGES],
    of: &[Vec<f64>; STAGES],
    out: &mut [Vec<f64>; STAGES],
) {
    for (row, out) in matrix.iter().zip(out) {
        out.fill(0.0);
        for (weight, of) in row.iter().zip(of) {
            add_scaled(out, *weight, of);
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;

    /// Butcher's matrix of the formula (Hairer, Wanner, table IV.5.6).
    #[test]
    fn the_basis_splits_the_inverse_of_the_matrix() {
        let s = ROOT6;
        let a = Matrix3::new(
            (88.0 - 7.0 * s) / 360.0,
            (296.0 - 169.0 * s) / 1800.0,
            (-2.0 + 3.0 * s) / 225.0,
            (296.0 + 169.0 * s) / 1800.0,
            (88.0 + 7.0 * s) / 360.0,
            (-2.0 - 3.0 * s) / 225.0,
            (16.0 - s) / 36.0,
            (16.0 + s) / 36.0,
            1.0 / 9.0,
        );
        let of = |rows: &[[f64; 3]; 3]| Matrix3::from_fn(|i, j| rows[i][j]);
        let (to, back) = (of(&TO_STAGES), of(&TO_PARTS));
        assert!((to * back - Matrix3::identity()).norm() < 1e-14);
        let split = back * a.try_inverse().unwrap() * to;
        let (re, im) = PAIR;
        let blocks = Matrix3::new(REAL, 0.0, 0.0, 0.0, re, -im, 0.0, im, re);
        assert!((split - blocks).norm() < 1e-12, "{split}");
    }
}
