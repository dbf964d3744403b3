//! Simulations: a scene, a method, and the time that the run has reached.

mod balance;
mod bounds;
mod changes;
mod checkpoint;
mod depths;
mod driver;
mod events;
mod failure;
mod grabbed;
mod hand;
mod interaction;
mod jointed;
mod locator;
mod phases;
mod pins;
mod power;
mod reach;
mod resting;
mod retry;
mod run;
mod searched;
mod state;
mod step;
mod stepper;
mod stretching;
mod touching;
mod watch;
mod within;

pub use balance::{Balance, Gain};
pub use checkpoint::Checkpoint;
pub use driver::Progress;
pub use grabbed::Grabbed;
pub(crate) use resting::may_rest;
pub use run::Simulation;
pub use state::RunState;
pub use within::Span;
