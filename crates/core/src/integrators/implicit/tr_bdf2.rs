//! TR-BDF2 (Bank et al. 1985) as a diagonally implicit Runge-Kutta method (Hosea, Shampine,
//! *Analysis and implementation of TR-BDF2*, 1996). With g = 1 - 1/sqrt 2 and w = sqrt 2 / 4:
//! f1 = f(t, y), Y2 = y + g h (f1 + f2), f2 = f(t + 2 g h, Y2),
//! y1 = y + h (w f1 + w f2 + g f(t + h, y1)). Any step is stable, and stiff modes are damped out.
//! Order 2.

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use super::super::integrator::Integrator;
use super::super::method::{Create, Method, View};
use super::divided::Divisible;
use super::newton::Newton;
use super::stage::StageSolver;
use crate::control::Control;
use crate::error::Error;
use crate::system::ParticleSystem;
use crate::work::Work;

pub(crate) const METHOD: Method = Method {
    name: "tr-bdf2",
    letter: Some('b'),
    aliases: &["trbdf2"],
    title: "TR-BDF2, implicit",
    order: 2,
    default_control: Control::Step(0.01),
    evaluations: 7,
    damped_evaluations: 7,
    view: View::Tangent,
    create: Create::Step(integrator),
};

/// Creates an integrator for a system.
pub(super) fn integrator(system: &dyn ParticleSystem) -> Box<dyn Integrator> {
    let zeros = || vec![0.0; system.dim()];
    Box::new(TrBdf2 { stage: StageSolver::new(system), f1: zeros(), base: zeros(), last: zeros() })
}

const G: f64 = 1.0 - FRAC_1_SQRT_2;
const W: f64 = SQRT_2 / 4.0;

struct TrBdf2 {
    stage: StageSolver,
    f1: Vec<f64>,
    base: Vec<f64>,
    /// Base of the last stage.
    last: Vec<f64>,
}

impl Divisible for TrBdf2 {
    fn stage(&mut self) -> &mut StageSolver {
        &mut self.stage
    }

    fn whole(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
        work: &mut Work,
    ) -> Result<(), Error> {
        let Self { stage, f1, base, last } = self;
        system.eval_f(t, y, f1);
        *work += Work::of(1);
        for (((y, f1), base), last) in y.iter().zip(&*f1).zip(&mut *base).zip(&mut *last) {
            *base = y + G * h * f1;
            *last = y + W * h * f1;
        }
        *work += stage.solve(system, t + 2.0 * G * h, G * h, base, y, Newton::Full)?;
        // The solution of the stage gives f2 = (Y2 - base) / (g h).
        for ((last, y), base) in last.iter_mut().zip(&*y).zip(&*base) {
            *last += W / G * (y - base);
        }
        *work += stage.solve(system, t + h, G * h, last, y, Newton::Full)?;
        stage.project_bodies(system, y);
        Ok(())
    }
}
