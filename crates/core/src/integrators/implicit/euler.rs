//! Implicit Euler, y1 = y + h f(t + h, y1), by one step of Newton's method, as in Baraff and
//! Witkin, *Large Steps in Cloth Simulation*, 1998: any step is stable, and motion is damped the
//! more the longer it is. Order 1.

use super::super::{Integrator, Method, Work, check_dim};
use super::{Newton, Stage};
use crate::control::Control;
use crate::error::Error;
use crate::system::ParticleSystem;

pub(in super::super) const METHOD: Method = Method {
    name: "implicit",
    letter: 'i',
    aliases: &["implicit-euler", "backward-euler"],
    title: "implicit Euler",
    order: 1,
    default_control: Control::Step(0.02),
    evaluations: 1,
    damped_evaluations: 1,
    implicit: true,
    pair: None,
    needs_mechanics: false,
    create: |system| {
        Box::new(ImplicitEuler {
            stage: Stage::new(system),
            base: vec![0.0; system.dim()],
        })
    },
};

struct ImplicitEuler {
    stage: Stage,
    base: Vec<f64>,
}

impl Integrator for ImplicitEuler {
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        let Self { stage, base } = self;
        check_dim(base.len(), y)?;
        base.copy_from_slice(y);
        stage.solve(system, t + h, h, base, y, Newton::Once)
    }
}
