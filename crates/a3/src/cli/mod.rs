//! The command line: its commands, arguments and help.

mod command;
mod explain;
mod judge;
mod measures;
mod run;
pub mod sweep;
pub mod values;
#[cfg(feature = "window")]
mod window;

pub use command::Chart;
pub use command::Choose;
pub use command::Scenes;
pub use command::Simplify;
pub use command::Simulate;
pub use command::Solvers;
pub use command::Stability;
pub use command::{Cli, Command};
pub use explain::explain;
pub use judge::Judge;
pub use measures::WorkMeasure;
pub use sweep::Sweep;
#[cfg(feature = "window")]
pub use window::{Compare, Render};
