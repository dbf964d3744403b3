//! `a3 choose`: the cheapest solver for an error, or the most accurate one for a budget.

mod command;
mod search;
mod value;

pub use command::run;
pub use command::{command, report};
pub use value::{Choice, ChooseOptions, Chosen, Goal, choose};
