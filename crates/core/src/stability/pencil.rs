//! Modes where damping mixes the shapes of the undamped motion. With mass-normalised stiffness K
//! and damping D, x'' = -K x - D x' has the eigenvalues of the quadratic pencil l^2 + l D + K. They
//! are those of the matrix [[0, w], [-K / w, -D]] of a first-order system, for any w > 0 (Tisseur,
//! Meerbergen, *The quadratic eigenvalue problem*, SIAM Review 43, 2001).

use nalgebra::{Complex, DMatrix, DVector};

use super::eigenvalues::eigenvalues;
use super::mode::{Mode, sort};
use super::normalised::Normalised;
use crate::random::SplitMix;
use crate::system::Linearized;

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
        finite.then_some(Self {
            stiffness,
            damping,
            unknowns,
            length: x.len(),
        })
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
        matrix
            .view_mut((n, 0), (n, n))
            .copy_from(&(&self.stiffness / -w));
        matrix.view_mut((n, n), (n, n)).copy_from(&-&self.damping);
        let found = eigenvalues(&matrix);
        let share = |stiffness: f64| {
            let distance = |mode: &Mode| (mode.stiffness - stiffness).abs();
            let nearest = undamped
                .iter()
                .min_by(|a, b| distance(a).total_cmp(&distance(b)));
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
                Mode {
                    drag: mode.drag - damping,
                    damping,
                    reads_velocity,
                    ..mode
                }
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
        let factors = matrix.lu();
        let mut random = SplitMix(3);
        let any = |_, _| Complex::new(random.between(-1.0, 1.0), 0.0);
        let mut shape = DVector::from_fn(self.unknowns.len(), any);
        for _ in 0..3 {
            shape = factors.solve(&shape)?.normalize();
        }
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
