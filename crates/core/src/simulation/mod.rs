//! Simulations: a scene, a method, and the time that the run has reached.

mod balance;
mod changes;
mod checkpoint;
mod depths;
mod disturbances;
mod driver;
mod events;
mod hand;
mod interaction;
mod locator;
mod phases;
mod pins;
mod power;
mod reach;
mod resting;
mod run;
mod state;
mod step;
mod stepper;
mod watch;

pub use balance::{Balance, Gain};
pub use checkpoint::Checkpoint;
pub use driver::Progress;
pub use driver::Span;
pub use pins::Grabbed;
pub(crate) use resting::may_rest;
pub use run::{Passage, Simulation};
pub use state::RunState;
