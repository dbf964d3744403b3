//! Methods of integration: one file for each, and one table of all. An integrator sees flat arrays
//! and knows no physics.

mod adaptive;
mod dop853;
mod dormand_prince;
mod dprkn1210;
mod dprkn1210_dense;
mod dprkn86;
mod embedded;
mod error_norm;
mod euler;
mod heun;
mod implicit;
mod midpoint;
mod nystrom;
mod pefrl;
mod prediction;
mod rk4;
mod rkf45;
mod runge_kutta;
mod splitting;
mod srkn11;
mod sweep;
mod symplectic_euler;
mod trial;
mod vbd;
mod verlet;
mod verner65;
mod xpbd;

use crate::control::Control;
use crate::error::{Error, positive};
use crate::system::{Linearized, Mechanics, ParticleSystem};
use trial::Trial;

pub use crate::work::Work;
pub use adaptive::{Adaptive, AdaptiveState, Taken};
pub use error_norm::Tolerance;
pub use implicit::bdf_growth;

/// Integrator of a system: a method with its scratch.
pub trait Integrator: Send {
    /// Takes the state y from t to t + h (s), and returns the work. The result depends on the
    /// arguments alone. Allocates nothing.
    ///
    /// # Errors
    /// The length of the state is not that of the system, the system lacks the forces and masses
    /// that the method needs, or the equations of an implicit method were not solved.
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error>;
}

/// Constructor of what takes the steps of a method on a system.
type Create<T> = fn(system: &dyn ParticleSystem) -> Box<T>;

/// Row of the table of methods.
#[derive(Debug)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "each is a column of the table, and says of its own what a method needs"
)]
pub struct Method {
    /// Name, as typed on the command line.
    pub name: &'static str,
    /// Short name, of one letter.
    pub letter: char,
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
    /// Whether the method is implicit: a step solves equations, by linear algebra in addition to
    /// the evaluations.
    pub implicit: bool,
    /// Whether the method needs forces and masses, and does not support an arbitrary f(t, y).
    pub needs_mechanics: bool,
    /// Whether the method serves only forces that depend on positions and time, drag aside.
    pub positions_only: bool,
    /// Whether the method solves spring by spring, by a fixed number of iterations in a step, and
    /// supports no other couplings of particles. Its springs are then softer than they should be in
    /// a long step, even where the motion is slow.
    pub needs_springs: bool,
    /// Constructor of the method's integrator.
    create: Create<dyn Integrator>,
    /// Constructor of the steps of an adaptive method, which chooses them by itself to a tolerance;
    /// `None` for other methods.
    trial: Option<Create<dyn Trial>>,
}

impl Method {
    /// `Ok` if the method supports this system.
    ///
    /// # Errors
    /// The method needs forces and masses, and the system has none; it serves only forces that do
    /// not depend on the velocity, and others act; it is implicit, and the system has constraints
    /// or does not list all its couplings; or it solves spring by spring, and the system does not
    /// list its springs.
    pub fn check(&self, system: &dyn ParticleSystem) -> Result<(), Error> {
        let splits = !self.positions_only && !self.needs_springs;
        match system.mechanics() {
            None if system.rigid().is_some() && self.needs_mechanics && splits => Ok(()),
            None if system.rigid().is_some() && self.needs_mechanics => {
                Err(Error::Invalid(format!(
                    "{} does not support rigid bodies, whose rotation is no x'' = F / m: use \
                     another solver",
                    self.title
                )))
            }
            None if self.needs_mechanics => Err(Error::NeedsMechanics { method: self.name }),
            Some(mechanics) if self.implicit && holds_constraints(mechanics) => {
                Err(Error::Invalid(format!(
                    "{} does not support constraints: use an explicit solver",
                    self.title
                )))
            }
            Some(mechanics) if self.implicit && !lists_all_couplings(mechanics) => {
                Err(Error::Invalid(format!(
                    "{} does not support fluids, each of whose particles acts on its neighbours' \
                     neighbours: use an explicit solver",
                    self.title
                )))
            }
            Some(mechanics) if self.needs_springs && mechanics.compliant().is_none() => {
                Err(Error::Invalid(format!(
                    "{} solves spring by spring, but here are forces between particles that are \
                     no linear springs: use another solver",
                    self.title
                )))
            }
            Some(_) if self.positions_only => nystrom::check(self.title, system),
            _ if self.implicit => implicit::check(system),
            _ => Ok(()),
        }
    }

    /// Integrator with scratch for this system.
    ///
    /// # Errors
    /// The method does not support the system, see [`check`](Self::check).
    pub fn integrator(&self, system: &dyn ParticleSystem) -> Result<Box<dyn Integrator>, Error> {
        self.check(system)?;
        Ok((self.create)(system))
    }

    /// Whether its integrator is that of another method, by which it takes all fixed steps.
    #[must_use]
    pub fn shares_integrator(&self, other: &Self) -> bool {
        std::ptr::fn_addr_eq(self.create, other.create)
    }

    /// Integrator that chooses its steps to this tolerance; `None` if the method estimates no
    /// error.
    #[must_use]
    pub fn adaptive(&self, system: &dyn ParticleSystem, tolerance: Tolerance) -> Option<Adaptive> {
        self.trial
            .map(|create| Adaptive::new(create(system), tolerance))
    }

    /// Whether the method can choose its steps by itself, to a tolerance.
    #[must_use]
    pub fn is_adaptive(&self) -> bool {
        self.trial.is_some()
    }

    /// `Ok` if the method can be controlled like this.
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

    /// Control from a number that a user types: the tolerance of an adaptive method, the step (s)
    /// of any other.
    #[must_use]
    pub fn control(&self, value: f64) -> Control {
        if self.is_adaptive() {
            Control::Tolerance(value)
        } else {
            Control::Step(value)
        }
    }
}

/// Methods are equal if their names are.
impl PartialEq for Method {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// Whether the system has constraints, which implicit methods do not support.
fn holds_constraints(mechanics: &dyn Mechanics) -> bool {
    let linearized = mechanics.linearized();
    linearized.is_some_and(|linearized| linearized.baumgarte_frequency().is_some())
}

/// Whether the system lists all couplings of its particles, which implicit methods solve with.
fn lists_all_couplings(mechanics: &dyn Mechanics) -> bool {
    let linearized = mechanics.linearized();
    linearized.is_none_or(Linearized::lists_all_couplings)
}

/// Table of all methods.
pub static METHODS: &[Method] = &[
    euler::METHOD,
    heun::METHOD,
    midpoint::METHOD,
    rk4::METHOD,
    symplectic_euler::METHOD,
    verlet::METHOD,
    pefrl::METHOD,
    dormand_prince::METHOD,
    dop853::METHOD,
    implicit::EULER,
    rkf45::METHOD,
    implicit::TR_BDF2,
    implicit::MIDPOINT,
    verner65::METHOD,
    srkn11::METHOD,
    dprkn86::METHOD,
    dprkn1210::METHOD,
    implicit::BDF,
    xpbd::METHOD,
    xpbd::TEN,
    vbd::METHOD,
];

/// Method with this letter, name or alias.
#[must_use]
pub fn find(name: &str) -> Option<&'static Method> {
    METHODS
        .iter()
        .find(|m| name.chars().eq([m.letter]) || m.name == name || m.aliases.contains(&name))
}

/// `Ok` if `y` has the length `expected`, else [`Error::Dimension`].
fn check_dim(expected: usize, y: &[f64]) -> Result<(), Error> {
    if y.len() == expected {
        Ok(())
    } else {
        Err(Error::Dimension {
            expected,
            found: y.len(),
        })
    }
}

/// y += h k
pub(crate) fn add_scaled(y: &mut [f64], h: f64, k: &[f64]) {
    for (y, k) in y.iter_mut().zip(k) {
        *y += h * k;
    }
}

/// out = y + h k
fn scaled_sum(out: &mut [f64], y: &[f64], h: f64, k: &[f64]) {
    for ((out, y), k) in out.iter_mut().zip(y).zip(k) {
        *out = y + h * k;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn no_two_methods_share_a_name() {
        let mut seen = HashSet::new();
        for m in METHODS {
            for name in [m.name, &m.letter.to_string()]
                .into_iter()
                .chain(m.aliases.iter().copied())
            {
                assert!(
                    seen.insert(name.to_owned()),
                    "{name} stands for two methods"
                );
                assert!(std::ptr::eq(find(name).unwrap(), m));
            }
        }
        assert!(find("no such method").is_none());
    }
}
