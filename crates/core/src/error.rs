//! Errors of the crate, with messages for the user who has to correct them.

use std::fmt;

use nalgebra::Vector3;

use crate::control::Control;
use crate::refusal::{Refusal, USE_ANOTHER};

/// Reason why something could not be built or stepped.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// Invalid value; the message names it and says what would be valid.
    Invalid(String),
    /// Method that does not support a system.
    Unsupported {
        /// Full title of the method.
        method: &'static str,
        /// Property of the system that the method does not support.
        why: Refusal,
    },
    /// State whose length is not that of the system.
    Dimension {
        /// Length of the system's state (numbers).
        expected: usize,
        /// Length of the state that was given (numbers).
        found: usize,
    },
    /// Failure of an adaptive method: no step, however short, meets the tolerance.
    StepTooSmall {
        /// Time at the beginning of the step (s).
        time: f64,
        /// Step at which the search for a shorter one ended (s).
        step: f64,
    },
    /// Derivative that is not finite, so that no step can follow.
    NotFinite {
        /// Time at the beginning of the step (s).
        time: f64,
        /// Index of the first such component.
        component: usize,
    },
    /// Failure of an implicit method: the equations of a step were not solved.
    NoConvergence {
        /// Size of the last Newton correction over that of the first; 1 if its linear system could
        /// not be solved.
        residual: f64,
    },
    /// Run that blew up.
    BlowUp(BlowUp),
    /// Failure of a function of an own system or an own method, in its words.
    Callback(String),
}

/// Blow-up of a run: the method, the time and the cause.
///
/// ```
/// use a3_core::{Control, Error, Ode, Scene, Simulation, integrators};
///
/// // Explicit Euler on y' = -50 y is stable up to a step of 0.04 s.
/// let decay = Ode::new(1, |_t, y, dydt| dydt[0] = -50.0 * y[0])?;
/// let euler = integrators::find("euler").unwrap();
/// let scene = Scene::new("decay", decay, vec![1.0]);
/// let mut run = Simulation::new(scene, euler, Control::Step(0.1))?;
/// let Err(Error::BlowUp(lost)) = run.advance_to(100.0) else { panic!("it holds") };
/// assert!(lost.step > 10 && run.blow_up() == Some(lost));
/// # Ok::<(), a3_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlowUp {
    /// Full title of the method.
    pub method: &'static str,
    /// Step or tolerance of the run.
    pub control: Control,
    /// Number of steps taken, the failed one included.
    pub step: u64,
    /// Time at the end of the failed step (s).
    pub time: f64,
    /// Cause of the blow-up.
    pub cause: Cause,
}

/// Cause of a blow-up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// Particle that is far outside the scene.
    Away {
        /// Index of the first such particle.
        particle: usize,
        /// Distance of the particle from the centre of the scene (m).
        distance: f64,
    },
    /// Energy that nothing put into the run, far more than the scene has: the step is too long.
    Gained {
        /// The energy (J).
        energy: f64,
        /// Index of the fastest particle.
        particle: usize,
        /// Speed of that particle (m/s).
        speed: f64,
    },
    /// Particle whose position, velocity or acceleration is not finite.
    NotFinite {
        /// Index of the first such particle.
        particle: usize,
    },
    /// Number of a state without particles that is not finite, or whose rate of change is not.
    NumberNotFinite {
        /// Index of the first such number.
        index: usize,
    },
    /// Failure of an adaptive method: no step meets its tolerance.
    StepTooSmall {
        /// Step at which the search for a shorter one ended (s).
        step: f64,
    },
    /// Failure of an implicit method: the equations of a step were not solved.
    NoConvergence {
        /// Size of the last Newton correction over that of the first; 1 if its linear system could
        /// not be solved.
        residual: f64,
    },
    /// Force that depends on the velocity, which the method does not support.
    ReadsVelocity,
    /// Jacobian that an implicit method needs, which is neither small nor sparse enough.
    TooDense {
        /// Numbers of the state.
        numbers: usize,
        /// Largest number of them in a system in which each may act on all.
        most: usize,
    },
    /// Run that was given up, because it takes more work than its comparison is worth.
    TooCostly {
        /// Largest work of a run (evaluations).
        most: f64,
    },
    /// Constraint with a large error.
    Unmet(Unmet),
    /// Constraint that cannot be met with any step: it contradicts others, or pins.
    Contradiction(Unmet),
    /// Surfaces that move as prescribed, with pins or as obstacles, and leave no room for what is
    /// between them.
    Pinched {
        /// Vertices on either side.
        vertices: [Vertex; 2],
    },
}

/// Error of a constraint, as a share of its length, from which on it is visible.
const VISIBLE_SHARE: f64 = 0.01;

/// Constraint that is not met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unmet {
    /// Number of the constraint, counted from 0.
    pub number: usize,
    /// Name of the constraint.
    pub constraint: ConstraintName,
    /// Error over the length of a rod, over the radius of a circle or of a sphere, or over the
    /// radius of the scene.
    pub share: f64,
}

impl Unmet {
    /// Returns whether the error is large enough to be seen: 1 % or more.
    #[must_use]
    pub fn is_visible(&self) -> bool {
        self.share >= VISIBLE_SHARE
    }
}

/// Name of a constraint, by its kind and its particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConstraintName {
    pub(crate) kind: &'static str,
    pub(crate) particle: usize,
    /// Particle at the other end of a rod.
    pub(crate) other: Option<usize>,
}

impl fmt::Display for ConstraintName {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { kind, particle, .. } = self;
        match self.other {
            None => write!(f, "the {kind} of particle {particle}"),
            Some(other) => write!(f, "the {kind} between particles {particle} and {other}"),
        }
    }
}

impl fmt::Display for Unmet {
    /// Writes the number and the name of the constraint.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "constraint {}, {}", self.number, self.constraint)
    }
}

/// Vertex of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Vertex {
    /// Index of a particle.
    Particle(usize),
    /// Index of the rigid body that it belongs to.
    Body(usize),
    /// Index of the obstacle that it belongs to.
    Obstacle(usize),
}

impl fmt::Display for Vertex {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Particle(i) => write!(f, "particle {i}"),
            Self::Body(k) => write!(f, "body {k}"),
            Self::Obstacle(k) => write!(f, "obstacle {k}"),
        }
    }
}

/// Writes that an implicit method did not solve the equations of a step.
fn not_solved(residual: f64, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    f.write_str("the equations of the step were not solved")?;
    if residual.is_finite() {
        write!(f, " (relative residual {residual:.1e})")
    } else {
        f.write_str(": their numbers are not finite")
    }
}

/// Number that is written with three significant digits.
#[derive(Clone, Copy, Debug)]
pub struct Rounded(pub f64);

impl fmt::Display for Rounded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounded = format!("{:.2e}", self.0);
        match rounded.parse::<f64>() {
            Ok(x) if x == 0.0 || (1e-4..1e7).contains(&x.abs()) => write!(f, "{x}"),
            _ => f.write_str(&rounded),
        }
    }
}

impl fmt::Display for BlowUp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { step, time, cause, .. } = self;
        write!(f, "blew up at step {step}, t = {time:.4} s: ")?;
        match cause {
            Cause::Away { particle, distance } => {
                write!(f, "particle {particle} is {} m away", Rounded(*distance))
            }
            Cause::Gained { energy, particle, speed } => write!(
                f,
                "it gained {} J that nothing put in, and particle {particle} moves at {} m/s",
                Rounded(*energy),
                Rounded(*speed)
            ),
            Cause::NotFinite { particle } => {
                write!(
                    f,
                    "the position, velocity or acceleration of particle {particle} is not finite"
                )
            }
            Cause::NumberNotFinite { index } => {
                write!(f, "number {index} of the state, or its rate of change, is not finite")
            }
            Cause::StepTooSmall { step } => {
                write!(f, "no step meets the tolerance, not even one of {step:.1e} s")
            }
            Cause::NoConvergence { residual } => not_solved(*residual, f),
            Cause::ReadsVelocity => {
                write!(f, "forces must not depend on the velocity, except by drag: {USE_ANOTHER}")
            }
            &Cause::TooDense { numbers, most } => {
                write!(f, "the solver {}", Refusal::TooDense { numbers, most })
            }
            Cause::TooCostly { most } => {
                write!(f, "it takes more than {most:.0} evaluations")
            }
            Cause::Unmet(unmet) => {
                write!(f, "{unmet}, is off by {:.0} %", 100.0 * unmet.share)
            }
            Cause::Contradiction(unmet) => write!(
                f,
                "{unmet}, contradicts other constraints or pins: no positions meet them all"
            ),
            Cause::Pinched { vertices: [a, b] } => write!(
                f,
                "surfaces are pinched: pins or moving obstacles leave no room between {a} and {b}"
            ),
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Invalid(what) | Self::Callback(what) => f.write_str(what),
            Self::Unsupported { method, why } => write!(f, "{method} {why}"),
            Self::Dimension { expected, found } => {
                write!(f, "the state has {found} numbers, but the system needs {expected}")
            }
            Self::StepTooSmall { time, step } => write!(
                f,
                "no step meets the tolerance at t = {time:.4} s, not even one of {step:.1e} s: use a larger tolerance"
            ),
            Self::NotFinite { time, component } => write!(
                f,
                "component {component} of the derivative is not finite at t = {time:.4} s"
            ),
            Self::NoConvergence { residual } => not_solved(*residual, f),
            Self::BlowUp(blow_up) => blow_up.fmt(f),
        }
    }
}

impl std::error::Error for Error {}

impl From<BlowUp> for Error {
    fn from(blow_up: BlowUp) -> Self {
        Self::BlowUp(blow_up)
    }
}

/// Checks that `value` is finite and at least `low`; the error names it.
pub(crate) fn at_least(low: f64, what: &str, value: f64) -> Result<(), Error> {
    if value.is_finite() && value >= low {
        Ok(())
    } else {
        Err(Error::Invalid(format!(
            "{what} must be a finite number of at least {low}, not {value}"
        )))
    }
}

/// Checks that `value` is from 0 to 1; the error names it.
pub(crate) fn share(what: &str, value: f64) -> Result<(), Error> {
    if (0.0..=1.0).contains(&value) {
        Ok(())
    } else {
        Err(Error::Invalid(format!("{what} must be a number from 0 to 1, not {value}")))
    }
}

/// Checks that `value` is finite and above zero; the error names it.
pub(crate) fn positive(what: &str, value: f64) -> Result<(), Error> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(Error::Invalid(format!("{what} must be a finite number above 0, not {value}")))
    }
}

/// Checks that all three numbers are finite; the error names them.
pub(crate) fn finite(what: &str, vector: Vector3<f64>) -> Result<(), Error> {
    if vector.iter().all(|x| x.is_finite()) {
        Ok(())
    } else {
        Err(Error::Invalid(format!(
            "{what} must be three finite numbers, not {}, {}, {}",
            vector.x, vector.y, vector.z
        )))
    }
}
