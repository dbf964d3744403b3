//! Verlet's method with implicit damping: half a step of the exact flow under drag and gravity, the
//! flow of v' = F(t + h/2, x, v) / M at fixed x for a whole step, and half a step of the first flow
//! again (Strang, *On the construction and comparison of difference schemes*, 1968).
//!
//! Where F does not depend on v, its flow is the kick of [`VERLET_PLAN`], and so is the
//! step. Otherwise a Rosenbrock method takes the step of that flow. With the damping C = -dF/dv,
//! A = M + g h C and g = 1 - 1/sqrt 2:
//!
//! ```text
//! A k1 = F(x, v)      A k2 = F(x, v + h k1) - 2 M k1      v1 = v + h (3/2 k1 + 1/2 k2)
//! ```
//!
//! It is L-stable for this g, and has order 2 for any matrix in the place of C, so that a part of
//! dF/dv which is not known, or not symmetric, may be left out (Verwer, Spee, Blom, Hundsdorfer, *A
//! second-order Rosenbrock method applied to photochemical dispersion problems*, SIAM J. Sci.
//! Comput. 20, 1999). So stiffness limits the step, as in Verlet's method, but damping does not.

use std::f64::consts::FRAC_1_SQRT_2;
use std::ops::Range;

use super::implicit::Dense;
use super::integrator::{Integrator, check_dim};
use super::kicks::VERLET_PLAN;
use super::method::{Create, Method, View};
use super::splitting::{drift, kick};
use super::sweep::add_scaled;
use crate::control::Control;
use crate::error::Error;
use crate::linear::DampingSolver;
use crate::measure::Measure;
use crate::refusal::Refusal;
use crate::rows::Terms;
use crate::system::{Linearized, Mechanics, ParticleSystem, reads_velocity, rigid_of};
use crate::work::Work;

pub(super) const METHOD: Method = Method {
    name: "implicit-damping",
    letter: Some('h'),
    aliases: &[],
    title: "velocity Verlet, implicit damping",
    order: 2,
    default_control: Control::Step(0.005),
    evaluations: 1,
    damped_evaluations: 2,
    view: View::Damping,
    create: Create::Step(|system| Box::new(ImplicitDamping::new(system))),
};

/// g, of A = M + g h C.
const G: f64 = 1.0 - FRAC_1_SQRT_2;

const TERMS: Terms = Terms::KickForces;

/// The method with its scratch.
struct ImplicitDamping {
    dim: usize,
    /// Verlet's method, for forces that do not depend on v.
    verlet: Box<dyn Integrator>,
    /// The solver for forces that do.
    solver: Option<KickSolver>,
}

/// Solver of the equations of a kick, with its scratch.
enum KickSolver {
    /// For a linearised system of masses without constraints.
    Sparse {
        linear: Box<DampingSolver>,
        /// Forces, and k1 and k2.
        f: Vec<f64>,
        k: [Vec<f64>; 2],
    },
    /// For any other, small system.
    Dense { linear: Box<Dense>, base: Vec<f64>, k1: Vec<f64> },
}

/// The rates of velocities, and of angular momenta, by a kick at a time (s) at fixed positions.
struct Kicked<'a>(&'a dyn ParticleSystem);

impl ImplicitDamping {
    fn new(system: &dyn ParticleSystem) -> Self {
        let solver = || KickSolver::new(system);
        Self {
            dim: system.dim(),
            verlet: VERLET_PLAN.integrator(system),
            solver: reads_velocity(system).then(solver),
        }
    }
}

impl Integrator for ImplicitDamping {
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        check_dim(self.dim, y)?;
        if !reads_velocity(system) {
            return self.verlet.step(system, t, h, y);
        }
        let solver = self.solver.get_or_insert_with(|| KickSolver::new(system));
        let half = 0.5 * h;
        drift_of(system, t, half, y)?;
        let work = solver.kick(system, t + half, h, y)?;
        drift_of(system, t + half, half, y)?;
        Ok(work)
    }
}

impl KickSolver {
    fn new(system: &dyn ParticleSystem) -> Self {
        let zeros = |length: usize| vec![0.0; length];
        match linearized(system) {
            Some(linearized) => {
                let length = system.dim() / 2;
                Self::Sparse {
                    linear: Box::new(DampingSolver::new(linearized)),
                    f: zeros(length),
                    k: [zeros(length), zeros(length)],
                }
            }
            None => Self::Dense {
                linear: Box::new(Dense::new(&Kicked(system))),
                base: zeros(system.dim()),
                k1: zeros(system.dim()),
            },
        }
    }

    /// Changes the velocities in y by the kick of a step of h (s), by the forces at time t (s).
    fn kick(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        let a = G * h;
        match (self, linearized(system)) {
            (Self::Sparse { linear, f, k }, Some(linearized)) => {
                let (x, v) = y.split_at_mut(y.len() / 2);
                let [k1, k2] = k;
                let mut work = linear.assemble(linearized, (t, a), x);
                work += Work::of(2);
                kick_forces(linearized, t, x, v, f);
                work += linear.solve(linearized, f, k1)?;
                add_scaled(v, h, k1);
                kick_forces(linearized, t, x, v, f);
                let inverse_masses = linearized.inverse_masses();
                for (f, k1) in f
                    .chunks_exact_mut(inverse_masses.len())
                    .zip(k1.chunks_exact(inverse_masses.len()))
                {
                    for ((f, k1), w) in f.iter_mut().zip(k1).zip(inverse_masses) {
                        *f -= if *w == 0.0 { 0.0 } else { 2.0 * k1 / w };
                    }
                }
                work += linear.solve(linearized, f, k2)?;
                add_scaled(v, 0.5 * h, k1);
                add_scaled(v, 0.5 * h, k2);
                Ok(work)
            }
            (Self::Dense { linear, base, k1 }, _) => {
                let kicked = Kicked(system);
                let (mut work, of_use) = linear.keep(&kicked, t, [a, a], y);
                if !of_use {
                    return Err(Error::NoConvergence { residual: 1.0 });
                }
                base.copy_from_slice(y);
                work += linear.correct(&kicked, t, a, base, y);
                // The change is a k1, and later a k2.
                k1.copy_from_slice(linear.change());
                y.copy_from_slice(base);
                add_scaled(y, 1.0 / G, k1);
                base.copy_from_slice(y);
                add_scaled(base, -2.0, k1);
                work += linear.correct(&kicked, t, a, base, y);
                add_scaled(y, -1.0, linear.change());
                add_scaled(y, 0.5 / G, k1);
                add_scaled(y, 0.5 / G, linear.change());
                Ok(work)
            }
            (Self::Sparse { .. }, None) => {
                Err(Error::Unsupported { method: METHOD.name, why: Refusal::LacksMasses })
            }
        }
    }
}

impl ParticleSystem for Kicked<'_> {
    fn dim(&self) -> usize {
        self.0.dim()
    }

    fn eval_f(&self, t: f64, y: &[f64], dydt: &mut [f64]) {
        if let Some(rigid) = rigid_of(self.0) {
            rigid.kick(t, TERMS, y, dydt);
        } else if let Some(mechanics) = self.0.mechanics() {
            let half = y.len() / 2;
            dydt[..half].fill(0.0);
            kick(mechanics, TERMS, t, &y[..half], &y[half..], &mut dydt[half..]);
        }
    }

    fn measures(&self, visit: &mut dyn FnMut(Range<usize>, Measure)) {
        self.0.measures(&mut |numbers, measure| {
            if matches!(measure, Measure::Velocity | Measure::Momentum { .. }) {
                visit(numbers, measure);
            }
        });
    }
}

/// Returns the view of a system whose damping is solved by couplings.
fn linearized(system: &dyn ParticleSystem) -> Option<&dyn Linearized> {
    let linearized = system.mechanics().and_then(Mechanics::linearized);
    linearized.filter(|linearized| linearized.baumgarte_frequency().is_none())
}

/// Writes the forces (N) of a kick at time t (s) to f.
fn kick_forces(mechanics: &dyn Linearized, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
    match mechanics.splitting() {
        Some(splitting) => splitting.kick_forces(t, x, v, f),
        None => mechanics.forces(t, x, v, f),
    }
}

/// Drifts y from t to t + h (s).
fn drift_of(system: &dyn ParticleSystem, t: f64, h: f64, y: &mut [f64]) -> Result<(), Error> {
    match (rigid_of(system), system.mechanics()) {
        (Some(rigid), _) => rigid.drift(t, h, TERMS, y),
        (None, Some(mechanics)) => {
            let (x, v) = y.split_at_mut(y.len() / 2);
            drift(mechanics, TERMS, t, h, x, v);
        }
        (None, None) => {
            return Err(Error::Unsupported { method: METHOD.name, why: Refusal::LacksMasses });
        }
    }
    Ok(())
}
