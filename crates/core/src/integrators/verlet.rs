//! Verlet's method, drift-kick-drift: half a step of the exact flow under drag and gravity, the other forces' kick of
//! a whole step, half a step of the flow again. Order 2, drag included.
//!
//! This is velocity Verlet seen from the middle of its step: the same map up to half a drift at either end, so it has
//! the same order and the same limit. Kick-drift-kick would evaluate the forces at both ends, and have to remember
//! one of them from step to step to pay for it once; here one evaluation is all there is, and nothing to go stale.
//!
//! Forces that depend on the velocity (springs damped along their length) are kicked by the explicit midpoint rule in
//! v, two evaluations, because one at the old velocity alone would drop the order to 1.

use super::{Integrator, Method, Work, check_dim, kick};
use crate::error::Error;
use crate::system::ParticleSystem;

pub(super) const METHOD: Method = Method {
    name: "verlet",
    letter: 'v',
    aliases: &["velocity-verlet", "leapfrog"],
    title: "velocity Verlet, exact drag",
    order: 2,
    default_setting: 0.005,
    evaluations: 1,
    damped_evaluations: 2,
    implicit: false,
    pair: None,
    needs_mechanics: true,
    create: |system| {
        let dim = system.dim();
        Box::new(Verlet {
            f: vec![0.0; dim / 2],
            middle: vec![0.0; dim / 2],
        })
    },
};

struct Verlet {
    f: Vec<f64>,
    middle: Vec<f64>,
}

impl Integrator for Verlet {
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        check_dim(2 * self.f.len(), y)?;
        let mechanics = system.mechanics().ok_or(Error::NeedsMechanics {
            method: METHOD.name,
        })?;
        let inverse_masses = mechanics.inverse_masses();
        let Self { f, middle } = self;
        let (x, v) = y.split_at_mut(f.len());
        let half = 0.5 * h;
        let mut evaluations = 1;
        mechanics.drift(t, half, x, v);
        mechanics.kick_forces(t + half, x, v, f);
        if mechanics.kick_reads_velocity() {
            middle.copy_from_slice(v);
            kick(middle, half, inverse_masses, f);
            mechanics.kick_forces(t + half, x, middle, f);
            evaluations = 2;
        }
        kick(v, h, inverse_masses, f);
        mechanics.drift(t + half, half, x, v);
        Ok(Work::of(evaluations))
    }
}
