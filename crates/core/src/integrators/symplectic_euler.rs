//! Symplectic (semi-implicit) Euler: v1 = v + h M^-1 F(t, x, v), x1 = x + h v1. Order 1.

use super::{Integrator, Method, Work, add_scaled, check_dim, kick};
use crate::error::Error;
use crate::system::{ParticleSystem, place_pins};

pub(super) const METHOD: Method = Method {
    name: "symplectic",
    letter: 's',
    aliases: &["symplectic-euler", "semi-implicit-euler"],
    title: "symplectic Euler",
    order: 1,
    default_setting: 0.005,
    evaluations: 1,
    damped_evaluations: 1,
    implicit: false,
    pair: None,
    needs_mechanics: true,
    create: |system| {
        let dim = system.dim();
        Box::new(SymplecticEuler {
            f: vec![0.0; dim / 2],
        })
    },
};

struct SymplecticEuler {
    f: Vec<f64>,
}

impl Integrator for SymplecticEuler {
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
        mechanics.forces(t, x, v, &mut self.f);
        kick(v, h, mechanics.inverse_masses(), &self.f);
        add_scaled(x, h, v);
        place_pins(mechanics, t + h, x, v);
        Ok(Work::of(1))
    }
}
