//! Implicit stages of a mechanical system with masses M, drag C, damping D and stiffness K, solved
//! by Newton's method.
//!
//! For the guess (x, v) and base = (bx, bv), an iteration solves
//! A dv = M (bv - v) + a F(t, x, v) - a K g, with the gap g = bx + a v - x and
//! A = M + a (C + D) + a^2 K, and adds dv to v and dx = g + a dv to x. Pinned particles are put in
//! their places first and are filtered out of the equations (Baraff, Witkin, *Large Steps in Cloth
//! Simulation*, 1998).

use super::joined::{Joined, held, project};
use super::newton::{Changes, MAX_ITERATIONS, Newton, Secants, TOLERANCE, dot, norm};
use crate::error::Error;
use crate::integrators::sweep::add_scaled;
use crate::linear::Solver;
use crate::system::{Linearized, place_pins};
use crate::work::Work;

/// Largest number of iterations if contact acts, whose tangent is inexact.
const MAX_CONTACT_ITERATIONS: u32 = 150;
/// Relative change of the state that counts as negligible if contact acts and several in a row are
/// so small. Where a vertex is caught between forces that jump, as those of two surfaces at their
/// common edge, no force solves the equations, but the state has been found.
const SETTLED_TOLERANCE: f64 = 1e-6;
/// Number of such changes in a row at which the iteration ends.
const SETTLED_ITERATIONS: u32 = 6;
/// Largest power of the residual along a change after it, with the opposite sign, as a share of
/// that before it: a change that overshoots by more is shortened.
const MAX_OVERSHOOT: f64 = 0.5;
/// Largest number of times that a change is shortened.
const MAX_SHORTENINGS: u32 = 12;
/// Relative change of a position below which it counts as rounding error.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Change of the velocities in an iteration, over their change in the stage, that is negligible.
const NEGLIGIBLE_SHARE: f64 = 1e-8;

/// Solver of the implicit stages of a mechanical system, with its scratch.
pub(super) struct Mechanical {
    pub(super) solver: Solver,
    f: Vec<f64>,
    pub(super) rhs: Vec<f64>,
    /// Gap bx + a v - x (m).
    pub(super) gap: Vec<f64>,
    pub(super) dv: Vec<f64>,
    /// Change of x by an iteration (m).
    dx: Vec<f64>,
    /// Right-hand side at the beginning of an iteration.
    before: Vec<f64>,
    /// Corrections of the tangent, if it is inexact.
    secants: Secants,
    /// Whether the forces are known at the beginning of the next iteration.
    evaluated: bool,
    /// The constraints, if there are some.
    pub(super) joined: Option<Box<Joined>>,
}

impl Mechanical {
    pub(super) fn new(mechanics: &dyn Linearized) -> Self {
        let n = mechanics.inverse_masses().len();
        let zeros = || vec![0.0; 3 * n];
        let solver = Solver::new(mechanics);
        let joined = |held| Box::new(Joined::new(held, &solver.tangent));
        Self {
            joined: held(mechanics).map(joined),
            solver,
            f: zeros(),
            rhs: zeros(),
            gap: zeros(),
            dv: zeros(),
            dx: zeros(),
            before: zeros(),
            secants: Secants::new(if mechanics.hints().reach.is_finite() { 3 * n } else { 0 }),
            evaluated: false,
        }
    }

    pub(super) fn solve(
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
        let searches = newton != Newton::Once && mechanics.hints().reach.is_finite();
        let mut changes = Changes::new(!searches);
        let most = if searches { MAX_CONTACT_ITERATIONS } else { MAX_ITERATIONS };
        self.evaluated = false;
        self.secants.clear();
        if searches {
            // The guess of x, in which surfaces do not cross, determines v: it leaves no gap.
            for ((v, x), bx) in v.iter_mut().zip(&*x).zip(bx) {
                *v = (x - bx) / a;
            }
            place_pins(mechanics, t, x, v);
        }
        work += self.begin(mechanics, (t, a), [x, v]);
        let mut settled = 0;
        for iteration in 0..most {
            let assembles = searches || !changes.shrink_fast().unwrap_or(false);
            let how = (newton, assembles, changes.forcing());
            let (mut change, residual) =
                self.iterate(mechanics, t, a, [bx, bv], [x, v], how, &mut work)?;
            if searches {
                let share = self.search(mechanics, t, a, [bx, bv], [x, v], &mut work);
                self.secants.add(&self.dv, share, &self.before, &self.rhs);
                change *= share;
            }
            if newton == Newton::Once {
                project(mechanics, [x, v]);
                return Ok(work);
            }
            let size = norm(v) + norm(x) / a.abs();
            // Positions may be large, wherever the scene is: they count by their rounding alone.
            let none = NEGLIGIBLE_SHARE * distance(v, bv) + ROUNDING * size;
            changes.add(change, [size, none], residual);
            if changes.are_over(1e3 * TOLERANCE) {
                if newton == Newton::Full {
                    project(mechanics, [x, v]);
                }
                return Ok(work);
            }
            if !changes.are_finite() {
                break;
            }
            settled = if change <= SETTLED_TOLERANCE * size { settled + 1 } else { 0 };
            if searches && (settled == SETTLED_ITERATIONS || iteration + 1 == most && settled > 0) {
                return Ok(work);
            }
        }
        Err(changes.failure())
    }

    /// Makes one iteration of Newton's method. Returns the norm of the change of v, and the
    /// relative residual of the linear system.
    #[expect(clippy::too_many_arguments, reason = "the stage's equation has them")]
    pub(super) fn iterate(
        &mut self,
        mechanics: &dyn Linearized,
        t: f64,
        a: f64,
        [bx, bv]: [&[f64]; 2],
        [x, v]: [&mut [f64]; 2],
        (newton, assembles, forcing): (Newton, bool, f64),
        work: &mut Work,
    ) -> Result<(f64, f64), Error> {
        if !std::mem::take(&mut self.evaluated) {
            *work += self.evaluate(mechanics, t, a, bx, [x, v], newton);
        }
        let mut clamped = newton == Newton::Once;
        let mut assembles = assembles;
        let residual = loop {
            if assembles {
                let (cost, of_use) = self.assemble(mechanics, (t, a), x, clamped);
                *work += cost;
                if !of_use && !clamped {
                    clamped = true;
                    continue;
                }
                if !of_use {
                    return Err(Error::NoConvergence { residual: 1.0 });
                }
            }
            self.reduce(mechanics, a, bv, v);
            let tolerance = match newton {
                Newton::Full | Newton::Mirrored => forcing,
                // Short steps are solved more accurately, so that errors keep the method's order in
                // the step.
                Newton::Once => 1e-4 * self.solver.stiffness().clamp(1e-2, 1.0).powi(4),
            };
            self.before.copy_from_slice(&self.rhs);
            self.secants.reduce(&mut self.rhs);
            let (cost, solved) = self.solve_linear(mechanics, tolerance);
            self.secants.complete(&mut self.dv);
            *work += cost;
            match solved {
                Some(residual) => break residual,
                // Compressed springs can make the matrix indefinite. If they are clamped, Newton's
                // method converges more slowly.
                None if !clamped => (clamped, assembles) = (true, true),
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

    /// Shortens the change of an iteration if it overshot: until the power of the residual along
    /// the change, r . dv, is small against that at its beginning (Matthies, Strang, *The solution
    /// of nonlinear finite element equations*, 1979). Evaluates the forces at the end. Returns the
    /// remaining share of the change.
    pub(super) fn search(
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
        let longest = mechanics.hints().reach / spread(&self.dx);
        let mut share = longest.min(1.0);
        if share < 1.0 {
            add_scaled(x, share - 1.0, &self.dx);
            add_scaled(v, share - 1.0, &self.dv);
        }
        // Shares of the change with positive and with negative power, and the power there.
        let (mut low, mut high) = ((0.0, begin), (share, 0.0));
        for _ in 0..MAX_SHORTENINGS {
            *work += self.evaluate(mechanics, t, a, bx, [x, v], Newton::Full);
            self.evaluated = true;
            self.reduce(mechanics, a, bv, v);
            let power = dot(&self.rhs, &self.dv);
            if power.abs() <= MAX_OVERSHOOT * begin || share == high.0 && power > 0.0 {
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

    /// Evaluates the forces at (x, v), and the gap, which is set to zero if it is a rounding error
    /// everywhere. Returns the cost.
    pub(super) fn evaluate(
        &mut self,
        mechanics: &dyn Linearized,
        t: f64,
        a: f64,
        bx: &[f64],
        [x, v]: [&[f64]; 2],
        newton: Newton,
    ) -> Work {
        match held(mechanics) {
            Some(held) => held.free_forces(t, x, v, &mut self.f),
            None => mechanics.forces(t, x, v, &mut self.f),
        }
        let mut most: f64 = 0.0;
        for (((gap, bx), x), v) in self.gap.iter_mut().zip(bx).zip(x).zip(v) {
            *gap = bx + a * v - x;
            most = most.max(gap.abs() - ROUNDING * (bx.abs() + x.abs()));
        }
        // After an iteration the gap is zero up to rounding, which is not worth a product.
        if most <= 0.0 {
            self.gap.fill(0.0);
        }
        if let Some(joined) = &mut self.joined {
            // Pins are in their places.
            let inverse_masses = mechanics.inverse_masses();
            for column in self.gap.chunks_exact_mut(inverse_masses.len()) {
                let pinned = column.iter_mut().zip(inverse_masses);
                pinned.filter(|(_, w)| **w == 0.0).for_each(|(gap, _)| *gap = 0.0);
            }
            joined.evaluate(mechanics, (t, a), [bx, x, &self.gap], newton);
        }
        Work::of(1)
    }

    /// Writes M (bv - v) + a F - a K g for free particles to the right-hand side, with the K that
    /// was assembled last.
    pub(super) fn reduce(&mut self, mechanics: &dyn Linearized, a: f64, bv: &[f64], v: &[f64]) {
        let Self { solver, f, rhs, gap, joined, .. } = self;
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
        if let Some(joined) = joined {
            joined.add_impulses(gap, rhs);
        }
        solver.tangent.filter(rhs);
    }

    /// Estimates the impulses of constraints in the state (x, v). Returns the cost.
    pub(super) fn begin(
        &mut self,
        mechanics: &dyn Linearized,
        (t, a): (f64, f64),
        [x, v]: [&[f64]; 2],
    ) -> Work {
        let (Some(joined), Some(held)) = (&mut self.joined, held(mechanics)) else {
            return Work::default();
        };
        held.free_forces(t, x, v, &mut self.f);
        joined.begin(held, (t, a), [x, v], &self.f);
        Work::of(1)
    }

    /// Assembles the matrix at x, and factorises it if there are constraints. Returns the cost, and
    /// whether it is of use.
    pub(super) fn assemble(
        &mut self,
        mechanics: &dyn Linearized,
        (t, a): (f64, f64),
        x: &[f64],
        clamped: bool,
    ) -> (Work, bool) {
        let mut work = self.solver.assemble(mechanics, (t, a), x, clamped);
        let Some(joined) = &mut self.joined else {
            return (work, true);
        };
        let (cost, of_use) = joined.factorise(&mut self.solver, mechanics, (a, clamped));
        work += cost;
        (work, of_use)
    }

    /// Solves the linear system of an iteration. Returns the cost, and the relative residual;
    /// `None` if the matrix is not positive definite.
    pub(super) fn solve_linear(
        &mut self,
        mechanics: &dyn Linearized,
        tolerance: f64,
    ) -> (Work, Option<f64>) {
        match &mut self.joined {
            Some(joined) => {
                let work = joined.solve(mechanics, &self.rhs, &mut self.dv);
                (work, Some(0.0))
            }
            None => self.solver.solve(mechanics, &self.rhs, &mut self.dv, tolerance),
        }
    }
}

/// Returns the norm of the difference of two vectors.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
    squares.sum::<f64>().sqrt()
}

/// Returns the largest distance of a row of an n x 3 matrix from their mean.
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
