//! Spectrum: the modes of a scene around a state, from products with the force differential alone.

use nalgebra::DMatrix;

use super::Mode;
use crate::random::SplitMix;
use crate::system::{Linearized, Mechanics, ParticleSystem};

/// Products with the stiffness that a spectrum takes at most: enough for its ends to be exact to
/// three digits on any cloth, and for its middle to be seen.
const PRODUCTS: usize = 64;
/// Most multiplications that finding every mode may take (a few seconds).
const MULTIPLICATIONS: f64 = 2e9;
/// Largest first-order system whose Jacobian is computed, in numbers of its state.
const DENSE: usize = 300;

/// The modes around the state y, fastest first: of a mechanical system by Lanczos's method on the
/// mass-normalised stiffness, each with the damping of its own shape, and of its constraints the
/// mode in which errors are taken back; of a small first-order system from its Jacobian. A system
/// that is neither has none. Negative stiffness is a mode that buckles.
#[must_use]
pub fn spectrum(system: &dyn ParticleSystem, t: f64, y: &[f64]) -> Vec<Mode> {
    let mut modes = match system.mechanics().and_then(Mechanics::linearized) {
        Some(mechanics) => {
            let (x, _) = y.split_at(y.len() / 2);
            let mut modes = vec![];
            of_mechanics(mechanics, t, x, PRODUCTS, &mut |mode, _| modes.push(mode));
            modes.extend(of_constraints(mechanics));
            modes
        }
        None if y.len() <= DENSE => of_jacobian(system, t, y),
        None => vec![],
    };
    modes.sort_by(|a, b| b.stiffness.total_cmp(&a.stiffness));
    modes
}

/// Every mode around the positions x, or as many as a few seconds allow, fastest first, each with
/// its shape: the root of the masses times the displacement, of length 1.
pub(super) fn shapes(mechanics: &dyn Linearized, t: f64, x: &[f64]) -> Vec<(Mode, Vec<f64>)> {
    let products = (MULTIPLICATIONS / x.len() as f64).sqrt() as usize;
    let mut modes = vec![];
    let products = products.max(PRODUCTS);
    of_mechanics(mechanics, t, x, products, &mut |mode, shape| {
        modes.push((mode, shape.to_vec()));
    });
    modes.sort_by(|(a, _), (b, _)| b.stiffness.total_cmp(&a.stiffness));
    modes
}

/// Products with the mass-normalised stiffness and damping, M^-1/2 K M^-1/2. Velocities are taken
/// as zero: the modes are those of springs in this place, whatever they are doing.
struct Normalised<'a> {
    mechanics: &'a dyn Linearized,
    t: f64,
    x: &'a [f64],
    zero: Vec<f64>,
    scaled: Vec<f64>,
}

impl<'a> Normalised<'a> {
    fn new(mechanics: &'a dyn Linearized, t: f64, x: &'a [f64]) -> Self {
        Self {
            mechanics,
            t,
            x,
            zero: vec![0.0; x.len()],
            scaled: vec![0.0; x.len()],
        }
    }

    fn scale(&self, z: &mut [f64]) {
        let w = self.mechanics.inverse_masses();
        for column in z.chunks_exact_mut(w.len()) {
            for (z, w) in column.iter_mut().zip(w) {
                *z *= w.sqrt();
            }
        }
    }

    /// Writes K z, or D z, to `out`.
    fn product(&mut self, z: &[f64], damping: bool, out: &mut [f64]) {
        let mut scaled = std::mem::take(&mut self.scaled);
        scaled.copy_from_slice(z);
        self.scale(&mut scaled);
        let (dx, dv) = if damping {
            (&self.zero, &scaled)
        } else {
            (&scaled, &self.zero)
        };
        self.mechanics
            .force_differential(self.t, self.x, &self.zero, dx, dv, out);
        self.scaled = scaled;
        self.scale(out);
        for out in out {
            *out = -*out;
        }
    }

    /// Drag over mass (1/s) of the mode with the shape z.
    fn drag(&self, z: &[f64]) -> f64 {
        let w = self.mechanics.inverse_masses();
        let share = z
            .chunks_exact(w.len())
            .flat_map(|z| z.iter().zip(w).map(|(z, w)| z * z * w))
            .sum::<f64>();
        self.mechanics.drag_coefficient() * share
    }

    /// The mode with the shape z and that stiffness (1/s2).
    fn mode(&mut self, stiffness: f64, z: &[f64], scratch: &mut [f64]) -> Mode {
        self.product(z, true, scratch);
        let drag = self.drag(z);
        // The difference of two numbers that are the same without damped springs.
        let damping = dot(z, scratch) - drag;
        Mode {
            stiffness,
            drag,
            damping: if damping > 1e-9 * drag { damping } else { 0.0 },
        }
    }

    /// A shape with a part of every mode.
    fn any_shape(&self) -> Vec<f64> {
        let mut random = SplitMix(1);
        let free = self.mechanics.inverse_masses();
        let mut z: Vec<_> = (0..self.x.len())
            .map(|k| {
                let z = random.between(-1.0, 1.0);
                if free[k % free.len()] == 0.0 { 0.0 } else { z }
            })
            .collect();
        normalise(&mut z);
        z
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Scales z to length 1. Returns the length that it had.
fn normalise(z: &mut [f64]) -> f64 {
    let length = dot(z, z).sqrt();
    if length > 0.0 {
        for z in z {
            *z /= length;
        }
    }
    length
}

/// Visits the modes of a mechanical system with their shapes.
fn of_mechanics(
    mechanics: &dyn Linearized,
    t: f64,
    x: &[f64],
    products: usize,
    visit: &mut dyn FnMut(Mode, &[f64]),
) {
    let mut stiffness = Normalised::new(mechanics, t, x);
    let mut basis = vec![stiffness.any_shape()];
    if dot(&basis[0], &basis[0]) == 0.0 {
        return;
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
        // Against all that came before, twice, which is enough for orthogonality to the last digit.
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
    let eigen = tridiagonal.symmetric_eigen();
    let mut shape = vec![0.0; x.len()];
    for (k, weights) in eigen.eigenvectors.column_iter().enumerate() {
        shape.fill(0.0);
        for (weight, z) in weights.iter().zip(&basis) {
            for (shape, z) in shape.iter_mut().zip(z) {
                *shape += weight * z;
            }
        }
        visit(
            stiffness.mode(eigen.eigenvalues[k], &shape, &mut next),
            &shape,
        );
    }
}

/// The mode in which errors of all constraints decay, if there are constraints.
fn of_constraints(mechanics: &dyn Linearized) -> Option<Mode> {
    mechanics.baumgarte_frequency().map(|w| Mode {
        stiffness: w * w,
        drag: 0.0,
        damping: 2.0 * w,
    })
}

/// The modes of a first-order system: one for each pair of eigenvalues of the Jacobian, by central
/// differences.
fn of_jacobian(system: &dyn ParticleSystem, t: f64, y: &[f64]) -> Vec<Mode> {
    let n = y.len();
    let mut jacobian = DMatrix::zeros(n, n);
    let (mut at, mut above, mut below) = (y.to_vec(), vec![0.0; n], vec![0.0; n]);
    for j in 0..n {
        let h = 1e-6 * y[j].abs().max(1.0);
        at[j] = y[j] + h;
        system.eval_f(t, &at, &mut above);
        at[j] = y[j] - h;
        system.eval_f(t, &at, &mut below);
        at[j] = y[j];
        for i in 0..n {
            jacobian[(i, j)] = (above[i] - below[i]) / (2.0 * h);
        }
    }
    if jacobian.iter().any(|a| !a.is_finite()) {
        return vec![];
    }
    let scale = jacobian.amax();
    jacobian
        .complex_eigenvalues()
        .iter()
        // What central differences cannot tell from zero.
        .map(|l| [l.re, l.im].map(|part| if part.abs() < 1e-9 * scale { 0.0 } else { part }))
        .filter(|[re, im]| *im >= 0.0 && (*re, *im) != (0.0, 0.0))
        .map(|[re, im]| Mode::of_eigenvalue(re, im))
        .collect()
}

/// The fastest mode of a run that goes on, by power iteration from the shape it had when last
/// asked.
#[derive(Clone, Debug, Default)]
pub struct LargestMode {
    shape: Vec<f64>,
}

impl LargestMode {
    /// The shape of the mode: displacements times the root of their mass, of length 1.
    #[must_use]
    pub fn shape(&self) -> &[f64] {
        &self.shape
    }

    /// The fastest mode around the positions x, or that of constraints if it is faster.
    ///
    /// It is found within 1 % the first time, by 24 products with the force differential. Later
    /// calls take 4 products, and are as close as the system has moved little since.
    #[must_use]
    pub fn estimate(&mut self, mechanics: &dyn Linearized, t: f64, x: &[f64]) -> Option<Mode> {
        let mut stiffness = Normalised::new(mechanics, t, x);
        let free = mechanics.inverse_masses();
        let known = self.shape.len() == x.len();
        if !known {
            self.shape = stiffness.any_shape();
        }
        // A particle may have been pinned since.
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
        let mode = stiffness.mode(largest, &self.shape, &mut next);
        let faster = of_constraints(mechanics).filter(|other| other.stiffness > mode.stiffness);
        faster.or(Some(mode))
    }
}
