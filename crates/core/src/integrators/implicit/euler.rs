//! Implicit Euler: y1 = y + h f(t + h, y1), with forces by one iteration of Newton's method
//! (Baraff, Witkin, *Large Steps in Cloth Simulation*, 1998). With rigid bodies, whose friction
//! follows from the forces at the end of the step, there are more, if they lead to the solution.
//! Any step is stable, and longer steps damp the motion more. Order 1.

use super::super::method::{Create, Method, View};
use super::divided::{Divisible, is_plain};
use super::newton::Newton;
use super::stage::StageSolver;
use crate::control::Control;
use crate::error::Error;
use crate::system::ParticleSystem;
use crate::work::Work;

pub(crate) const METHOD: Method = Method {
    name: "implicit",
    letter: Some('i'),
    aliases: &["implicit-euler", "backward-euler"],
    title: "implicit Euler",
    order: 1,
    default_control: Control::Step(0.02),
    evaluations: 1,
    damped_evaluations: 1,
    view: View::Tangent,
    create: Create::Step(|system| {
        Box::new(ImplicitEuler { stage: StageSolver::new(system), base: vec![0.0; system.dim()] })
    }),
};

struct ImplicitEuler {
    stage: StageSolver,
    base: Vec<f64>,
}

impl Divisible for ImplicitEuler {
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
        let Self { stage, base } = self;
        base.copy_from_slice(y);
        let newton = if is_plain(stage, system) { Newton::Full } else { Newton::Once };
        *work += stage.solve(system, t + h, h, base, y, newton)?;
        stage.project_bodies(system, y);
        Ok(())
    }
}
