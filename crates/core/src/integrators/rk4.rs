//! The classical Runge-Kutta method (Kutta 1901):
//! k1 = f(t, y), k2 = f(t + h/2, y + h/2 k1), k3 = f(t + h/2, y + h/2 k2), k4 = f(t + h, y + h k3),
//! y1 = y + h/6 (k1 + 2 k2 + 2 k3 + k4). Order 4.

use super::{Integrator, Method, Work, add_scaled, check_dim, scaled_sum};
use crate::error::Error;
use crate::system::ParticleSystem;

pub(super) const METHOD: Method = Method {
    name: "rk4",
    letter: 'r',
    aliases: &["runge-kutta", "runge-kutta-4"],
    title: "classical Runge-Kutta",
    order: 4,
    default_setting: 0.01,
    evaluations: 4,
    damped_evaluations: 4,
    implicit: false,
    pair: None,
    needs_mechanics: false,
    create: |system| {
        let dim = system.dim();
        Box::new(Rk4 {
            k: vec![0.0; dim],
            sum: vec![0.0; dim],
            stage: vec![0.0; dim],
        })
    },
};

struct Rk4 {
    k: Vec<f64>,
    sum: Vec<f64>,
    stage: Vec<f64>,
}

impl Integrator for Rk4 {
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        check_dim(self.k.len(), y)?;
        let Self { k, sum, stage } = self;
        system.eval_f(t, y, sum);
        scaled_sum(stage, y, 0.5 * h, sum);
        for next in [0.5 * h, h] {
            system.eval_f(t + 0.5 * h, stage, k);
            add_scaled(sum, 2.0, k);
            scaled_sum(stage, y, next, k);
        }
        system.eval_f(t + h, stage, k);
        for ((y, sum), k) in y.iter_mut().zip(&*sum).zip(&*k) {
            *y += h / 6.0 * (sum + k);
        }
        Ok(Work::of(4))
    }
}
