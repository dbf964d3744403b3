//! Choices: the cheapest solver for an error, or the most accurate one for a budget.

mod report;
mod value;

pub use report::{command, holds, report};
pub use value::{Choice, ChooseOptions, Chosen, Goal, choose};
