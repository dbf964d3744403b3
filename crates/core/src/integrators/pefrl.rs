//! PEFRL, the position-extended Forest-Ruth-like method of Omelyan, Mryglod and Folk, *Optimized Forest-Ruth- and
//! Suzuki-like algorithms for integration of motion in many-body systems*, Comput. Phys. Commun. 146 (2002): five
//! drifts and four kicks, symmetric. Order 4.
//!
//! Each drift is the exact flow under drag and gravity. Where the other forces depend on the velocity (springs damped
//! along their length), each kick is one step of the classical Runge-Kutta method in v, at x as it stands: less would
//! drop the order.

use super::{Integrator, Method, Work, add_scaled, check_dim, kick};
use crate::error::Error;
use crate::system::{Mechanics, ParticleSystem};

pub(super) const METHOD: Method = Method {
    name: "pefrl",
    letter: 'p',
    aliases: &["forest-ruth"],
    title: "PEFRL, symplectic",
    order: 4,
    default_setting: 0.005,
    evaluations: 4,
    damped_evaluations: 16,
    implicit: false,
    pair: None,
    needs_mechanics: true,
    create: |system| {
        let half = system.dim() / 2;
        Box::new(Pefrl {
            f: vec![0.0; half],
            stage: vec![0.0; half],
            sum: vec![0.0; half],
        })
    },
};

const XI: f64 = 0.178_617_895_844_809_1;
const LAMBDA: f64 = -0.212_341_831_062_605_4;
const CHI: f64 = -0.066_264_582_669_818_5;

/// Each kick, and the drift before it.
const STAGES: [(f64, f64); 4] = [
    (XI, 0.5 - LAMBDA),
    (CHI, LAMBDA),
    (1.0 - 2.0 * (CHI + XI), LAMBDA),
    (CHI, 0.5 - LAMBDA),
];

struct Pefrl {
    f: Vec<f64>,
    stage: Vec<f64>,
    sum: Vec<f64>,
}

impl Pefrl {
    /// The flow of v' = M^-1 F(t, x, v) over h, x and t standing still.
    fn kick(&mut self, mechanics: &dyn Mechanics, t: f64, h: f64, x: &[f64], v: &mut [f64]) -> u64 {
        let inverse_masses = mechanics.inverse_masses();
        let Self { f, stage, sum } = self;
        mechanics.kick_forces(t, x, v, f);
        if !mechanics.kick_reads_velocity() {
            kick(v, h, inverse_masses, f);
            return 1;
        }
        sum.copy_from_slice(f);
        for next in [0.5 * h, 0.5 * h, h] {
            stage.copy_from_slice(v);
            kick(stage, next, inverse_masses, f);
            mechanics.kick_forces(t, x, stage, f);
            add_scaled(sum, if next == h { 1.0 } else { 2.0 }, f);
        }
        kick(v, h / 6.0, inverse_masses, sum);
        4
    }
}

impl Integrator for Pefrl {
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
        let (x, v) = y.split_at_mut(self.f.len());
        let (mut now, mut evaluations) = (t, 0);
        for (drift, kick) in STAGES {
            mechanics.drift(now, drift * h, x, v);
            now += drift * h;
            evaluations += self.kick(mechanics, now, kick * h, x, v);
        }
        mechanics.drift(now, XI * h, x, v);
        Ok(Work::of(evaluations))
    }
}
