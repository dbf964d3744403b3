//! Methods of integration: their rows by family, and one table of all. An integrator sees flat
//! arrays and knows no physics.

mod adaptive;
mod derivative;
mod embedded;
mod error_norm;
mod implicit;
mod implicit_damping;
mod integrator;
mod kicks;
mod method;
mod nystrom;
mod nystrom_pairs;
mod own;
mod own_tableau;
mod own_trial;
mod pairs;
mod prediction;
mod splitting;
mod sweep;
mod table;
mod trial;
mod vbd;
mod xpbd;

pub use crate::work::Work;
pub use adaptive::{Adaptive, AdaptiveState, Taken};
pub use derivative::Derivative;
pub(crate) use derivative::Solve;
pub use error_norm::Tolerance;
pub use implicit::bdf_growth;
pub use integrator::Integrator;
pub use method::{Method, View};
pub(crate) use sweep::add_scaled;
pub use table::{METHODS, find};
