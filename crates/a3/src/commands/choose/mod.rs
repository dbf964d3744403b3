//! `a3 choose`: the cheapest solver for an error, or the most accurate one for a budget.

mod command;
mod search;
mod value;
mod words;

pub use command::run;
pub use value::{Choice, ChooseOptions, Chosen, Goal, choose};
pub use words::{command, report};
