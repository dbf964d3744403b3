//! Splitting methods: alternate drifts, which move x by v, and kicks, which change v by the forces
//! at fixed x. Where forces depend on v too, as those of damped springs do, a kick is a step of an
//! explicit Runge-Kutta method in v.

use pulp::Arch;

use super::runge_kutta::{Combine, EULER, Table, stages};
use super::sweep::Sweeper;
use super::{Integrator, Work, check_dim};
use crate::error::Error;
use crate::rows::{Stage, Terms};
use crate::system::{Mechanics, ParticleSystem, Rigid, Splitting, divide_by_masses, place_pins};

/// Largest number of stages of a sweep through several kicks: with more, the rows no longer fit in
/// the cache.
const STAGES: usize = 4;

/// Splitting method as a table of drifts and kicks.
pub(super) struct Plan {
    /// Name of the method.
    pub name: &'static str,
    /// Lengths of each drift and of the kick after it, as fractions of the step.
    pub steps: &'static [(f64, f64)],
    /// Length of the last drift, as a fraction of the step.
    pub last: f64,
    /// Terms that act in kicks: [`Terms::KickForces`] if drifts carry gravity and drag exactly, and
    /// otherwise [`Terms::AllForces`].
    pub terms: Terms,
    /// Runge-Kutta method of a kick where forces depend on v; `None` for a method that does not
    /// serve such forces.
    pub damped: Option<Table>,
}

/// Splitting method with its scratch.
pub(super) struct SplittingMethod {
    plan: &'static Plan,
    dim: usize,
    stages: Vec<Stage>,
    /// Scratch for systems of rows; `None` for others.
    sweeper: Option<Sweeper>,
    /// Scratch for other systems: v at the beginning of the kick, the sum over its stages, and the
    /// accelerations; with rigid bodies, of the whole state.
    v: Vec<f64>,
    sum: Vec<f64>,
    a: Vec<f64>,
}

impl Plan {
    /// Integrator of this method for a system.
    pub fn integrator(&'static self, system: &dyn ParticleSystem) -> Box<dyn Integrator> {
        let sweeper = Sweeper::new(system, self.stages_of_sweep(system));
        self.with(system, sweeper)
    }

    /// Integrator that steps with this sweeper, or by whole arrays if there is none.
    pub fn with(
        &'static self,
        system: &dyn ParticleSystem,
        sweeper: Option<Sweeper>,
    ) -> Box<dyn Integrator> {
        let dim = system.dim();
        let length = match system.rigid() {
            Some(_) => dim,
            None if sweeper.is_some() => 0,
            None => dim / 2,
        };
        Box::new(SplittingMethod {
            plan: self,
            dim,
            stages: Vec::with_capacity(self.steps.len() * self.kick(system).len()),
            sweeper,
            v: vec![0.0; length],
            sum: vec![0.0; length],
            a: vec![0.0; length],
        })
    }

    /// Runge-Kutta method of a kick of this system: that of forces without velocities, if the
    /// method does not serve others.
    fn kick(&self, system: &dyn ParticleSystem) -> Table {
        self.damped
            .filter(|_| reads_velocity(system))
            .unwrap_or(EULER)
    }

    /// Number of stages of a sweep: as many whole kicks as fit, at least one.
    pub fn stages_of_sweep(&self, system: &dyn ParticleSystem) -> usize {
        let kick = self.kick(system).len();
        kick * (STAGES / kick).clamp(1, self.steps.len())
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
            return Err(Error::ReadsVelocity { method: plan.name });
        }
        let kick = plan.kick(system);
        let lead = (t, plan.steps[0].0 * h);
        let mut now = t;
        self.stages.clear();
        for (i, (drift, length)) in plan.steps.iter().enumerate() {
            now += drift * h;
            let next = plan.steps.get(i + 1).map_or(plan.last, |(drift, _)| *drift) * h;
            self.stages.extend(
                stages(kick, plan.terms, now, length * h).map(|stage| Stage {
                    t: now,
                    until: if stage.c.is_none() { now + next } else { now },
                    drift: if stage.c.is_none() { next } else { 0.0 },
                    ..stage
                }),
            );
        }
        let per_sweep = plan.stages_of_sweep(system);
        match (&mut self.sweeper, system.rows()) {
            (Some(sweeper), Some(system)) if sweeper.fits(system, per_sweep) => {
                let mut lead = Some((plan.terms, lead)).filter(|_| lead.1 != 0.0);
                for stages in self.stages.chunks(per_sweep) {
                    sweeper.step(system, lead.take(), stages, y);
                }
            }
            _ => match (system.rigid(), system.mechanics()) {
                (Some(rigid), _) => self.rigid(rigid, lead, y),
                (None, Some(mechanics)) => self.plain(mechanics, lead, y),
                (None, None) => return Err(Error::NeedsMechanics { method: plan.name }),
            },
        }
        Ok(Work::of(self.stages.len() as u64))
    }
}

impl SplittingMethod {
    /// Takes y through the first drift of length `lead` (s) from t (s) and all stages by whole
    /// arrays.
    fn plain(&mut self, mechanics: &dyn Mechanics, (t, lead): (f64, f64), y: &mut [f64]) {
        let (x, v) = y.split_at_mut(self.dim / 2);
        // An integrator that was made for rows has no scratch for whole arrays yet.
        for scratch in [&mut self.v, &mut self.sum, &mut self.a] {
            scratch.resize(v.len(), 0.0);
        }
        let terms = self.plan.terms;
        drift(mechanics, terms, t, lead, x, v);
        for stage in &self.stages {
            if stage.first {
                self.v.copy_from_slice(v);
            }
            match mechanics.splitting() {
                Some(splitting) if terms == Terms::KickForces => {
                    splitting.kick_forces(stage.t, x, v, &mut self.a);
                    divide_by_masses(mechanics.inverse_masses(), &mut self.a);
                }
                _ => mechanics.accelerations(stage.t, x, v, &mut self.a),
            }
            Arch::new().dispatch(Combine {
                stage,
                y: &self.v,
                sum: &mut self.sum,
                next: v,
                k: &self.a,
            });
            drift(mechanics, terms, stage.t, stage.drift, x, v);
        }
    }

    /// Does the same where rigid bodies are: kicks change velocities and angular momenta, and
    /// drifts turn bodies freely.
    fn rigid(&mut self, system: &dyn Rigid, (t, lead): (f64, f64), y: &mut [f64]) {
        let terms = self.plan.terms;
        let drift = |t: f64, h: f64, y: &mut [f64]| {
            if h != 0.0 {
                system.drift(t, h, terms, y);
            }
        };
        drift(t, lead, y);
        for stage in &self.stages {
            if stage.first {
                self.v.copy_from_slice(y);
            }
            system.kick(stage.t, terms, y, &mut self.a);
            Arch::new().dispatch(Combine {
                stage,
                y: &self.v,
                sum: &mut self.sum,
                next: y,
                k: &self.a,
            });
            drift(stage.t, stage.drift, y);
        }
    }
}

/// Whether kicks depend on v, or the system does not say.
fn reads_velocity(system: &dyn ParticleSystem) -> bool {
    if let Some(rigid) = system.rigid() {
        return rigid.kick_reads_velocity();
    }
    let splitting = system.mechanics().and_then(Mechanics::splitting);
    splitting.is_none_or(Splitting::kick_reads_velocity)
}

/// Takes x and v through a drift from t to t + h (s), and pins to their places at its end.
fn drift(mechanics: &dyn Mechanics, terms: Terms, t: f64, h: f64, x: &mut [f64], v: &mut [f64]) {
    if h == 0.0 {
        return;
    }
    match mechanics.splitting() {
        Some(splitting) if terms == Terms::KickForces => splitting.drift(t, h, x, v),
        _ => {
            super::add_scaled(x, h, v);
            place_pins(mechanics, t + h, x, v);
        }
    }
}
