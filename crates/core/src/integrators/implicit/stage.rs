//! The solver of the implicit stages of a system, by the kind of the system.

use super::dense::Dense;
use super::joined::project;
use super::mechanical::Mechanical;
use super::newton::Newton;
use crate::error::Error;
use crate::refusal::Refusal;
use crate::system::{Mechanics, ParticleSystem, rigid_of};
use crate::work::Work;

/// Solver of the implicit stages of one system.
pub(super) enum StageSolver {
    /// Solver for a linearised mechanical system.
    Mechanical(Box<Mechanical>),
    /// Solver for any other system.
    Dense(Box<Dense>),
}

impl StageSolver {
    pub(super) fn new(system: &dyn ParticleSystem) -> Self {
        match system.mechanics().and_then(Mechanics::linearized) {
            Some(linearized) => Self::Mechanical(Box::new(Mechanical::new(linearized))),
            None => Self::Dense(Box::new(Dense::new(system))),
        }
    }

    /// Solves y = base + a f(t, y), starting from the guess y.
    pub(super) fn solve(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        a: f64,
        base: &[f64],
        y: &mut [f64],
        newton: Newton,
    ) -> Result<Work, Error> {
        match (self, system.mechanics().and_then(Mechanics::linearized)) {
            (Self::Mechanical(stage), Some(linearized)) => {
                stage.solve(linearized, t, a, base, y, newton)
            }
            (Self::Dense(stage), _) => stage.solve(system, t, a, base, y, newton),
            (Self::Mechanical(_), None) => {
                Err(Error::Unsupported { method: "the implicit method", why: Refusal::LacksMasses })
            }
        }
    }

    /// Returns room for a state, which is to be given back.
    pub(super) fn take_begun(&mut self) -> Vec<f64> {
        match self {
            Self::Mechanical(_) => vec![],
            Self::Dense(stage) => std::mem::take(&mut stage.begun),
        }
    }

    /// Takes the room for a state back.
    pub(super) fn give_back(&mut self, begun: Vec<f64>) {
        if let Self::Dense(stage) = self {
            stage.begun = begun;
        }
    }

    /// Returns the work of the solutions that failed since the last call.
    pub(super) fn take_spent(&mut self) -> Work {
        match self {
            Self::Mechanical(_) => Work::default(),
            Self::Dense(stage) => std::mem::take(&mut stage.spent),
        }
    }

    /// Returns whether there are constraints.
    pub(super) fn is_joined(&self) -> bool {
        matches!(self, Self::Mechanical(stage) if stage.joined.is_some())
    }

    /// Moves a state to where all joints of rigid bodies are met and stay so: the stages do not.
    pub(super) fn project_bodies(&self, system: &dyn ParticleSystem, y: &mut [f64]) {
        if let (Self::Dense(_), Some(rigid)) = (self, rigid_of(system)) {
            rigid.project(y);
        }
    }

    /// Moves a state to where all constraints are met and stay so.
    pub(super) fn project(&self, system: &dyn ParticleSystem, y: &mut [f64]) {
        self.project_bodies(system, y);
        let linearized = system.mechanics().and_then(Mechanics::linearized);
        if let (Self::Mechanical(_), Some(linearized)) = (self, linearized) {
            project(linearized, y.split_at_mut(y.len() / 2).into());
        }
    }
}
