//! Reasons why a method does not support a system.

use std::fmt;

/// Reason why a method does not support a system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The system has no masses, and thus no forces.
    LacksMasses,
    /// Rigid bodies rotate, by equations of first order.
    Rotates,
    /// Constraints hold particles.
    HoldsConstraints,
    /// Constraints hold particles, and surfaces touch.
    HoldsTouching,
    /// Particles also act on others than their neighbours, as in fluids, through a shared density.
    HidesCouplings,
    /// Forces between particles are not linear springs.
    LacksSprings,
    /// Forces depend on the velocity, other than by drag.
    ReadsVelocity,
    /// The system has a mass matrix, M y' = f(t, y).
    HasMassMatrix,
    /// Masses and springs, or rigid bodies, have a Jacobian that is no small matrix.
    NotPlain,
    /// The system is too large for the Jacobian of its f.
    TooLarge {
        /// Numbers of its state.
        numbers: usize,
        /// Largest number of them.
        most: usize,
    },
    /// The system is large, and its Jacobian is not sparse enough.
    TooDense {
        /// Numbers of its state.
        numbers: usize,
        /// Largest number of them in a system in which each may act on all.
        most: usize,
    },
}

/// Advice if forces depend on the velocity.
pub(crate) const USE_ANOTHER: &str = "with wind, air, friction, damped springs, viscous fluids \
    or constraints, use another explicit solver";

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LacksMasses => {
                f.write_str("needs forces and masses, but this system is of first order")
            }
            Self::Rotates => f.write_str(
                "does not support rigid bodies, whose rotation is not x'' = F / m: use another \
                 solver",
            ),
            Self::HoldsConstraints => {
                f.write_str("does not support constraints: use an explicit solver")
            }
            Self::HoldsTouching => f.write_str(
                "does not support constraints where surfaces touch: use an explicit solver",
            ),
            Self::HidesCouplings => f.write_str(
                "does not support fluids and amounts of gas, whose particles act on others than \
                 their neighbours: use an explicit solver",
            ),
            Self::LacksSprings => f.write_str(
                "solves spring by spring, but some forces between particles are not those of \
                 linear springs: use another solver",
            ),
            Self::ReadsVelocity => write!(
                f,
                "supports no forces that depend on the velocity, except drag: {USE_ANOTHER}"
            ),
            Self::NotPlain => f.write_str(
                "serves systems y' = f(t, y) of plain numbers, neither networks nor rigid bodies: use \
                 bdf",
            ),
            Self::HasMassMatrix => f.write_str(
                "solves y' = f(t, y), but this system has a mass matrix, M y' = f(t, y): use radau \
                 or bdf to a tolerance",
            ),
            Self::TooLarge { numbers, most } => write!(
                f,
                "computes the Jacobian of such a system by differences, for a state of up to {most} \
                 numbers, but this one has {numbers}: use an explicit solver"
            ),
            Self::TooDense { numbers, most } => write!(
                f,
                "needs the Jacobian of this system of {numbers} numbers, which is neither small (up \
                 to {most} numbers) nor sparse enough: use an explicit solver"
            ),
        }
    }
}
