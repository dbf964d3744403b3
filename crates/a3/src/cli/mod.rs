//! The command line: its commands, arguments and help.

mod command;
mod explain;
mod run;
pub mod sweep;
pub mod values;
#[cfg(feature = "window")]
mod window;

pub use command::{Chart, Choose, Judge, Scenes, Simplify, Simulate, Solvers, Stability};
pub use command::{Cli, Command};
pub use explain::explain;
pub use run::{WorkMeasure, limit_threads};
pub use sweep::Sweep;
#[cfg(feature = "window")]
pub use window::{Compare, Render};
