//! What is wrong with a scene or a file that a user gives.

use std::fmt;

use a3_scenes::Fault;

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
            Self::Text {
                file: Some(file),
                fault,
            } => {
                let line = fault.line.map(|line| format!(":{line}"));
                let fault = Fault {
                    line: None,
                    ..fault.clone()
                };
                write!(f, "{file}{}: {fault}", line.unwrap_or_default())
            }
        }
    }
}
