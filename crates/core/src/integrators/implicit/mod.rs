//! The equation of an implicit stage, y = base + a f(t, y), solved by Newton's method from a guess.
//!
//! For a mechanical system with the guess (x, v) and A = M + a (C + D) + a2 K: it is A dv = M (bv -
//! v) + a F(t, x, v) - a K (bx + a v - x), dx = bx + a v - x + a dv. Particles that are pinned are
//! put in their places before, and filtered (Baraff and Witkin, *Large Steps in Cloth Simulation*,
//! 1998). The Jacobian of any other system is taken by central differences, and eliminated.

mod dense;
mod euler;
mod midpoint;
mod tr_bdf2;

use crate::error::Error;
use crate::linear::Solver;
use crate::system::{Linearized, Mechanics, ParticleSystem, place_pins};
use dense::Dense;

pub(super) use euler::METHOD as EULER;
pub(super) use midpoint::METHOD as MIDPOINT;
pub(super) use tr_bdf2::METHOD as TR_BDF2;

use super::Work;

/// Largest number of iterations of Newton's method.
const MOST: u32 = 30;
/// Last change at which the iteration ends, relative to the state: the next would be lost in
/// rounding.
const CLOSE: f64 = 1e-11;
/// Relative residual to which its linear systems are solved.
const FORCING: f64 = 1e-5;

/// Number of iterations of Newton's method.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Newton {
    /// One iteration, with compressed springs clamped.
    Once,
    /// As many as it takes until nothing changes any more.
    Full,
}

/// Solver of the stages of one system.
enum Stage {
    Mechanical(Box<Mechanical>),
    Dense(Dense),
}

impl Stage {
    fn new(system: &dyn ParticleSystem) -> Self {
        match system.mechanics().and_then(Mechanics::linearized) {
            Some(linearized) => Self::Mechanical(Box::new(Mechanical::new(linearized))),
            None => Self::Dense(Dense::new(system.dim())),
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

/// Puts pins where they are at time t, if the system has any.
fn place(system: &dyn ParticleSystem, t: f64, y: &mut [f64]) {
    if let Some(mechanics) = system.mechanics() {
        let (x, v) = y.split_at_mut(y.len() / 2);
        place_pins(mechanics, t, x, v);
    }
}

struct Mechanical {
    solver: Solver,
    f: Vec<f64>,
    rhs: Vec<f64>,
    /// The gap bx + a v - x (m).
    gap: Vec<f64>,
    dv: Vec<f64>,
}

impl Mechanical {
    fn new(mechanics: &dyn Linearized) -> Self {
        let zeros = || vec![0.0; 3 * mechanics.inverse_masses().len()];
        Self {
            solver: Solver::new(mechanics),
            f: zeros(),
            rhs: zeros(),
            gap: zeros(),
            dv: zeros(),
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
        let (mut first, mut last) = (f64::NAN, f64::INFINITY);
        for iteration in 0..MOST {
            let change = self.iterate(mechanics, t, a, [bx, bv], [x, v], newton, &mut work)?;
            if newton == Newton::Once {
                return Ok(work);
            }
            if iteration == 0 {
                first = change;
            }
            let size = norm(v) + norm(x) / a.abs();
            if change <= CLOSE * size || (change <= 1e3 * CLOSE * size && change >= 0.5 * last) {
                return Ok(work);
            }
            last = change;
            if !change.is_finite() {
                break;
            }
        }
        Err(Error::NoConvergence {
            residual: last / first,
        })
    }

    /// One iteration of Newton's method. Returns the norm of the change of v.
    #[expect(clippy::too_many_arguments, reason = "the stage's equation has them")]
    fn iterate(
        &mut self,
        mechanics: &dyn Linearized,
        t: f64,
        a: f64,
        [bx, bv]: [&[f64]; 2],
        [x, v]: [&mut [f64]; 2],
        newton: Newton,
        work: &mut Work,
    ) -> Result<f64, Error> {
        let Self {
            solver,
            f,
            rhs,
            gap,
            dv,
        } = self;
        mechanics.forces(t, x, v, f);
        *work += Work::of(1);
        for (((gap, bx), x), v) in gap.iter_mut().zip(bx).zip(&*x).zip(&*v) {
            *gap = bx + a * v - x;
        }
        let mut clamped = newton == Newton::Once;
        loop {
            *work += solver.gather(mechanics, x, a, clamped);
            solver.tangent.filter(gap);
            let inverse_masses = mechanics.inverse_masses();
            let n = inverse_masses.len();
            for (k, rhs) in rhs.iter_mut().enumerate() {
                let w = inverse_masses[k % n];
                *rhs = if w == 0.0 {
                    0.0
                } else {
                    (bv[k] - v[k]) / w + a * f[k]
                };
            }
            solver.tangent.subtract_stiffness(a, gap, rhs);
            solver.tangent.filter(rhs);
            let tolerance = match newton {
                Newton::Full => FORCING,
                // Small steps are solved closely, so that errors fall with the step as they should.
                Newton::Once => 1e-4 * solver.stiffness().clamp(1e-2, 1.0).powi(4),
            };
            let (cost, solved) = solver.solve(mechanics, rhs, dv, tolerance);
            *work += cost;
            match solved {
                Some(_) => break,
                // What is compressed makes the matrix indefinite: without it Newton's method
                // converges more slowly.
                None if !clamped => clamped = true,
                None => return Err(Error::NoConvergence { residual: 1.0 }),
            }
        }
        for ((((x, v), gap), dv), _) in x.iter_mut().zip(v.iter_mut()).zip(&*gap).zip(&*dv).zip(bx)
        {
            *x += gap + a * dv;
            *v += dv;
        }
        Ok(norm(dv))
    }
}

fn norm(a: &[f64]) -> f64 {
    a.iter().map(|a| a * a).sum::<f64>().sqrt()
}
