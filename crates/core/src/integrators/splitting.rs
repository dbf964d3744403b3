//! Splitting methods alternate drifts, which move x by v, and kicks, which change v by the forces
//! at fixed x. If forces depend on v too, as those of damped springs do, a method has other kicks:
//! each is a step of an explicit Runge-Kutta method in v, or uses forces at velocities ahead of v.

use super::integrator::{Integrator, check_dim};
use super::sweep::{Combine, Sweeper, Table, add_scaled, stages};
use crate::error::Error;
use crate::refusal::Refusal;
use crate::rows::{Next, Stage, Terms};
use crate::system::{
    Mechanics, ParticleSystem, Rigid, divide_by_masses, place_pins, reads_velocity, rigid_of,
    rows_of,
};
use crate::vectors::Arch;
use crate::work::Work;

/// Largest number of stages in a sweep through several kicks: with more, the rows no longer fit in
/// the cache.
const MAX_SWEEP_STAGES: usize = 4;

/// Splitting method as a table of drifts and kicks.
pub(super) struct Plan {
    /// Name of the method.
    pub name: &'static str,
    /// Forces that act in kicks: [`Terms::KickForces`] if drifts handle gravity and drag exactly,
    /// and otherwise [`Terms::AllForces`].
    pub terms: Terms,
    /// Drifts and kicks for forces that do not depend on v.
    pub free: Kicks,
    /// Drifts and kicks for forces that do; `None` for a method that does not support such forces.
    pub damped: Option<Kicks>,
}

/// Drifts and kicks of a step.
#[derive(Clone, Copy)]
pub(super) struct Kicks {
    /// Lengths of each drift and of the kick after it, as fractions of the step.
    pub steps: &'static [(f64, f64)],
    /// Length of the last drift, as a fraction of the step.
    pub last: f64,
    /// Runge-Kutta method in v of each kick.
    pub table: Table,
    /// How far ahead of v each kick after the first evaluates its forces: e = k e + c h a, with
    /// these k and c and the acceleration a of the previous kick. If it is empty, kicks evaluate
    /// forces at v.
    pub ahead: &'static [(f64, f64)],
}

/// Splitting method with its scratch.
struct SplittingMethod {
    plan: &'static Plan,
    dim: usize,
    stages: Vec<Stage>,
    /// Scratch for systems of rows; `None` for others.
    sweeper: Option<Sweeper>,
    /// Scratch for other systems: v at the beginning of the kick, or the distance of the stage
    /// ahead of v; the sum over its stages, or v; and the accelerations. With rigid bodies, these
    /// are of the whole state.
    y: Vec<f64>,
    sum: Vec<f64>,
    a: Vec<f64>,
}

impl Plan {
    /// Creates the integrator of this method for a system.
    pub fn integrator(&'static self, system: &dyn ParticleSystem) -> Box<dyn Integrator> {
        let sweeper = Sweeper::new(system, self.stages_of_sweep(system));
        self.with(system, sweeper)
    }

    /// Creates an integrator that steps with this sweeper or, without one, on whole arrays.
    pub fn with(
        &'static self,
        system: &dyn ParticleSystem,
        sweeper: Option<Sweeper>,
    ) -> Box<dyn Integrator> {
        let (dim, kicks) = (system.dim(), self.kicks(system));
        let length = match rigid_of(system) {
            Some(_) => dim,
            None if sweeper.is_some() => 0,
            None => dim / 2,
        };
        Box::new(SplittingMethod {
            plan: self,
            dim,
            stages: Vec::with_capacity(kicks.steps.len() * kicks.table.len()),
            sweeper,
            y: vec![0.0; length],
            sum: vec![0.0; length],
            a: vec![0.0; length],
        })
    }

    /// Drifts and kicks for this system: those for forces without velocities, if the method
    /// supports no others.
    fn kicks(&self, system: &dyn ParticleSystem) -> Kicks {
        self.damped.filter(|_| reads_velocity(system)).unwrap_or(self.free)
    }

    /// Returns the number of stages in a sweep: as many whole kicks as fit, at least one.
    pub fn stages_of_sweep(&self, system: &dyn ParticleSystem) -> usize {
        let Kicks { steps, table, .. } = self.kicks(system);
        table.len() * (MAX_SWEEP_STAGES / table.len()).clamp(1, steps.len())
    }
}

impl Kicks {
    /// Lists the stages of a step from t to t + h (s).
    fn stages(self, terms: Terms, t: f64, h: f64) -> impl Iterator<Item = Stage> {
        let mut now = t;
        self.steps.iter().enumerate().flat_map(move |(i, (drift, length))| {
            now += drift * h;
            let (start, is_ahead) = (now, (1..=self.ahead.len()).contains(&i));
            let drift = self.steps.get(i + 1).map_or(self.last, |(drift, _)| *drift) * h;
            let next = self
                .ahead
                .get(i)
                .map_or(Next::Sum, |(keep, add)| Next::Ahead { keep: *keep, add: add * h });
            stages(self.table, terms, now, length * h).map(move |stage| match stage.next {
                Next::Sum => Stage {
                    t: start,
                    until: start + drift,
                    first: stage.first && !is_ahead,
                    next,
                    drift,
                    ..stage
                },
                _ => Stage { t: start, until: start, ..stage },
            })
        })
    }
}

impl Integrator for SplittingMethod {
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        check_dim(self.dim, y)?;
        let plan = self.plan;
        if plan.damped.is_none() && reads_velocity(system) {
            return Err(Error::Unsupported { method: plan.name, why: Refusal::ReadsVelocity });
        }
        let kicks = plan.kicks(system);
        let lead = (t, kicks.steps[0].0 * h);
        self.stages.clear();
        self.stages.extend(kicks.stages(plan.terms, t, h));
        let per_sweep = plan.stages_of_sweep(system);
        match (&mut self.sweeper, rows_of(system)) {
            (Some(sweeper), Some(system)) if sweeper.fits(system, per_sweep) => {
                let mut lead = Some((plan.terms, lead)).filter(|_| lead.1 != 0.0);
                for stages in self.stages.chunks(per_sweep) {
                    sweeper.step(system, lead.take(), stages, y);
                }
            }
            _ => match (rigid_of(system), system.mechanics()) {
                (Some(rigid), _) => self.rigid(rigid, lead, y),
                (None, Some(mechanics)) => self.plain(mechanics, lead, y),
                (None, None) => {
                    return Err(Error::Unsupported {
                        method: plan.name,
                        why: Refusal::LacksMasses,
                    });
                }
            },
        }
        Ok(Work::of(self.stages.len() as u64))
    }
}

impl SplittingMethod {
    /// Advances y through the first drift of length `lead` (s) from t (s) and all stages, on whole
    /// arrays.
    fn plain(&mut self, mechanics: &dyn Mechanics, (t, lead): (f64, f64), y: &mut [f64]) {
        let (x, v) = y.split_at_mut(self.dim / 2);
        // An integrator made for rows has no scratch for whole arrays yet.
        for scratch in [&mut self.y, &mut self.sum, &mut self.a] {
            scratch.resize(v.len(), 0.0);
        }
        let terms = self.plan.terms;
        drift(mechanics, terms, t, lead, x, v);
        for stage in &self.stages {
            if stage.first && stage.next.is_from_y() {
                self.y.copy_from_slice(v);
            }
            kick(mechanics, terms, stage.t, x, v, &mut self.a);
            Arch::new().dispatch(Combine {
                stage,
                y: &mut self.y,
                sum: &mut self.sum,
                next: v,
                k: &self.a,
            });
            drift(mechanics, terms, stage.t, stage.drift, x, v);
            if stage.next.is_ahead() {
                self.sum.copy_from_slice(v);
                add_scaled(v, 1.0, &self.y);
            }
        }
    }

    /// Takes a step as [`plain`](Self::plain) does, with rigid bodies: kicks change velocities and
    /// angular momenta, and drifts rotate bodies freely.
    fn rigid(&mut self, system: &dyn Rigid, (t, lead): (f64, f64), y: &mut [f64]) {
        let terms = self.plan.terms;
        let drift = |t: f64, h: f64, y: &mut [f64]| {
            if h != 0.0 {
                system.drift(t, h, terms, y);
            }
        };
        drift(t, lead, y);
        for stage in &self.stages {
            if stage.first && stage.next.is_from_y() {
                self.y.copy_from_slice(y);
            }
            system.kick(stage.t, terms, y, &mut self.a);
            Arch::new().dispatch(Combine {
                stage,
                y: &mut self.y,
                sum: &mut self.sum,
                next: y,
                k: &self.a,
            });
            drift(stage.t, stage.drift, y);
            if stage.next.is_ahead() {
                self.sum.copy_from_slice(y);
                add_scaled(y, 1.0, &self.y);
            }
        }
    }
}

/// Writes the accelerations (m/s2) of a kick at time t (s) to a.
pub(super) fn kick(
    mechanics: &dyn Mechanics,
    terms: Terms,
    t: f64,
    x: &[f64],
    v: &[f64],
    a: &mut [f64],
) {
    match mechanics.splitting() {
        Some(splitting) if terms == Terms::KickForces => {
            splitting.kick_forces(t, x, v, a);
            divide_by_masses(mechanics.inverse_masses(), a);
        }
        _ => mechanics.accelerations(t, x, v, a),
    }
}

/// Drifts x and v from t to t + h (s), and moves pins to their places at its end.
pub(super) fn drift(
    mechanics: &dyn Mechanics,
    terms: Terms,
    t: f64,
    h: f64,
    x: &mut [f64],
    v: &mut [f64],
) {
    if h == 0.0 {
        return;
    }
    match mechanics.splitting() {
        Some(splitting) if terms == Terms::KickForces => splitting.drift(t, h, x, v),
        _ => {
            add_scaled(x, h, v);
            place_pins(mechanics, t + h, x, v);
        }
    }
}
