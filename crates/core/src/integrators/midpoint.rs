//! Explicit midpoint: y1 = y + h f(t + h/2, y + h/2 f(t, y)). Order 2.

use super::{Integrator, Method, Work, add_scaled, check_dim, scaled_sum};
use crate::error::Error;
use crate::system::ParticleSystem;

pub(super) const METHOD: Method = Method {
    name: "midpoint",
    letter: 'm',
    aliases: &["explicit-midpoint"],
    title: "explicit midpoint",
    order: 2,
    default_setting: 0.005,
    evaluations: 2,
    damped_evaluations: 2,
    implicit: false,
    pair: None,
    needs_mechanics: false,
    create: |system| {
        let dim = system.dim();
        Box::new(Midpoint {
            f: vec![0.0; dim],
            middle: vec![0.0; dim],
        })
    },
};

struct Midpoint {
    f: Vec<f64>,
    middle: Vec<f64>,
}

impl Integrator for Midpoint {
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        check_dim(self.f.len(), y)?;
        let Self { f, middle } = self;
        system.eval_f(t, y, f);
        scaled_sum(middle, y, 0.5 * h, f);
        system.eval_f(t + 0.5 * h, middle, f);
        add_scaled(y, h, f);
        Ok(Work::of(2))
    }
}
