//! What can go wrong, in words for the one who has to mend it.

use std::fmt;

/// Why something could not be built or stepped.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A number that makes no sense; says which, and what would be right.
    Invalid(String),
    /// The method needs forces and masses, and the system has none.
    NeedsMechanics {
        /// Name of the method.
        method: &'static str,
    },
    /// The state has another length than the system's.
    Dimension {
        /// Length of the system's state.
        expected: usize,
        /// Length of the one that was given.
        found: usize,
    },
    /// The run left every reasonable bound.
    BlowUp(BlowUp),
}

/// Where a run was lost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlowUp {
    /// The method that lost it, in full.
    pub method: &'static str,
    /// Its step (s).
    pub step_size: f64,
    /// Steps taken, the bad one included.
    pub step: u64,
    /// Time at its end (s).
    pub time: f64,
    /// The first particle that is lost.
    pub particle: usize,
    /// Its distance from the middle of the scene (m); not finite if the state is not.
    pub distance: f64,
}

impl fmt::Display for BlowUp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            step,
            time,
            particle,
            distance,
            ..
        } = self;
        write!(
            f,
            "blew up at step {step}, t = {time:.4} s: particle {particle} "
        )?;
        if distance.is_finite() {
            write!(f, "is {distance:.0} m away")
        } else {
            write!(f, "is no longer a finite number")
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Invalid(what) => f.write_str(what),
            Self::NeedsMechanics { method } => {
                write!(
                    f,
                    "{method} needs forces and masses, and this system is first order"
                )
            }
            Self::Dimension { expected, found } => {
                write!(
                    f,
                    "the state has {found} numbers, and {expected} were expected"
                )
            }
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

/// `Ok` if `value` is finite and at least `low`, else an error that names it.
pub(crate) fn at_least(low: f64, what: &str, value: f64) -> Result<(), Error> {
    if value.is_finite() && value >= low {
        Ok(())
    } else {
        Err(Error::Invalid(format!(
            "{what} must be a finite number of at least {low}, not {value}"
        )))
    }
}

/// `Ok` if `value` is finite and above zero, else an error that names it.
pub(crate) fn positive(what: &str, value: f64) -> Result<(), Error> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(Error::Invalid(format!(
            "{what} must be a finite number above 0, not {value}"
        )))
    }
}
