//! Modes of a scene around a state, from products with the force differential alone: Lanczos's
//! method with full reorthogonalisation, and power iteration.
//!
//! Modes where damping mixes the shapes of the undamped motion. With mass-normalised stiffness K
//! and damping D, x'' = -K x - D x' has the eigenvalues of the quadratic pencil l^2 + l D + K. They
//! are those of the matrix [[0, w], [-K / w, -D]] of a first-order system, for any w > 0 (Tisseur,
//! Meerbergen, *The quadratic eigenvalue problem*, SIAM Review 43, 2001).

use nalgebra::{Complex, DMatrix, SymmetricEigen};

use super::eigenvalues::{MAX_ITERATIONS, PRECISIONS, eigenvalues, kernel};
use super::linearised::{MAX_DENSE_LENGTH, StateJacobian};
use super::mode::{MIN_MIXING, Mixing, Mode, Normalised, dot, normalise, sort};
use crate::system::{Linearized, Mechanics, ParticleSystem, kick_reads_velocity};

/// Largest number of products with the stiffness for a spectrum: enough for three exact digits of
/// its ends on any cloth, and for a sample of its middle.
const MAX_PRODUCTS: usize = 64;
/// Largest number of multiplications to compute all modes, which take a few seconds.
const MAX_MULTIPLICATIONS: f64 = 2e9;

/// Returns the modes around the state y at time t (s), fastest first.
///
/// For a linearised mechanical system they come from Lanczos's method on the mass-normalised
/// stiffness, each with the damping of its own shape. If damping mixes these shapes, the modes of a
/// small system come from all of its eigenvalues; those of a large one include that of the particle
/// with the largest drag over mass. For a small first-order system, and a small one with
/// constraints, the modes come from the eigenvalues of its Jacobian, without the particles on rigid
/// bodies. In a large system, constraints only add the mode in which their errors decay. Any other
/// system has no modes, nor has one whose eigenvalues are not found in a limited number of
/// iterations. A mode of negative stiffness buckles.
#[must_use]
pub fn spectrum(system: &dyn ParticleSystem, t: f64, y: &[f64]) -> Vec<Mode> {
    let linearized = system.mechanics().and_then(Mechanics::linearized);
    let is_constrained = |m: &&dyn Linearized| m.baumgarte_frequency().is_some();
    let small = y.len() <= MAX_DENSE_LENGTH;
    let mut modes = match linearized.filter(|m| !(small && is_constrained(m))) {
        Some(mechanics) => {
            let (x, _) = y.split_at(y.len() / 2);
            let Undamped { mut modes, mixing, .. } = of_mechanics(mechanics, t, x, MAX_PRODUCTS);
            if mixing > Mixing::None {
                let pencil = Pencil::of(mechanics, t, x, MAX_DENSE_LENGTH / 2);
                match pencil.and_then(|pencil| pencil.modes(&modes)) {
                    Some(mixed) => modes = mixed,
                    None => modes.extend(of_drag(mechanics)),
                }
            }
            modes.extend(of_constraints(mechanics));
            modes
        }
        None => StateJacobian::of(system, t, y).map_or(vec![], |jacobian| jacobian.modes(system)),
    };
    sort(&mut modes);
    modes
}

/// Modes around a state without damping, fastest first, each with its damping.
pub(super) struct Undamped {
    pub modes: Vec<Mode>,
    /// Shape of each mode: the displacements times the roots of the masses, of length 1.
    pub shapes: Vec<Vec<f64>>,
    /// Degree to which damping mixes these shapes.
    pub mixing: Mixing,
}

/// Returns the modes around the positions x (m): all of them, or as many as a few seconds allow.
pub(super) fn shapes(mechanics: &dyn Linearized, t: f64, x: &[f64]) -> Undamped {
    let products = (MAX_MULTIPLICATIONS / x.len() as f64).sqrt() as usize;
    of_mechanics(mechanics, t, x, products.max(MAX_PRODUCTS))
}

/// Returns the modes around x by Lanczos's method with at most `products` products.
fn of_mechanics(mechanics: &dyn Linearized, t: f64, x: &[f64], products: usize) -> Undamped {
    let mut found = Undamped { modes: vec![], shapes: vec![], mixing: Mixing::None };
    let mut stiffness = Normalised::new(mechanics, t, x);
    let mut basis = vec![stiffness.any_shape()];
    if dot(&basis[0], &basis[0]) == 0.0 {
        return found;
    }
    let (mut alpha, mut beta) = (vec![], vec![]);
    let mut next = vec![0.0; x.len()];
    loop {
        let last = &basis[basis.len() - 1];
        stiffness.product(last, false, &mut next);
        alpha.push(dot(last, &next));
        if basis.len() == products {
            break;
        }
        // Gram-Schmidt against the whole basis, twice, which makes it orthogonal to rounding.
        for _ in 0..2 {
            for z in &basis {
                let share = dot(z, &next);
                for (next, z) in next.iter_mut().zip(z) {
                    *next -= share * z;
                }
            }
        }
        let length = normalise(&mut next);
        let largest = alpha.iter().fold(0.0, |m: f64, a| m.max(a.abs()));
        if length <= 1e-10 * largest || largest == 0.0 {
            break;
        }
        beta.push(length);
        basis.push(next.clone());
    }
    let m = alpha.len();
    let tridiagonal = DMatrix::from_fn(m, m, |i, j| match i.abs_diff(j) {
        0 => alpha[i],
        1 => beta[i.min(j)],
        _ => 0.0,
    });
    let most = MAX_ITERATIONS * m;
    let find = |precision| SymmetricEigen::try_new(tridiagonal.clone(), precision, most);
    let Some(eigen) = PRECISIONS.into_iter().find_map(find) else {
        return found;
    };
    let mut order: Vec<_> = (0..m).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    for k in order {
        let mut shape = vec![0.0; x.len()];
        for (weight, z) in eigen.eigenvectors.column(k).iter().zip(&basis) {
            for (shape, z) in shape.iter_mut().zip(z) {
                *shape += weight * z;
            }
        }
        let (mode, mixing) = stiffness.mode(eigen.eigenvalues[k], &shape, &mut next);
        found.modes.push(mode);
        found.shapes.push(shape);
        if mixing > found.mixing {
            found.mixing = mixing;
        }
    }
    found
}

/// Returns the mode of the particle with the largest drag over mass, as if no spring held it;
/// `None` if all have the same.
pub(super) fn of_drag(mechanics: &dyn Linearized) -> Option<Mode> {
    let free = || mechanics.inverse_masses().iter().filter(|w| **w > 0.0);
    let lightest = free().fold(0.0, |m: f64, w| m.max(*w));
    let heaviest = free().fold(f64::INFINITY, |m: f64, w| m.min(*w));
    let drag = mechanics.drag_coefficient() * lightest;
    let differs = drag > 0.0 && lightest > (1.0 + MIN_MIXING) * heaviest;
    differs.then(|| Mode {
        // Small but positive, so that the mode counts as one that returns.
        stiffness: (1e-3 * drag).powi(2),
        drag,
        damping: 0.0,
        reads_velocity: kick_reads_velocity(mechanics),
    })
}

/// Returns the critically damped mode in which Baumgarte stabilisation reduces the errors of all
/// constraints; `None` without constraints.
fn of_constraints(mechanics: &dyn Linearized) -> Option<Mode> {
    mechanics.baumgarte_frequency().map(|w| Mode {
        stiffness: w * w,
        drag: 0.0,
        damping: 2.0 * w,
        reads_velocity: true,
    })
}

/// Fastest mode of a run in progress, by power iteration from the shape at the last estimate.
#[derive(Clone, Debug, Default)]
pub struct LargestMode {
    shape: Vec<f64>,
    mixes: bool,
}

impl LargestMode {
    /// Returns the shape of the mode at the last estimate: the displacements times the roots of the
    /// masses, of length 1; empty before the first estimate.
    #[must_use]
    pub fn shape(&self) -> &[f64] {
        &self.shape
    }

    /// Returns whether damping mixed this shape with others at the last estimate, or drag differs
    /// so much between particles that another mode may limit the step.
    #[must_use]
    pub fn mixes(&self) -> bool {
        self.mixes
    }

    /// Estimates the fastest mode around the positions x (m) at time t (s), or that of the
    /// constraints if it is faster.
    ///
    /// The first estimate takes 24 products with the force differential and is accurate to 1 %.
    /// Later ones take 4 products, and are as accurate if the positions have changed little.
    #[must_use]
    pub fn estimate(&mut self, mechanics: &dyn Linearized, t: f64, x: &[f64]) -> Option<Mode> {
        let mut stiffness = Normalised::new(mechanics, t, x);
        let free = mechanics.inverse_masses();
        let known = self.shape.len() == x.len();
        if !known {
            self.shape = stiffness.any_shape();
        }
        // A particle may have been pinned since the last estimate.
        for (k, z) in self.shape.iter_mut().enumerate() {
            if free[k % free.len()] == 0.0 {
                *z = 0.0;
            }
        }
        normalise(&mut self.shape);
        let mut next = vec![0.0; x.len()];
        let mut largest = 0.0;
        for _ in 0..if known { 3 } else { 23 } {
            stiffness.product(&self.shape, false, &mut next);
            largest = normalise(&mut next);
            if !(largest.is_finite() && largest > 0.0) {
                self.shape.clear();
                return of_constraints(mechanics);
            }
            std::mem::swap(&mut self.shape, &mut next);
        }
        let (mode, mixing) = stiffness.mode(largest, &self.shape, &mut next);
        let dragged =
            of_drag(mechanics).is_some_and(|most| most.drag > (1.0 + MIN_MIXING) * mode.drag);
        self.mixes = mixing > Mixing::None || dragged;
        let faster = of_constraints(mechanics).filter(|other| other.stiffness > mode.stiffness);
        faster.or(Some(mode))
    }
}

/// Real or imaginary part of an eigenvalue, over the largest eigenvalue, below which it is a
/// rounding error.
const ROUNDING: f64 = 1e-12;
/// Eigenvalue, over the largest, below which it counts as zero: rounding may split a double
/// eigenvalue by its square root.
const ZERO_SHARE: f64 = 1e-7;

/// Stiffness and damping of a mechanical system around some positions, mass-normalised.
#[derive(Clone)]
pub(super) struct Pencil {
    stiffness: DMatrix<f64>,
    damping: DMatrix<f64>,
    /// Indices in x of the coordinates of free particles, and the length of x.
    unknowns: Vec<usize>,
    length: usize,
}

impl Pencil {
    /// Creates the pencil at the positions x (m); `None` if x has more than `most` free
    /// coordinates.
    pub fn of(mechanics: &dyn Linearized, t: f64, x: &[f64], most: usize) -> Option<Self> {
        let w = mechanics.inverse_masses();
        let unknowns: Vec<_> = (0..x.len()).filter(|k| w[k % w.len()] != 0.0).collect();
        if unknowns.len() > most {
            return None;
        }
        let mut products = Normalised::new(mechanics, t, x);
        let (mut z, mut out) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        let mut matrix = |damping| {
            let mut matrix = DMatrix::zeros(unknowns.len(), unknowns.len());
            for (mut column, &j) in matrix.column_iter_mut().zip(&unknowns) {
                z[j] = 1.0;
                products.product(&z, damping, &mut out);
                z[j] = 0.0;
                for (entry, &i) in column.iter_mut().zip(&unknowns) {
                    *entry = out[i];
                }
            }
            matrix
        };
        let (stiffness, damping) = (matrix(false), matrix(true));
        let finite = stiffness.iter().chain(&damping).all(|a| a.is_finite());
        finite.then_some(Self { stiffness, damping, unknowns, length: x.len() })
    }

    /// Returns the modes, one for each real eigenvalue and each conjugate pair, fastest first.
    /// Damping is divided between drag and springs as in the undamped mode of the nearest
    /// frequency. `None` if the eigenvalues are not found.
    pub fn modes(&self, undamped: &[Mode]) -> Option<Vec<Mode>> {
        let n = self.unknowns.len();
        // Makes the norms of both parts of the state similar.
        let w = self.stiffness.amax().sqrt().max(self.damping.amax());
        let mut matrix = DMatrix::zeros(2 * n, 2 * n);
        matrix.view_mut((0, n), (n, n)).fill_diagonal(w);
        matrix.view_mut((n, 0), (n, n)).copy_from(&(&self.stiffness / -w));
        matrix.view_mut((n, n), (n, n)).copy_from(&-&self.damping);
        let found = eigenvalues(&matrix);
        let share = |stiffness: f64| {
            let distance = |mode: &Mode| (mode.stiffness - stiffness).abs();
            let nearest = undamped.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
            nearest.map_or(0.0, |m| m.damping / (m.drag + m.damping).max(1e-300))
        };
        let reads_velocity = undamped.iter().any(|mode| mode.reads_velocity);
        let scale = found.iter().fold(0.0, |m: f64, l| m.max(l.norm()));
        let mut modes: Vec<_> = found
            .iter()
            .filter(|l| l.norm() > ZERO_SHARE * scale)
            .map(|l| [l.re, l.im].map(|a| if a.abs() < ROUNDING * scale { 0.0 } else { a }))
            .filter(|[_, im]| *im >= 0.0)
            .map(|[re, im]| {
                let mode = Mode::of_eigenvalue(re, im);
                let damping = share(mode.stiffness) * mode.drag;
                Mode { drag: mode.drag - damping, damping, reads_velocity, ..mode }
            })
            .collect();
        sort(&mut modes);
        (!found.is_empty()).then_some(modes)
    }

    /// Returns the shape of a mode at one moment, by inverse iteration: the displacements times the
    /// roots of the masses, of length 1.
    pub fn shape(&self, mode: &Mode) -> Option<Vec<f64>> {
        let [re, im] = mode.eigenvalues()[0];
        let l = Complex::new(re, im) * (1.0 + 1e-9);
        let complex = |a: &DMatrix<f64>| a.map(|a| Complex::new(a, 0.0));
        let mut matrix = complex(&self.stiffness) + complex(&self.damping) * l;
        for k in 0..self.unknowns.len() {
            matrix[(k, k)] += l * l;
        }
        let shape = kernel(matrix)?;
        // Phase of the moment with the largest displacements.
        let square: Complex<f64> = shape.iter().map(|z| z * z).sum();
        let turn = Complex::from_polar(1.0, -0.5 * square.arg());
        let mut whole = vec![0.0; self.length];
        for (k, z) in self.unknowns.iter().zip(&shape) {
            whole[*k] = (z * turn).re;
        }
        let length = whole.iter().map(|z| z * z).sum::<f64>().sqrt();
        for z in &mut whole {
            *z /= length;
        }
        length.is_finite().then_some(whole)
    }
}
