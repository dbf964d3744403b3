//! The command line: its commands, arguments and help.

mod chart;
mod choose;
mod command;
#[cfg(feature = "window")]
mod drawing;
mod explain;
#[cfg(not(target_arch = "wasm32"))]
mod judge;
mod measures;
mod names;
mod run;
mod scenes;
#[cfg(not(target_arch = "wasm32"))]
pub mod share;
mod simplify;
mod simulate;
mod solvers;
mod stability;
#[cfg(not(target_arch = "wasm32"))]
mod sweep;
pub mod values;
#[cfg(feature = "window")]
mod window;

pub use chart::Chart;
pub use choose::Choose;
pub use command::LESSONS;
pub use command::{Cli, Command};
#[cfg(feature = "window")]
pub use drawing::Drawing;
pub use explain::explain;
#[cfg(not(target_arch = "wasm32"))]
pub use judge::Judge;
pub use measures::{ErrorScope, WorkMeasure};
pub use run::{RunOptions, What};
pub use scenes::Scenes;
pub use simplify::{Quantity, Simplify};
pub use simulate::Simulate;
pub use solvers::Solvers;
pub use stability::Stability;
#[cfg(not(target_arch = "wasm32"))]
pub use sweep::Sweep;
#[cfg(feature = "window")]
pub use window::{Compare, Look, Render, WindowOptions};
