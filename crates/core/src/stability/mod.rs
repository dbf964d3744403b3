//! Stability of methods: modes of motion, their growth in one step, and the largest step with which
//! a run stays bounded, at rest (`rest`) and in motion (`motion`).
//!
//! A mode is x'' = -w^2 x - 2 d x', where 2 d is the sum of drag and damping over mass. Its
//! eigenvalues are l = -d +- i sqrt(w^2 - d^2). A Runge-Kutta method multiplies the mode by R(h l);
//! the step of a splitting method is a 2 x 2 matrix that no single R(z) gives. No formula is
//! written down here for either: the method takes a step on the mode, and the spectral radius of
//! the matrix of that step is the growth.

mod eigenvalues;
mod limit;
mod linearised;
mod mode;
mod motion;
mod own_rest;
mod rest;
mod search;
mod spectrum;
mod stiffness;

pub use limit::Growth;
pub use limit::{GROWTH, HORIZON, Limit, STEPS, largest_step, tenfold_time};
pub use mode::Observation;
pub use mode::{Mode, fastest};
pub use motion::Motion;
pub use rest::observe_at_rest;
pub use rest::{RestState, rest};
pub use search::Budget;
pub use spectrum::{LargestMode, spectrum};
pub(crate) use stiffness::{accurate, is_stiff};
