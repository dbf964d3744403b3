//! Modes of a small first-order system, or of one with constraints or rigid bodies: eigenvalues and
//! eigenvectors of its Jacobian.

use nalgebra::{Complex, DMatrix, DVector};

use super::eigenvalues::eigenvalues;
use super::mode::Mode;
use crate::random::SplitMix;
use crate::system::{ParticleSystem, reads_velocity, rigid_of};

/// Largest length of the state of a first-order system whose Jacobian is computed.
pub(super) const MAX_DENSE_LENGTH: usize = 300;
/// Real or imaginary part of an eigenvalue, over the largest entry of the Jacobian, that central
/// differences cannot tell from zero.
const ROUNDING: f64 = 1e-9;

/// Sum of a growing and a decaying real eigenvalue, over the latter, up to which they are of one
/// motion that falls: in a mechanical system the sum is its damping, in others it is rounding.
const OPPOSITE: f64 = 0.5;
const SAME: f64 = 1e-3;

/// Jacobian of a system, without the particles on rigid bodies.
#[derive(Clone)]
pub(super) struct Jacobian {
    matrix: DMatrix<f64>,
    /// Indices of its columns in the state, and the length of the state.
    unknowns: Vec<usize>,
    length: usize,
}

impl Jacobian {
    /// Creates the Jacobian at the state y at time t (s): the system's own, or central differences.
    /// `None` if the state is too long, or the Jacobian is not finite.
    pub fn of(system: &dyn ParticleSystem, t: f64, y: &[f64]) -> Option<Self> {
        let carried = |k: &usize| rigid_of(system).is_some_and(|rigid| rigid.is_carried(*k));
        let unknowns: Vec<usize> = (0..y.len()).filter(|k| !carried(k)).collect();
        if unknowns.len() > MAX_DENSE_LENGTH {
            return None;
        }
        let mut matrix = DMatrix::zeros(unknowns.len(), unknowns.len());
        let (mut at, mut above, mut below) = (y.to_vec(), vec![0.0; y.len()], vec![0.0; y.len()]);
        let mut exact = vec![0.0; y.len() * y.len()];
        let is_known = unknowns.len() == y.len() && system.jacobian(t, y, &mut exact);
        if is_known {
            matrix = DMatrix::from_row_slice(y.len(), y.len(), &exact);
        }
        for (column, &j) in unknowns.iter().enumerate().filter(|_| !is_known) {
            let h = 1e-6 * y[j].abs().max(1.0);
            at[j] = y[j] + h;
            system.eval_f(t, &at, &mut above);
            at[j] = y[j] - h;
            system.eval_f(t, &at, &mut below);
            at[j] = y[j];
            for (row, &i) in unknowns.iter().enumerate() {
                matrix[(row, column)] = (above[i] - below[i]) / (2.0 * h);
            }
        }
        let finite = matrix.iter().all(|a| a.is_finite());
        finite.then_some(Self {
            matrix,
            unknowns,
            length: y.len(),
        })
    }

    /// Returns the modes of the system: one for each real eigenvalue and each conjugate pair. The
    /// Jacobian does not distinguish drag from other damping: all damping counts as that of springs
    /// if kicks depend on v, else as drag.
    pub fn modes(&self, system: &dyn ParticleSystem) -> Vec<Mode> {
        let scale = self.matrix.amax();
        let is_mechanical = rigid_of(system).is_some() || system.mechanics().is_some();
        let reads_velocity = is_mechanical && reads_velocity(system);
        let part = |a: f64| if a.abs() < ROUNDING * scale { 0.0 } else { a };
        let found = eigenvalues(&self.matrix).into_iter();
        let found = found.map(|l| [part(l.re), part(l.im)]);
        let (real, pairs): (Vec<_>, Vec<_>) = found
            .filter(|l| *l != [0.0, 0.0])
            .partition(|[_, im]| *im == 0.0);
        let (growing, mut decaying): (Vec<_>, Vec<_>) =
            real.into_iter().map(|[re, _]| re).partition(|re| *re > 0.0);
        let mut modes: Vec<_> = (pairs.into_iter().filter(|[_, im]| *im > 0.0))
            .map(|[re, im]| Mode::of_eigenvalue(re, im))
            .collect();
        let most = if is_mechanical { OPPOSITE } else { SAME };
        modes.extend(growing.into_iter().map(|l| fall(l, &mut decaying, most)));
        modes.extend(decaying.into_iter().map(|l| Mode::of_eigenvalue(l, 0.0)));
        for mode in &mut modes {
            mode.reads_velocity = reads_velocity;
            if reads_velocity {
                (mode.drag, mode.damping) = (0.0, mode.drag);
            }
        }
        modes
    }

    /// Returns the change of the state in a mode at one moment, by inverse iteration; its size is
    /// of no meaning.
    pub fn shape(&self, mode: &Mode) -> Option<Vec<f64>> {
        let [re, im] = mode.eigenvalues()[0];
        let l = Complex::new(re, im) * (1.0 + 1e-9);
        let mut matrix = self.matrix.map(|a| Complex::new(a, 0.0));
        for k in 0..self.unknowns.len() {
            matrix[(k, k)] -= l;
        }
        let factors = matrix.lu();
        let mut random = SplitMix(3);
        let any = |_, _| Complex::new(random.between(-1.0, 1.0), 0.0);
        let mut shape = DVector::from_fn(self.unknowns.len(), any);
        for _ in 0..3 {
            shape = factors.solve(&shape)?.normalize();
        }
        let mut whole = vec![0.0; self.length];
        for (k, z) in self.unknowns.iter().zip(&shape) {
            whole[*k] = z.re;
        }
        whole.iter().all(|z| z.is_finite()).then_some(whole)
    }
}

/// Returns the mode of a growing real eigenvalue (1/s). The nearest opposite eigenvalue is taken
/// out of `decaying` if the sum of both is at most the share `most` of its size. Then both are of
/// one motion that falls, as the roots of s^2 + d s = k are, with damping d and k > 0.
fn fall(growing: f64, decaying: &mut Vec<f64>, most: f64) -> Mode {
    let near = |l: &f64| (l + growing).abs();
    let nearest = (0..decaying.len()).min_by(|a, b| {
        let [a, b] = [a, b].map(|k| near(&decaying[*k]));
        a.total_cmp(&b)
    });
    match nearest.filter(|k| near(&decaying[*k]) < most * decaying[*k].abs()) {
        Some(k) => {
            let other = decaying.remove(k);
            Mode {
                stiffness: growing * other,
                drag: -(growing + other),
                ..Mode::default()
            }
        }
        None => Mode::of_eigenvalue(growing, 0.0),
    }
}
