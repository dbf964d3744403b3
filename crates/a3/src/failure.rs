//! What the program ends with when it does not succeed.

use std::fmt::Display;

/// The reason why a command failed, by who can help it.
pub enum Failure {
    /// The command line asks for something impossible: exit code 2.
    Usage(String),
    /// The work was possible and failed: exit code 1.
    Run(String),
    /// A signal interrupted the work: exit code 128 and its number.
    Interrupted(String),
}

impl Failure {
    /// A failure of the work itself.
    pub fn run(why: impl Display) -> Self {
        Self::Run(why.to_string())
    }

    /// A mistake in the command line.
    pub fn usage(why: impl Display) -> Self {
        Self::Usage(why.to_string())
    }

    /// The message, without its kind.
    pub fn message(self) -> String {
        match self {
            Self::Usage(why) | Self::Run(why) | Self::Interrupted(why) => why,
        }
    }
}
