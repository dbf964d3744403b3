//! A method: its name, its order, the view of a system by which it takes its steps, and the
//! function that creates its integrator. Own methods are found by their names, beside those of the
//! table.

use std::fmt;
use std::sync::{PoisonError, RwLock};

use super::adaptive::Adaptive;
use super::derivative::Solve;
use super::embedded::{EmbeddedPair, Tableau};
use super::error_norm::Tolerance;
use super::integrator::Integrator;
use super::nystrom::{NystromPair, NystromTableau};
use super::own_trial::{Estimated, OwnTrial};
use super::splitting::Plan;
use super::sweep;
use super::sweep::RungeKutta;
use super::trial::Trial;
use crate::control::Control;
use crate::error::{Error, positive};
use crate::refusal::Refusal;
use crate::system::{Linearized, ParticleSystem, reads_velocity};

/// Largest state (numbers) for which implicit methods compute the Jacobian of f.
pub(super) const MAX_DENSE: usize = 1024;

/// Function of an own method that creates an integrator for a system.
type CreateOwn = dyn Fn(&dyn ParticleSystem) -> Box<dyn Integrator> + Send + Sync;

/// Source of a method's integrators.
#[derive(Clone, Copy)]
pub(super) enum Create {
    /// Runge-Kutta stages, each a function of the stage before it alone.
    RungeKutta(sweep::Table),
    /// Kicks and drifts.
    Kicks(&'static Plan),
    /// Embedded pair, whose trial steps it takes as they are where the step is fixed.
    Embedded(&'static Tableau),
    /// Embedded pair for accelerations.
    Nystrom(&'static NystromTableau),
    /// Function that creates an integrator for a system.
    Step(CreateStep),
    /// Function that creates an integrator of fixed steps, and one that creates trial steps.
    Adaptive(CreateStep, CreateTrial),
    /// Function of an own method.
    Own(&'static CreateOwn),
    /// Embedded pair of an own method.
    OwnPair(&'static Tableau),
    /// Function that takes a step and estimates its error.
    OwnTrial(&'static Estimated),
    /// Function that runs a whole span of time.
    Foreign(&'static Solve),
}

/// Function that creates an integrator for a system.
type CreateStep = fn(system: &dyn ParticleSystem) -> Box<dyn Integrator>;

/// Function that creates the trial steps of an adaptive method for a system.
type CreateTrial = fn(system: &dyn ParticleSystem) -> Box<dyn Trial>;

impl fmt::Debug for Create {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::RungeKutta(_) => "RungeKutta",
            Self::Kicks(_) => "Kicks",
            Self::Embedded(_) => "Embedded",
            Self::Nystrom(_) => "Nystrom",
            Self::Step(_) => "Step",
            Self::Adaptive(..) => "Adaptive",
            Self::Own(_) => "Own",
            Self::OwnPair(_) => "OwnPair",
            Self::OwnTrial(_) => "OwnTrial",
            Self::Foreign(_) => "Foreign",
        })
    }
}

/// View of a system that a method steps with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// The derivative f(t, y) of any system.
    Derivative,
    /// The derivative and its change with the state: a step solves equations.
    Tangent,
    /// The derivative and its whole Jacobian, as a matrix of plain numbers.
    Jacobian,
    /// Kicks of the velocities by forces, and drifts of the positions.
    Kicks,
    /// Kicks and drifts, and the change of the forces with the velocities: a kick solves equations.
    Damping,
    /// Accelerations that depend on positions and time alone, except for viscous drag.
    Accelerations,
    /// Springs one by one, solved by a fixed number of iterations in a step. In a long step the
    /// springs are then too soft, even where the motion is slow.
    Springs,
}

/// Method of integration: a row of the table of methods, or an own method, made by
/// [`new`](Self::new), [`from_step`](Self::from_step) or [`from_tableau`](Self::from_tableau).
#[derive(Debug)]
pub struct Method {
    /// Name, as typed on the command line.
    pub name: &'static str,
    /// Short name, of one letter; `None` for an own method.
    pub letter: Option<char>,
    /// Other names of the method.
    pub aliases: &'static [&'static str],
    /// Full title.
    pub title: &'static str,
    /// Order: the global error falls as h to this power.
    pub order: u32,
    /// Step, or tolerance of an adaptive method, that is stable on every built-in scene.
    pub default_control: Control,
    /// Number of evaluations in a step; a typical number for an implicit method.
    pub evaluations: u32,
    /// Number of evaluations in a step where springs are damped.
    pub damped_evaluations: u32,
    /// View of a system that the method steps with.
    pub view: View,
    /// Source of its integrators.
    pub(super) create: Create,
}

impl Method {
    /// Returns whether this is its letter, its name or one of its aliases.
    pub(super) fn is_called(&self, name: &str) -> bool {
        let is_letter = |letter: char| name.chars().eq([letter]);
        self.letter.is_some_and(is_letter) || self.name == name || self.aliases.contains(&name)
    }

    /// Returns whether a step solves equations for the positions, so that no stiffness limits its
    /// length.
    #[must_use]
    pub fn is_implicit(&self) -> bool {
        matches!(self.view, View::Tangent | View::Jacobian | View::Springs)
    }

    /// Returns whether a step solves linear systems in addition to the evaluations, if any force
    /// depends on the velocity.
    #[must_use]
    pub fn solves_linear_systems(&self) -> bool {
        matches!(self.view, View::Tangent | View::Jacobian | View::Damping)
    }

    /// Returns whether another method of the table takes the same steps on a system: implicit
    /// damping is velocity Verlet where no force of a kick depends on velocities.
    #[must_use]
    pub fn repeats_another(&self, system: &dyn ParticleSystem) -> bool {
        self.view == View::Damping && !reads_velocity(system)
    }

    /// Returns whether the method needs forces and masses, instead of an arbitrary f(t, y).
    #[must_use]
    pub fn needs_mechanics(&self) -> bool {
        !matches!(self.view, View::Derivative | View::Tangent | View::Jacobian)
    }

    /// Returns whether the method supports only forces that depend on positions and time, apart
    /// from drag.
    #[must_use]
    pub fn positions_only(&self) -> bool {
        self.view == View::Accelerations
    }

    /// Returns whether the method supports neither networks nor rigid bodies: it needs a small
    /// Jacobian, or a motion that f says whole.
    #[must_use]
    pub fn plain_only(&self) -> bool {
        self.view == View::Jacobian || self.is_foreign()
    }

    /// Returns whether the method, to a tolerance, solves M y' = f(t, y) with a [mass
    /// matrix](ParticleSystem::mass_matrix). A solver of another library has to know M.
    #[must_use]
    pub fn takes_mass_matrix(&self) -> bool {
        matches!(self.create, Create::Adaptive(..)) || self.is_foreign()
    }

    /// Returns whether the method solves spring by spring, and supports no other forces between
    /// particles.
    #[must_use]
    pub fn needs_springs(&self) -> bool {
        self.view == View::Springs
    }

    /// Checks that the method supports a system.
    ///
    /// # Errors
    /// The system lacks the method's view, see [`Refusal`].
    pub fn check(&self, system: &dyn ParticleSystem) -> Result<(), Error> {
        match self.refusal(system) {
            None => Ok(()),
            Some(why) => Err(Error::Unsupported { method: self.title, why }),
        }
    }

    /// Returns the reason why the method does not support a system; `None` if it does.
    #[must_use]
    pub fn refusal(&self, system: &dyn ParticleSystem) -> Option<Refusal> {
        if !system.mass_matrix().is_empty() && !self.takes_mass_matrix() {
            return Some(Refusal::HasMassMatrix);
        }
        let is_rigid = system.rigid().is_some();
        let is_network = || system.mechanics().is_some_and(|m| m.linearized().is_some());
        if self.is_foreign() && (is_rigid || is_network()) {
            return Some(Refusal::NotPlain);
        }
        let Some(mechanics) = system.mechanics() else {
            return match self.view {
                View::Jacobian if is_rigid => Some(Refusal::NotPlain),
                View::Tangent | View::Damping if is_rigid => refusal_by_size(system),
                View::Derivative | View::Tangent | View::Jacobian => None,
                View::Kicks if is_rigid => None,
                _ if is_rigid => Some(Refusal::Rotates),
                _ => Some(Refusal::LacksMasses),
            };
        };
        let linearized = mechanics.linearized();
        let holds_constraints =
            linearized.is_some_and(|linearized| linearized.baumgarte_frequency().is_some());
        let lists_all_couplings = linearized.is_none_or(Linearized::lists_all_couplings);
        let is_joined = linearized.is_some_and(|linearized| linearized.held().is_some());
        match self.view {
            View::Jacobian if linearized.is_some() || is_rigid => Some(Refusal::NotPlain),
            View::Springs if holds_constraints => Some(Refusal::HoldsConstraints),
            View::Tangent if holds_constraints && !is_joined => Some(refusal_of_joints(linearized)),
            View::Tangent | View::Springs if !lists_all_couplings => Some(Refusal::HidesCouplings),
            View::Springs if mechanics.compliant().is_none() => Some(Refusal::LacksSprings),
            View::Accelerations if !mechanics.is_positional() => Some(Refusal::ReadsVelocity),
            View::Accelerations if self.is_adaptive() && mechanics.is_rough() => {
                Some(Refusal::ReadsVelocity)
            }
            View::Tangent if linearized.is_none() && is_rigid => refusal_by_size(system),
            View::Damping if linearized.is_none() || holds_constraints => refusal_by_size(system),
            _ => None,
        }
    }

    /// Creates an integrator, with scratch, for this system.
    ///
    /// # Errors
    /// The method does not support the system, see [`check`](Self::check), or it takes no steps,
    /// see [`foreign`](Self::foreign).
    pub fn integrator(&self, system: &dyn ParticleSystem) -> Result<Box<dyn Integrator>, Error> {
        self.check(system)?;
        Ok(match self.create {
            Create::RungeKutta(table) => Box::new(RungeKutta::new(table, system)),
            Create::Kicks(plan) => plan.integrator(system),
            Create::Embedded(tableau) | Create::OwnPair(tableau) => {
                Box::new(EmbeddedPair::new(tableau, system.dim()))
            }
            Create::Nystrom(tableau) => Box::new(self.nystrom(tableau, system)),
            Create::Step(create) | Create::Adaptive(create, _) => create(system),
            Create::Own(create) => create(system),
            Create::OwnTrial(step) => Box::new(self.own_trial(step, system)),
            Create::Foreign(_) => {
                return Err(Error::Invalid(format!(
                    "{} runs whole spans of time, which a chart measures: it takes no steps",
                    self.title
                )));
            }
        })
    }

    fn nystrom(
        &self,
        tableau: &'static NystromTableau,
        system: &dyn ParticleSystem,
    ) -> NystromPair {
        NystromPair::new(self.title, tableau, system.dim())
    }

    fn own_trial(&self, step: &'static Estimated, system: &dyn ParticleSystem) -> OwnTrial {
        OwnTrial::new(self.name, self.order, step, system.dim())
    }

    /// Returns whether the method is not of the table, but made by the caller of this library.
    #[must_use]
    pub fn is_own(&self) -> bool {
        matches!(
            self.create,
            Create::Own(_) | Create::OwnPair(_) | Create::OwnTrial(_) | Create::Foreign(_)
        )
    }

    /// Returns whether the method is the solver of another library, see [`foreign`](Self::foreign).
    #[must_use]
    pub fn is_foreign(&self) -> bool {
        self.solve().is_some()
    }

    /// Returns the function that runs a whole span of time, if that is what the method has.
    pub(crate) fn solve(&self) -> Option<&'static Solve> {
        match self.create {
            Create::Foreign(solve) => Some(solve),
            _ => None,
        }
    }

    /// Returns whether both methods use the same integrator for fixed steps. Own methods share
    /// theirs with no other.
    #[must_use]
    pub fn shares_integrator(&self, other: &Self) -> bool {
        let fixed = |method: &Self| match method.create {
            Create::Step(create) | Create::Adaptive(create, _) => Some(create),
            _ => None,
        };
        let same = fixed(self).zip(fixed(other));
        self == other || same.is_some_and(|(own, other)| std::ptr::fn_addr_eq(own, other))
    }

    /// Creates an integrator that chooses its steps to this tolerance; `None` if the method
    /// estimates no error.
    #[must_use]
    pub fn adaptive(&self, system: &dyn ParticleSystem, tolerance: Tolerance) -> Option<Adaptive> {
        let trial: Box<dyn Trial> = match self.create {
            Create::Embedded(tableau) | Create::OwnPair(tableau) => {
                Box::new(EmbeddedPair::new(tableau, system.dim()))
            }
            Create::Nystrom(tableau) => Box::new(self.nystrom(tableau, system)),
            Create::Adaptive(_, create) => create(system),
            Create::OwnTrial(step) => Box::new(self.own_trial(step, system)),
            _ => return None,
        };
        Some(Adaptive::new(trial, tolerance))
    }

    /// Returns whether the method can choose its steps by itself, to a tolerance.
    #[must_use]
    pub fn is_adaptive(&self) -> bool {
        matches!(
            self.create,
            Create::Embedded(_)
                | Create::Nystrom(_)
                | Create::Adaptive(..)
                | Create::OwnPair(_)
                | Create::OwnTrial(_)
                | Create::Foreign(_)
        )
    }

    /// Checks that the method supports a control.
    ///
    /// # Errors
    /// The value is not a finite number above 0, or it is a tolerance and the method estimates no
    /// error.
    pub fn check_control(&self, control: Control) -> Result<(), Error> {
        match control {
            Control::Step(step) => positive("the step", step),
            Control::Tolerance(relative) if self.is_adaptive() => {
                Tolerance::new(relative).map(|_| ())
            }
            Control::Tolerance(_) => Err(Error::Invalid(format!(
                "{} estimates no error: it takes a step, not a tolerance",
                self.title
            ))),
        }
    }

    /// Creates a control from a number that a user types: the tolerance of an adaptive method, the
    /// step (s) of any other.
    #[must_use]
    pub fn control(&self, value: f64) -> Control {
        if self.is_adaptive() { Control::Tolerance(value) } else { Control::Step(value) }
    }
}

/// Methods are equal if their names are.
impl PartialEq for Method {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// Returns the refusal of a system with constraints that offers no view of them.
fn refusal_of_joints(system: Option<&dyn Linearized>) -> Refusal {
    let touches = system.is_some_and(|system| !system.hints().pattern_is_fixed());
    if touches { Refusal::HoldsTouching } else { Refusal::HoldsConstraints }
}

/// Returns the refusal of a system that is too large for the Jacobian of its f, if it is.
fn refusal_by_size(system: &dyn ParticleSystem) -> Option<Refusal> {
    let mut numbers = 0;
    system.measures(&mut |of, _| numbers += of.len());
    (numbers > MAX_DENSE).then_some(Refusal::TooLarge { numbers, most: MAX_DENSE })
}

/// Own methods, in the order in which they were added.
static OWN: RwLock<Vec<&'static Method>> = RwLock::new(vec![]);

/// Adds an own method. If another one has its name, the new one takes its place.
pub(super) fn add_own(method: &'static Method) {
    let mut own = OWN.write().unwrap_or_else(PoisonError::into_inner);
    own.retain(|other| *other != method);
    own.push(method);
}

/// Returns the own method with this name, if there is one.
pub(super) fn find_own(name: &str) -> Option<&'static Method> {
    let own = OWN.read().unwrap_or_else(PoisonError::into_inner);
    own.iter().copied().find(|method| method.name == name)
}
