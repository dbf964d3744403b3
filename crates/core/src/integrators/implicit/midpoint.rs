//! The implicit midpoint rule: Y = y + h/2 f(t + h/2, Y), y1 = 2 Y - y. Its equations are solved to
//! rounding. The method is symplectic, so that the energy error stays bounded, and any step is
//! stable for which the equations have a solution. Order 2.
//!
//! With constraints, the reflection would turn velocities out of what these allow. A part along the
//! constraints is added to v before the step, and taken away after it: half of what the step
//! without it makes (symmetric projection: Hairer, *Symmetric projection methods for differential
//! equations on manifolds*, BIT 40, 2000). So hardly any energy is lost.

use super::super::method::{Create, Method, View};
use super::divided::Divisible;
use super::newton::Newton;
use super::stage::StageSolver;
use crate::control::Control;
use crate::error::Error;
use crate::system::ParticleSystem;
use crate::work::Work;

pub(crate) const METHOD: Method = Method {
    name: "implicit-midpoint",
    letter: Some('n'),
    aliases: &[],
    title: "implicit midpoint",
    order: 2,
    default_control: Control::Step(0.01),
    evaluations: 3,
    damped_evaluations: 3,
    view: View::Tangent,
    create: Create::Step(|system| {
        Box::new(ImplicitMidpoint {
            stage: StageSolver::new(system),
            base: vec![0.0; system.dim()],
            end: vec![0.0; system.dim()],
            part: vec![0.0; system.dim()],
        })
    }),
};

struct ImplicitMidpoint {
    stage: StageSolver,
    base: Vec<f64>,
    /// End of the step without the part that is added to its beginning, and that part.
    end: Vec<f64>,
    part: Vec<f64>,
}

impl Divisible for ImplicitMidpoint {
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
        let Self { stage, base, end, part } = self;
        base.copy_from_slice(y);
        let half = 0.5 * h;
        *work += stage.solve(system, t + half, half, base, y, Newton::Mirrored)?;
        if stage.is_joined() {
            let middle = base.len() / 2;
            for ((end, y), base) in end.iter_mut().zip(&*y).zip(&*base) {
                *end = 2.0 * y - base;
            }
            system.hold(t + h, end);
            part.copy_from_slice(end);
            stage.project(system, end);
            for (part, end) in part.iter_mut().zip(&*end) {
                *part = 0.5 * (*part - end);
            }
            // Of that part, what the constraints do not allow at the beginning.
            base[middle..].iter_mut().zip(&part[middle..]).for_each(|(v, part)| *v += part);
            part[..middle].copy_from_slice(&base[..middle]);
            stage.project(system, part);
            base[middle..].iter_mut().zip(&part[middle..]).for_each(|(v, part)| *v -= part);
            *work += stage.solve(system, t + half, half, base, y, Newton::Mirrored)?;
        }
        for (y, base) in y.iter_mut().zip(&*base) {
            *y = 2.0 * *y - base;
        }
        system.hold(t + h, y);
        stage.project(system, y);
        Ok(())
    }
}
