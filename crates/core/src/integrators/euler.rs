//! Explicit Euler: y1 = y + h f(t, y). Order 1.

use super::{Integrator, Method, Work, add_scaled, check_dim};
use crate::error::Error;
use crate::system::ParticleSystem;

pub(super) const METHOD: Method = Method {
    name: "euler",
    letter: 'e',
    aliases: &["explicit-euler", "forward-euler"],
    title: "explicit Euler",
    order: 1,
    default_setting: 0.0002,
    evaluations: 1,
    damped_evaluations: 1,
    implicit: false,
    pair: None,
    needs_mechanics: false,
    create: |system| {
        Box::new(Euler {
            f: vec![0.0; system.dim()],
        })
    },
};

struct Euler {
    f: Vec<f64>,
}

impl Integrator for Euler {
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        check_dim(self.f.len(), y)?;
        system.eval_f(t, y, &mut self.f);
        add_scaled(y, h, &self.f);
        Ok(Work::of(1))
    }
}
