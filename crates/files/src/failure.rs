//! Failures of the program, with their exit codes, and faults of scenes and files that a user
//! gives.

use std::fmt;
use std::fmt::Display;

use a3_scenes::Fault;

/// Exit codes, and what each says.
pub const EXIT_CODES: [(&str, &str); 6] = [
    (
        "0",
        "All that was asked for is done. Without a display, the window's job was done without one.",
    ),
    (
        "1",
        "The work failed: a run blew up, surfaces passed through one another under --check, judged results err by \
         more than --within, a file could not be written, or there is no graphics adapter to draw with.",
    ),
    (
        "2",
        "The request cannot be met: something is wrong with the command line, a scene file, a mesh, the data of a \
         chart or a judged file. Nothing was done, except that other judged files were.",
    ),
    ("129", "SIGHUP ended the work: the terminal was closed."),
    ("130", "SIGINT ended the work: Ctrl-C."),
    ("143", "SIGTERM ended the work."),
];

/// The reason why a command or a function of the library failed, by who can help it. Its words are
/// those of the command line.
#[derive(Debug)]
pub enum Failure {
    /// The request is impossible: exit code 2.
    Usage(String),
    /// A scene or a file that the request names is refused: exit code 2.
    Input(InputError),
    /// The work was possible and failed: exit code 1.
    Run(String),
    /// The work was told to stop before it had any result; on the command line, by a signal: exit
    /// code 128 and its number.
    Interrupted(String),
}

impl std::error::Error for Failure {}

impl Failure {
    /// Returns a failure of the work itself.
    pub fn run(why: impl Display) -> Self {
        Self::Run(why.to_string())
    }

    /// Returns a mistake in the command line.
    pub fn usage(why: impl Display) -> Self {
        Self::Usage(why.to_string())
    }

    /// Returns the failure of work that was stopped before it had any result.
    pub fn stopped() -> Self {
        Self::Interrupted("interrupted before anything was measured".into())
    }

    /// Returns `None` in place of the failure of work that was stopped.
    pub fn unless_stopped<T>(done: Result<T, Self>) -> Result<Option<T>, Self> {
        match done {
            Err(Self::Interrupted(_)) => Ok(None),
            done => done.map(Some),
        }
    }
}

/// The message, without its kind.
impl Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Usage(why) | Self::Run(why) | Self::Interrupted(why) => f.write_str(why),
            Self::Input(error) => error.fmt(f),
        }
    }
}

impl From<InputError> for Failure {
    fn from(error: InputError) -> Self {
        Self::Input(error)
    }
}

/// An error of a run is a failure of the work.
impl From<a3_core::Error> for Failure {
    fn from(error: a3_core::Error) -> Self {
        Self::run(error)
    }
}

/// The reason why an input is refused.
#[derive(Debug)]
pub enum InputError {
    /// No scene has the name. The reason says which there are.
    Unknown(String),
    /// A file cannot be used as a whole, or not be read.
    File {
        /// Path of the file.
        file: String,
        /// Reason.
        why: String,
    },
    /// A text has a fault. That of a built-in scene is in no file.
    Text {
        /// Path of the file, if there is one.
        file: Option<String>,
        /// Fault, with its line.
        fault: Fault,
    },
}

/// `FILE:LINE: error` if the line is known, as compilers write it.
impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Unknown(why) => f.write_str(why),
            Self::File { file, why } => write!(f, "{file}: {why}"),
            Self::Text { file: None, fault } => fault.fmt(f),
            Self::Text { file: Some(file), fault } => {
                let line = fault.line.map(|line| format!(":{line}"));
                let fault = Fault { line: None, ..fault.clone() };
                write!(f, "{file}{}: {fault}", line.unwrap_or_default())
            }
        }
    }
}
