//! Methods of integration: one file for each, and one table of all. An integrator sees flat arrays
//! and knows no physics.

mod adaptive;
mod arithmetic;
mod dop853;
mod dormand_prince;
mod dprkn1210;
mod dprkn1210_dense;
mod dprkn86;
mod embedded;
mod error_norm;
mod euler;
mod heun;
mod implicit;
mod implicit_damping;
mod integrator;
mod method;
mod midpoint;
mod nystrom;
mod own;
mod pefrl;
mod prediction;
mod registry;
mod rk4;
mod rkf45;
mod runge_kutta;
mod splitting;
mod srkn11;
mod sweep;
mod symplectic_euler;
mod table;
mod trial;
mod vbd;
mod verlet;
mod verner65;
mod xpbd;

pub use crate::work::Work;
pub use adaptive::{Adaptive, AdaptiveState, Taken};
pub(crate) use arithmetic::add_scaled;
pub use error_norm::Tolerance;
pub use implicit::bdf_growth;
pub use integrator::Integrator;
pub use method::{Method, View};
pub use own::Derivative;
pub use table::{METHODS, find};
