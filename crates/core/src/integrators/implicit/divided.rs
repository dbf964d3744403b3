//! Steps of a system of plain numbers, divided where their equations cannot be solved: the state at
//! the beginning is then too far from the one at the end for Newton's method to find it.

use super::super::integrator::{Integrator, check_dim};
use super::stage::StageSolver;
use crate::error::Error;
use crate::system::{ParticleSystem, rigid_of};
use crate::work::Work;

/// Largest number of times that a step is halved: a motion that needs shorter parts has no use for
/// steps of that length.
const MAX_HALVINGS: u32 = 16;

/// Method with implicit stages.
pub(super) trait Divisible: Send {
    /// Returns the solver of its stages.
    fn stage(&mut self) -> &mut StageSolver;

    /// Takes an undivided step of h (s) from time t (s), and adds the cost of the stages that were
    /// solved to `work`.
    fn whole(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
        work: &mut Work,
    ) -> Result<(), Error>;

    /// Takes a step of h (s) from time t (s): of plain numbers in parts, each half as long as one
    /// whose equations could not be solved, and longer again after that.
    fn divided(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        let mut work = Work::default();
        if !is_plain(self.stage(), system) {
            self.whole(system, t, h, y, &mut work)?;
            return Ok(work);
        }
        let mut begun = self.stage().take_begun();
        let all = 1_u64 << MAX_HALVINGS;
        let (mut done, mut halvings) = (0, 0);
        let taken = loop {
            let part = all >> halvings;
            let share = |part: u64| part as f64 / all as f64;
            begun.copy_from_slice(y);
            let begin = t + h * share(done);
            match self.whole(system, begin, h * share(part), y, &mut work) {
                Ok(()) => {
                    done += part;
                    if done == all {
                        break Ok(work);
                    }
                    if done.is_multiple_of(2 * part) {
                        halvings -= 1;
                    }
                }
                Err(Error::NoConvergence { .. }) if halvings < MAX_HALVINGS => {
                    work += self.stage().take_spent();
                    y.copy_from_slice(&begun);
                    halvings += 1;
                }
                Err(why) => break Err(why),
            }
        };
        self.stage().give_back(begun);
        taken
    }
}

impl<M: Divisible> Integrator for M {
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        check_dim(system.dim(), y)?;
        self.divided(system, t, h, y)
    }
}

/// Returns whether the numbers of a system are plain.
pub(super) fn is_plain(stage: &StageSolver, system: &dyn ParticleSystem) -> bool {
    matches!(stage, StageSolver::Dense(_)) && rigid_of(system).is_none()
}
