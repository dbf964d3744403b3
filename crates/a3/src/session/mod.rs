//! Runs that keep up with real time, without a window: one run or several side by side, their common
//! time, the hands that pull at them, the reference, the timeline, and what the keys do.

mod acts;
mod keys;
mod limit;
mod pane;
mod readings;
mod reference;
mod samples;
mod save;
mod state;
mod timeline;
mod tuning;

pub use keys::{Action, KEYS, MOUSE, action};
pub use pane::Pane;
pub use readings::Readings;
pub use samples::{History, SPAN, Sample};
pub use state::{Beginning, Session};
pub use timeline::Place;
pub use tuning::Tuning;

#[cfg(test)]
pub use pane::Cost;
#[cfg(test)]
pub use state::tests as fixtures;
