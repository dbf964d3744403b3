//! `a3 stability`: the largest stable step of each solver, predicted and observed, and a chart of
//! the stability regions that explain it.

mod command;
mod data;
mod limits;
mod measure;
mod picture;
mod table;
mod value;

pub use command::run;
pub use limits::{MethodLimits, Stability};
pub use value::stability;
