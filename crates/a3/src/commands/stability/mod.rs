//! `a3 stability`: the largest stable step of each solver, predicted and observed, and a chart of
//! the stability regions that explain it.

mod command;
mod data;
mod measure;
mod table;
mod value;

pub use command::run;
pub use measure::{MethodLimits, Stability};
pub use value::stability;
