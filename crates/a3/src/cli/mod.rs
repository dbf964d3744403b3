//! The command line: its commands, arguments and help.

mod command;
#[cfg(feature = "window")]
mod drawing;
mod explain;
#[cfg(not(target_arch = "wasm32"))]
mod judge;
mod measures;
mod run;
#[cfg(not(target_arch = "wasm32"))]
pub mod share;
#[cfg(not(target_arch = "wasm32"))]
mod sweep;
pub mod values;
#[cfg(feature = "window")]
mod window;
#[cfg(feature = "window")]
mod words;

pub use command::Chart;
pub use command::Choose;
pub use command::Scenes;
pub use command::Simplify;
pub use command::Simulate;
pub use command::Solvers;
pub use command::Stability;
pub use command::{Cli, Command};
pub use explain::explain;
#[cfg(not(target_arch = "wasm32"))]
pub use judge::Judge;
pub use measures::WorkMeasure;
#[cfg(not(target_arch = "wasm32"))]
pub use sweep::Sweep;
#[cfg(feature = "window")]
pub use window::{Compare, Render};
#[cfg(feature = "window")]
pub use words::read;
