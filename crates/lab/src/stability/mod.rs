//! Stability: the largest stable step of each solver, predicted and observed, and a chart of
//! the stability regions that explain it.

mod measure;
mod table;
mod value;

pub use measure::{MethodLimits, Stability, measure};
pub use value::stability;
