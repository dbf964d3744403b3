//! Heun's method, the explicit trapezoid:
//! f0 = f(t, y), f1 = f(t + h, y + h f0), y1 = y + h/2 (f0 + f1). Order 2.

use super::{Integrator, Method, Work, check_dim, scaled_sum};
use crate::error::Error;
use crate::system::ParticleSystem;

pub(super) const METHOD: Method = Method {
    name: "trapezoid",
    letter: 't',
    aliases: &["heun", "trapezoidal", "explicit-trapezoid"],
    title: "explicit trapezoid (Heun)",
    order: 2,
    default_setting: 0.005,
    evaluations: 2,
    damped_evaluations: 2,
    implicit: false,
    pair: None,
    needs_mechanics: false,
    create: |system| {
        let dim = system.dim();
        Box::new(Heun {
            f0: vec![0.0; dim],
            f1: vec![0.0; dim],
            predicted: vec![0.0; dim],
        })
    },
};

struct Heun {
    f0: Vec<f64>,
    f1: Vec<f64>,
    predicted: Vec<f64>,
}

impl Integrator for Heun {
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        check_dim(self.f0.len(), y)?;
        let Self { f0, f1, predicted } = self;
        system.eval_f(t, y, f0);
        scaled_sum(predicted, y, h, f0);
        system.eval_f(t + h, predicted, f1);
        for ((y, f0), f1) in y.iter_mut().zip(&*f0).zip(&*f1) {
            *y += 0.5 * h * (f0 + f1);
        }
        Ok(Work::of(2))
    }
}
