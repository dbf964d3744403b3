//! Steps of a system of plain numbers, divided where their equations cannot be solved: the state at
//! the beginning is then too far from the one at the end for Newton's method to find it.

use super::stage::StageSolver;
use crate::error::Error;
use crate::system::{ParticleSystem, rigid_of};
use crate::work::Work;

/// Largest number of times that a step is halved. The jumps of van der Pol's oscillator with a
/// stiffness of 1e6 need 13 in steps of 0.01 s.
const MAX_HALVINGS: u32 = 16;

/// Method with implicit stages.
pub(super) trait Divisible {
    /// Returns the solver of its stages.
    fn stage(&mut self) -> &mut StageSolver;

    /// Takes a step of h (s) from time t (s) as a whole.
    fn whole(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error>;

    /// Takes a step of h (s) from time t (s): of plain numbers in parts, each half as long as one
    /// whose equations could not be solved, and longer again after that.
    fn divided(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        if !is_plain(self.stage(), system) {
            return self.whole(system, t, h, y);
        }
        let mut begun = self.stage().take_begun();
        let all = 1_u64 << MAX_HALVINGS;
        let (mut done, mut halvings, mut work) = (0, 0, Work::default());
        let taken = loop {
            let part = all >> halvings;
            let share = |part: u64| part as f64 / all as f64;
            begun.copy_from_slice(y);
            match self.whole(system, t + h * share(done), h * share(part), y) {
                Ok(own) => {
                    work += own;
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

/// Returns whether the numbers of a system are plain.
pub(super) fn is_plain(stage: &StageSolver, system: &dyn ParticleSystem) -> bool {
    matches!(stage, StageSolver::Dense(_)) && rigid_of(system).is_none()
}
