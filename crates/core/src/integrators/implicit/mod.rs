//! Implicit stages y = base + a f(t, y), solved by Newton's method from a guess.
//!
//! In a mechanical system with masses M, drag C, damping D and stiffness K, the guess (x, v) and
//! base = (bx, bv), an iteration solves
//! A dv = M (bv - v) + a F(t, x, v) - a K g, with the gap g = bx + a v - x and
//! A = M + a (C + D) + a^2 K, and adds dv to v and dx = g + a dv to x. Pinned particles are put in
//! their places first and are filtered out of the equations (Baraff, Witkin, *Large Steps in Cloth
//! Simulation*, 1998). For any other system, the Jacobian is computed by central differences and
//! the equations are solved by elimination.

mod bdf;
mod changes;
mod dense;
mod differences;
mod euler;
mod formulas;
mod kept;
mod midpoint;
mod secants;
mod tr_bdf2;

use crate::error::Error;
use crate::linear::Solver;
use crate::system::{Linearized, Mechanics, ParticleSystem, place_pins};
use changes::{CLOSE, Changes};
use dense::Dense;
use secants::Secants;

pub(super) use bdf::METHOD as BDF;
pub(super) use euler::METHOD as EULER;
pub use formulas::bdf_growth;
pub(super) use midpoint::METHOD as MIDPOINT;
pub(super) use tr_bdf2::METHOD as TR_BDF2;

use super::{Work, add_scaled};

/// Largest number of iterations of Newton's method.
const MOST: u32 = 30;
/// Most iterations where contact acts, whose tangent is not exact.
const MOST_IN_CONTACT: u32 = 150;
/// Change relative to the state that counts as none where contact acts, if several in a row are so
/// small: where a vertex is caught between forces that jump, as those of two surfaces do where they
/// meet, no force solves the equations, but the state is found.
const SETTLED: f64 = 1e-6;
/// Number of such changes in a row at which the iteration ends.
const STAYS: u32 = 6;
/// Share of the power of the residual along a change that may be left, with the other sign, after
/// it: a change that overshoots by more is shortened.
const OVERSHOT: f64 = 0.5;
/// Most times that a change is shortened.
const SHORTENED: u32 = 12;
/// Gap relative to positions that is rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// `Ok` if implicit methods support this system.
///
/// # Errors
/// The system has no forces and masses, and is too large for the Jacobian of its f.
pub(super) fn check(system: &dyn ParticleSystem) -> Result<(), Error> {
    let linearized = system.mechanics().and_then(Mechanics::linearized);
    let count = linearized.map_or_else(|| dense::unknowns(system).len(), |_| 0);
    if count > dense::LARGEST {
        return Err(Error::Invalid(format!(
            "implicit methods serve rigid bodies and systems without masses up to a state of {} \
             numbers, and this has {count}: use an explicit solver",
            dense::LARGEST,
        )));
    }
    Ok(())
}

/// Number of iterations of Newton's method.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Newton {
    /// One iteration, with compressed springs clamped.
    Once,
    /// Iterations until the state no longer changes.
    Full,
}

/// Solver of the implicit stages of one system.
enum StageSolver {
    /// Solver for a linearised mechanical system.
    Mechanical(Box<Mechanical>),
    /// Solver for any other system, of a small dimension.
    Dense(Box<Dense>),
}

impl StageSolver {
    fn new(system: &dyn ParticleSystem) -> Self {
        match system.mechanics().and_then(Mechanics::linearized) {
            Some(linearized) => Self::Mechanical(Box::new(Mechanical::new(linearized))),
            None => Self::Dense(Box::new(Dense::new(system))),
        }
    }

    /// Takes y from a guess to the solution of y = base + a f(t, y).
    fn solve(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        a: f64,
        base: &[f64],
        y: &mut [f64],
        newton: Newton,
    ) -> Result<Work, Error> {
        match (self, system.mechanics().and_then(Mechanics::linearized)) {
            (Self::Mechanical(stage), Some(linearized)) => {
                stage.solve(linearized, t, a, base, y, newton)
            }
            (Self::Dense(stage), _) => stage.solve(system, t, a, base, y, newton),
            (Self::Mechanical(_), None) => Err(Error::NeedsMechanics { method: "implicit" }),
        }
    }
}

/// Solver of the implicit stages of a mechanical system, with its scratch.
struct Mechanical {
    solver: Solver,
    f: Vec<f64>,
    rhs: Vec<f64>,
    /// Gap bx + a v - x (m).
    gap: Vec<f64>,
    dv: Vec<f64>,
    /// Change of x by an iteration (m).
    dx: Vec<f64>,
    /// Right-hand side at the beginning of an iteration.
    before: Vec<f64>,
    /// Corrections of the tangent, where it is not exact.
    secants: Secants,
    /// Whether the forces were evaluated where the next iteration begins.
    evaluated: bool,
}

impl Mechanical {
    fn new(mechanics: &dyn Linearized) -> Self {
        let n = mechanics.inverse_masses().len();
        let zeros = || vec![0.0; 3 * n];
        Self {
            solver: Solver::new(mechanics),
            f: zeros(),
            rhs: zeros(),
            gap: zeros(),
            dv: zeros(),
            dx: zeros(),
            before: zeros(),
            secants: Secants::new(if mechanics.reach().is_finite() {
                3 * n
            } else {
                0
            }),
            evaluated: false,
        }
    }

    fn solve(
        &mut self,
        mechanics: &dyn Linearized,
        t: f64,
        a: f64,
        base: &[f64],
        y: &mut [f64],
        newton: Newton,
    ) -> Result<Work, Error> {
        let (bx, bv) = base.split_at(base.len() / 2);
        let (x, v) = y.split_at_mut(bx.len());
        place_pins(mechanics, t, x, v);
        let mut work = Work::default();
        let searches = newton == Newton::Full && mechanics.reach().is_finite();
        let mut changes = Changes::new(!searches);
        let most = if searches { MOST_IN_CONTACT } else { MOST };
        self.evaluated = false;
        self.secants.clear();
        if searches {
            // The guess of x counts, where nothing has passed through anything: no gap is left.
            for ((v, x), bx) in v.iter_mut().zip(&*x).zip(bx) {
                *v = (x - bx) / a;
            }
            place_pins(mechanics, t, x, v);
        }
        let mut settled = 0;
        for iteration in 0..most {
            let gathers = searches || !changes.shrink_fast().unwrap_or(false);
            let how = (newton, gathers, changes.forcing());
            let (mut change, residual) =
                self.iterate(mechanics, t, a, [bx, bv], [x, v], how, &mut work)?;
            if searches {
                let share = self.search(mechanics, t, a, [bx, bv], [x, v], &mut work);
                self.secants.add(&self.dv, share, &self.before, &self.rhs);
                change *= share;
            }
            if newton == Newton::Once {
                return Ok(work);
            }
            let size = norm(v) + norm(x) / a.abs();
            changes.add(change, size, residual);
            if changes.are_over(1e3 * CLOSE) {
                return Ok(work);
            }
            if !changes.are_finite() {
                break;
            }
            settled = if change <= SETTLED * size {
                settled + 1
            } else {
                0
            };
            if searches && (settled == STAYS || iteration + 1 == most && settled > 0) {
                return Ok(work);
            }
        }
        Err(changes.failure())
    }

    /// One iteration of Newton's method. Returns the norm of the change of v, and the relative
    /// residual to which the linear system was solved.
    #[expect(clippy::too_many_arguments, reason = "the stage's equation has them")]
    fn iterate(
        &mut self,
        mechanics: &dyn Linearized,
        t: f64,
        a: f64,
        [bx, bv]: [&[f64]; 2],
        [x, v]: [&mut [f64]; 2],
        (newton, gathers, forcing): (Newton, bool, f64),
        work: &mut Work,
    ) -> Result<(f64, f64), Error> {
        if !std::mem::take(&mut self.evaluated) {
            *work += self.evaluate(mechanics, t, a, bx, [x, v]);
        }
        let mut clamped = newton == Newton::Once;
        let mut gathers = gathers;
        let residual = loop {
            if gathers {
                *work += self.solver.gather(mechanics, (t, a), x, clamped);
            }
            self.reduce(mechanics, a, bv, v);
            let tolerance = match newton {
                Newton::Full => forcing,
                // Short steps are solved more closely, so that errors fall with the step to the
                // method's order.
                Newton::Once => 1e-4 * self.solver.stiffness().clamp(1e-2, 1.0).powi(4),
            };
            self.before.copy_from_slice(&self.rhs);
            self.secants.reduce(&mut self.rhs);
            let (cost, solved) = self
                .solver
                .solve(mechanics, &self.rhs, &mut self.dv, tolerance);
            self.secants.complete(&mut self.dv);
            *work += cost;
            match solved {
                Some(residual) => break residual,
                // Compressed springs can make the matrix indefinite. With these clamped, Newton's
                // method converges more slowly.
                None if !clamped => (clamped, gathers) = (true, true),
                None => return Err(Error::NoConvergence { residual: 1.0 }),
            }
        };
        let changes = self.gap.iter().zip(&self.dv);
        for ((x, v), (gap, dv)) in x.iter_mut().zip(v.iter_mut()).zip(changes) {
            *x += gap + a * dv;
            *v += dv;
        }
        Ok((norm(&self.dv), residual))
    }

    /// Takes back a share of the change that an iteration made, if it overshot: until the power of
    /// the residual along the change, r . dv, is small enough against that at its beginning
    /// (Matthies, Strang, *The solution of nonlinear finite element equations*, 1979). Evaluates
    /// the forces where it ends. Returns the share of the change that is left.
    fn search(
        &mut self,
        mechanics: &dyn Linearized,
        t: f64,
        a: f64,
        [bx, bv]: [&[f64]; 2],
        [x, v]: [&mut [f64]; 2],
        work: &mut Work,
    ) -> f64 {
        self.dx.copy_from_slice(&self.gap);
        add_scaled(&mut self.dx, a, &self.dv);
        let begin = dot(&self.before, &self.dv);
        let longest = mechanics.reach() / spread(&self.dx);
        let mut share = longest.min(1.0);
        if share < 1.0 {
            add_scaled(x, share - 1.0, &self.dx);
            add_scaled(v, share - 1.0, &self.dv);
        }
        // Shares of the change with the powers there: positive, and negative.
        let (mut low, mut high) = ((0.0, begin), (share, 0.0));
        for _ in 0..SHORTENED {
            *work += self.evaluate(mechanics, t, a, bx, [x, v]);
            self.evaluated = true;
            self.reduce(mechanics, a, bv, v);
            let power = dot(&self.rhs, &self.dv);
            if power.abs() <= OVERSHOT * begin || share == high.0 && power > 0.0 {
                break;
            }
            if power > 0.0 {
                low = (share, power);
            } else {
                high = (share, power.max(f64::MIN));
            }
            let part = (low.1 / (low.1 - high.1)).clamp(0.1, 0.9);
            let next = low.0 + (high.0 - low.0) * part;
            add_scaled(x, next - share, &self.dx);
            add_scaled(v, next - share, &self.dv);
            share = next;
            self.evaluated = false;
        }
        share
    }

    /// Evaluates the forces at (x, v), and the gap: none where it is rounding everywhere. Returns
    /// the cost.
    fn evaluate(
        &mut self,
        mechanics: &dyn Linearized,
        t: f64,
        a: f64,
        bx: &[f64],
        [x, v]: [&[f64]; 2],
    ) -> Work {
        mechanics.forces(t, x, v, &mut self.f);
        let mut most: f64 = 0.0;
        for (((gap, bx), x), v) in self.gap.iter_mut().zip(bx).zip(x).zip(v) {
            *gap = bx + a * v - x;
            most = most.max(gap.abs() - ROUNDING * (bx.abs() + x.abs()));
        }
        // After an iteration there is no gap: its rounding is not worth a product.
        if most <= 0.0 {
            self.gap.fill(0.0);
        }
        Work::of(1)
    }

    /// Writes M (bv - v) + a F - a K g for free particles to the right-hand side, with the K that
    /// was gathered last.
    fn reduce(&mut self, mechanics: &dyn Linearized, a: f64, bv: &[f64], v: &[f64]) {
        let Self {
            solver,
            f,
            rhs,
            gap,
            ..
        } = self;
        solver.tangent.filter(gap);
        let inverse_masses = mechanics.inverse_masses();
        let n = inverse_masses.len();
        for start in (0..rhs.len()).step_by(n) {
            let column = start..start + n;
            let [bv, v, f] = [bv, v, f].map(|a| &a[column.clone()]);
            let rhs = &mut rhs[column];
            for ((((rhs, bv), v), f), w) in rhs.iter_mut().zip(bv).zip(v).zip(f).zip(inverse_masses)
            {
                *rhs = if *w == 0.0 { 0.0 } else { (bv - v) / w + a * f };
            }
        }
        if gap.iter().any(|gap| *gap != 0.0) {
            solver.tangent.subtract_stiffness(mechanics, a, gap, rhs);
        }
        solver.tangent.filter(rhs);
    }
}

/// Most by which a row of an n x 3 matrix differs from their mean.
fn spread(a: &[f64]) -> f64 {
    let n = a.len() / 3;
    let columns = [0, 1, 2].map(|axis| &a[axis * n..(axis + 1) * n]);
    let means = columns.map(|column| column.iter().sum::<f64>() / n as f64);
    let square = |i: usize| -> f64 {
        let parts = columns.iter().zip(means);
        parts.map(|(column, mean)| (column[i] - mean).powi(2)).sum()
    };
    (0..n).map(square).fold(0.0, f64::max).sqrt()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
