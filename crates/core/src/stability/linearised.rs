//! Largest step of a method on a whole linearised system, found by taking steps. Splitting methods
//! handle drag in drifts and the damping of springs in kicks: if damping mixes shapes, their steps
//! do not keep modes separate, and eigenvalues of the motion do not tell how modes grow.
//!
//! Modes of a small first-order system, or of one with constraints or rigid bodies: eigenvalues and
//! eigenvectors of its Jacobian.

use nalgebra::{Complex, DMatrix, Vector3};

use super::eigenvalues::{eigenvalues, kernel};
use super::limit::{GROWTH, tenfold_time};
use super::mode::Mode;
use crate::columns::columns_mut;
use crate::coupling::Coupling;
use crate::elements::flow_each;
use crate::error::Error;
use crate::failure::succeeded;
use crate::integrators::{Integrator, Method};
use crate::path::Place;
use crate::random::SplitMix;
use crate::system::{
    Linearized, Mechanics, ParticleSystem, Splitting, kick_reads_velocity, place_pins,
    reads_velocity, rigid_of, size,
};

/// Numbers of steps after which growth is measured; a step fails if it shows after both.
const STEP_COUNTS: [usize; 2] = [1000, 4000];
/// Number of steps in each of two intervals, at the middle and at the end, whose largest states are
/// compared.
const COMPARED_STEPS: usize = 100;
/// Length of x from which a system counts as large.
const MIN_LARGE_LENGTH: usize = 300;
/// Number of steps between two checks outside these intervals.
const CHECK_STRIDE: usize = 20;
/// Growth between both intervals above which the state grows; less may be oscillation.
const MIN_GROWTH: f64 = 1.5;
/// Growth since the beginning at which the steps end: no oscillation is so large.
const MAX_GROWTH: f64 = 1e8;
/// Ratio of consecutive trial steps: methods of several kicks may fail in a narrow interval of
/// steps and hold again.
const STEP_RATIO: f64 = 1.04;
/// First and last trial step over the expected limit.
const GUESS_RANGE: [f64; 2] = [0.25, 32.0];
/// Ratio of two steps that both have to fail at a limit: a narrower interval is a resonance, which
/// no run meets exactly.
const MIN_INTERVAL_RATIO: f64 = 1.005;
/// First trial step in a large system, whose steps are expensive, over the expected limit.
const LARGE_START: f64 = 0.98;
/// Relative precision of the limit.
const PRECISION: f64 = 2e-3;

/// Mechanical system linearised about positions at which it rests.
pub(super) struct AtRest<'a> {
    mechanics: &'a dyn Linearized,
    x: &'a [f64],
    zero: Vec<f64>,
}

impl<'a> AtRest<'a> {
    pub fn new(mechanics: &'a dyn Linearized, x: &'a [f64]) -> Self {
        Self { mechanics, x, zero: vec![0.0; x.len()] }
    }

    /// Finds the largest step of a method, searched from an expected one (s). The fastest motion
    /// has the angular frequency `fastest` (rad/s). Infinite if no trial step fails. `None` if the
    /// shortest one fails too: then the motion grows by itself.
    ///
    /// # Errors
    /// The method does not support the system.
    pub fn largest_step(
        &self,
        method: &Method,
        guess: f64,
        fastest: f64,
    ) -> Result<Option<f64>, Error> {
        let mut integrator = method.integrator(self)?;
        // A slow oscillation may look like growth after fewer steps, but not after more.
        let mut grows = |h: f64| {
            for steps in STEP_COUNTS {
                let growth = self.growth(&mut *integrator, (h, steps), fastest)?;
                let grows = growth.ln() * tenfold_time(h) > h * GROWTH.ln();
                if !grows {
                    return Ok(false);
                }
            }
            Ok::<_, Error>(true)
        };
        longest_that_holds(guess, self.x.len() > MIN_LARGE_LENGTH, &mut grows)
    }

    /// Returns the growth per step of h (s) of the root of the energy, after `steps` steps from a
    /// random state that contains all motion: at least 1, infinite if a step fails.
    ///
    /// # Errors
    /// A callback failed.
    fn growth(
        &self,
        integrator: &mut dyn Integrator,
        (h, steps): (f64, usize),
        fastest: f64,
    ) -> Result<f64, Error> {
        let w = self.mechanics.inverse_masses();
        let n = self.x.len();
        let mut random = SplitMix(6);
        let mut y: Vec<_> = (0..2 * n)
            .map(|k| {
                let size = w[k % w.len()].sqrt() / if k < n { fastest } else { 1.0 };
                size * random.between(-1.0, 1.0)
            })
            .collect();
        let mut scratch = vec![0.0; n];
        let begun = self.size(&y, &mut scratch).ln();
        // Logarithms of the factors by which the state was divided, and of its largest sizes.
        let (mut scaled, mut largest) = (0.0, [f64::NEG_INFINITY; 2]);
        for k in 1..=steps {
            if !succeeded(integrator.step(self, 0.0, h, &mut y))? {
                return Ok(f64::INFINITY);
            }
            let ends = [steps / 2, steps].map(|end| k + COMPARED_STEPS > end && k <= end);
            if k % CHECK_STRIDE != 0 && !ends.contains(&true) {
                continue;
            }
            let now = self.size(&y, &mut scratch);
            if !now.is_finite() {
                return Ok(f64::INFINITY);
            }
            if now == 0.0 {
                return Ok(1.0);
            }
            let grown = scaled + now.ln() - begun;
            if grown > MAX_GROWTH.ln() {
                return Ok((grown / k as f64).exp());
            }
            for (largest, seen) in largest.iter_mut().zip(ends) {
                if seen {
                    *largest = largest.max(grown);
                }
            }
            if !(1e-50..1e50).contains(&now) {
                scaled += now.ln();
                for y in &mut y {
                    *y /= now;
                }
            }
        }
        let grown = largest[1] - largest[0];
        if grown < MIN_GROWTH.ln() {
            return Ok(1.0);
        }
        Ok((grown / (steps / 2) as f64).exp())
    }

    /// Returns the root of twice the energy of a state (J^1/2). Slow motion does not increase it,
    /// however far it goes.
    fn size(&self, y: &[f64], scratch: &mut [f64]) -> f64 {
        let w = self.mechanics.inverse_masses();
        let (dx, dv) = y.split_at(self.x.len());
        self.force_differential(0.0, self.x, &self.zero, dx, &self.zero, scratch);
        let parts = dx.iter().zip(dv).zip(scratch).enumerate();
        let parts = parts.map(|(k, ((dx, dv), df))| match w[k % w.len()] {
            0.0 => 0.0,
            w => dv * dv / w - dx * *df,
        });
        parts.sum::<f64>().abs().sqrt()
    }
}

/// Finds the longest step (s) below which no trial step grows, near an expected one; `grows` tells
/// whether a step does. A `large` system, whose steps are expensive, is tried closely about the
/// expected one. Infinite if no trial step fails. `None` if the shortest one fails too: then the
/// motion grows by itself.
pub(super) fn longest_that_holds(
    guess: f64,
    large: bool,
    grows: &mut dyn FnMut(f64) -> Result<bool, Error>,
) -> Result<Option<f64>, Error> {
    let mut fails = |h: f64| Ok::<_, Error>(grows(h)? && grows(MIN_INTERVAL_RATIO * h)?);
    let longest = GUESS_RANGE[1] * guess;
    let mut low = if large { LARGE_START } else { GUESS_RANGE[0] } * guess;
    while fails(low)? {
        low *= if large { 1.0 / STEP_RATIO } else { GUESS_RANGE[0] };
        if low < 1e-4 * guess {
            return Ok(None);
        }
    }
    let mut high = low * STEP_RATIO;
    while !fails(high)? {
        (low, high) = (high, high * STEP_RATIO);
        if low > longest {
            return Ok(Some(f64::INFINITY));
        }
    }
    if large && (low..high).contains(&guess) {
        return Ok(Some(guess));
    }
    while high > (1.0 + PRECISION) * low {
        let middle = (low * high).sqrt();
        *(if fails(middle)? { &mut high } else { &mut low }) = middle;
    }
    Ok(Some(low))
}

impl Mechanics for AtRest<'_> {
    fn inverse_masses(&self) -> &[f64] {
        self.mechanics.inverse_masses()
    }

    fn forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        self.force_differential(t, self.x, &self.zero, x, v, f);
    }

    fn drag_coefficient(&self) -> f64 {
        self.mechanics.drag_coefficient()
    }

    fn pins(&self, _t: f64, visit: &mut dyn FnMut(usize, Place)) {
        for (k, w) in self.inverse_masses().iter().enumerate() {
            if *w == 0.0 {
                visit(k, Place::still(Vector3::zeros()));
            }
        }
    }

    fn splitting(&self) -> Option<&dyn Splitting> {
        Some(self)
    }

    fn linearized(&self) -> Option<&dyn Linearized> {
        Some(self)
    }
}

impl Splitting for AtRest<'_> {
    fn kick_forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        let drag = self.drag_coefficient();
        self.forces(t, x, v, f);
        for (f, v) in f.iter_mut().zip(v) {
            *f += drag * v;
        }
    }

    fn kick_reads_velocity(&self) -> bool {
        kick_reads_velocity(self.mechanics)
    }

    fn drift(&self, t: f64, h: f64, x: &mut [f64], v: &mut [f64]) {
        let (drag, w) = (self.drag_coefficient(), self.inverse_masses());
        flow_each(drag, Vector3::zeros(), w, h, columns_mut(x), columns_mut(v));
        place_pins(self, t + h, x, v);
    }
}

impl Linearized for AtRest<'_> {
    fn force_differential(
        &self,
        t: f64,
        _x: &[f64],
        _v: &[f64],
        dx: &[f64],
        dv: &[f64],
        df: &mut [f64],
    ) {
        self.mechanics.force_differential(t, self.x, &self.zero, dx, dv, df);
    }

    fn couplings(&self, t: f64, _x: &[f64], clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        self.mechanics.couplings(t, self.x, clamped, visit);
    }
}

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
pub(super) struct StateJacobian {
    matrix: DMatrix<f64>,
    /// Indices of its columns in the state, and the length of the state.
    unknowns: Vec<usize>,
    length: usize,
}

impl StateJacobian {
    /// Creates the Jacobian at the state y at time t (s): the system's own, or central differences.
    /// `None` if the state is too long, the system has a mass matrix, or the Jacobian is not
    /// finite.
    pub fn of(system: &dyn ParticleSystem, t: f64, y: &[f64]) -> Option<Self> {
        let carried = |k: &usize| rigid_of(system).is_some_and(|rigid| rigid.is_carried(*k));
        let unknowns: Vec<usize> = (0..y.len()).filter(|k| !carried(k)).collect();
        if unknowns.len() > MAX_DENSE_LENGTH || !system.mass_matrix().is_empty() {
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
            let h = 1e-6 * size(system, j, y[j]);
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
        finite.then_some(Self { matrix, unknowns, length: y.len() })
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
        let (real, pairs): (Vec<_>, Vec<_>) =
            found.filter(|l| *l != [0.0, 0.0]).partition(|[_, im]| *im == 0.0);
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
        let shape = kernel(matrix)?;
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
            Mode { stiffness: growing * other, drag: -(growing + other), ..Mode::default() }
        }
        None => Mode::of_eigenvalue(growing, 0.0),
    }
}
