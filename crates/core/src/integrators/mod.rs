//! Integrators: one file a method, and the table of all methods. An integrator sees flat arrays and
//! knows no physics.

mod adaptive;
mod dop853;
mod dormand_prince;
mod embedded;
mod error_norm;
mod euler;
mod heun;
mod implicit;
mod midpoint;
mod pefrl;
mod rk4;
mod rkf45;
mod runge_kutta;
mod splitting;
mod sweep;
mod symplectic_euler;
mod verlet;

use crate::control::Control;
use crate::error::{Error, positive};
use crate::system::{Mechanics, ParticleSystem};

pub use crate::work::Work;
pub use adaptive::{Adaptive, AdaptiveState, Taken};
pub use embedded::Tableau;
pub use error_norm::Tolerance;

/// A method with scratch for one system, which advances its state.
pub trait Integrator: Send {
    /// Takes y from time t to t + h (s): a pure function of the arguments, which allocates nothing.
    /// Returns the work.
    ///
    /// # Errors
    /// The system is another than the one the integrator was made for: its state has another
    /// length, or it lacks the forces and masses the method needs.
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error>;
}

/// A row of the table of methods.
#[derive(Debug)]
pub struct Method {
    /// Name, as typed on the command line.
    pub name: &'static str,
    /// Short name, one letter.
    pub letter: char,
    /// Other names, as typed on the command line.
    pub aliases: &'static [&'static str],
    /// Full name, for titles and tables.
    pub title: &'static str,
    /// Order: the power of h with which the global error falls.
    pub order: u32,
    /// The step, or the tolerance of an adaptive method, that is stable on every built-in scene.
    pub default_control: Control,
    /// Number of evaluations a step takes; the typical number, for an implicit method.
    pub evaluations: u32,
    /// Number of evaluations a step takes where springs are damped.
    pub damped_evaluations: u32,
    /// Whether the method solves equations for its step, with linear algebra on top of the
    /// evaluations.
    pub implicit: bool,
    /// Tableau of an adaptive method, which chooses its steps by itself, to a tolerance.
    pub pair: Option<&'static Tableau>,
    /// Whether the method needs forces and masses, rather than any f(t, y).
    pub needs_mechanics: bool,
    create: fn(system: &dyn ParticleSystem) -> Box<dyn Integrator>,
}

impl Method {
    /// `Ok` if the method serves this system.
    ///
    /// # Errors
    /// The method needs forces and masses, and the system has none; or it is implicit, and the
    /// system has constraints.
    pub fn check(&self, system: &dyn ParticleSystem) -> Result<(), Error> {
        match system.mechanics() {
            None if self.needs_mechanics => Err(Error::NeedsMechanics { method: self.name }),
            Some(mechanics) if self.implicit && holds_constraints(mechanics) => {
                Err(Error::Invalid(format!(
                    "{} does not support constraints: use an explicit solver",
                    self.title
                )))
            }
            _ => Ok(()),
        }
    }

    /// An integrator with scratch for this system.
    ///
    /// # Errors
    /// As [`check`](Self::check).
    pub fn integrator(&self, system: &dyn ParticleSystem) -> Result<Box<dyn Integrator>, Error> {
        self.check(system)?;
        Ok((self.create)(system))
    }

    /// The method with steps of its own choice; `None` if it estimates no error.
    #[must_use]
    pub fn adaptive(&self, system: &dyn ParticleSystem, tolerance: Tolerance) -> Option<Adaptive> {
        self.pair
            .map(|tableau| Adaptive::new(tableau, system.dim(), tolerance))
    }

    /// Whether the method can choose its steps by itself, to a tolerance.
    #[must_use]
    pub fn is_adaptive(&self) -> bool {
        self.pair.is_some()
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

    /// Control by a number as users type it: the tolerance of an adaptive method, the step (s) of
    /// any other.
    #[must_use]
    pub fn control(&self, value: f64) -> Control {
        if self.is_adaptive() {
            Control::Tolerance(value)
        } else {
            Control::Step(value)
        }
    }
}

/// Methods are the same if their names are.
impl PartialEq for Method {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// Whether forces of constraints, which implicit methods cannot solve with, are among those of the
/// system.
fn holds_constraints(mechanics: &dyn Mechanics) -> bool {
    let linearized = mechanics.linearized();
    linearized.is_some_and(|linearized| linearized.baumgarte_frequency().is_some())
}

/// Every method.
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
];

/// The method with this letter, name or alias.
#[must_use]
pub fn find(name: &str) -> Option<&'static Method> {
    METHODS
        .iter()
        .find(|m| name.chars().eq([m.letter]) || m.name == name || m.aliases.contains(&name))
}

/// `Ok` if `y` has the length `expected`.
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
fn add_scaled(y: &mut [f64], h: f64, k: &[f64]) {
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
