//! Contact of particles with obstacles, as a phase after each step.
//!
//! A particle that ends a step inside an obstacle is moved to the surface, and the inward component
//! of its velocity is removed. Coulomb friction then removes
//!
//! ```text
//! |dv_t| <= mu |dv_n|    of its velocity along the surface,
//! |dx_t| <= mu |dx_n|    of its displacement along the surface since it touched,
//! ```
//!
//! both relative to the obstacle. A particle that would slip by less than that stays where it is on
//! the obstacle, so that particles at rest do not creep.

mod advance;
mod approach;
mod bounds;
mod boxes;
mod bulge;
mod candidates;
mod check;
mod contact_pair;
mod cut;
mod footing;
mod friction;
mod guard;
mod held;
mod impact;
mod impulse;
mod layer;
mod listing;
mod met;
mod motion;
mod obstacle;
mod repulsion;
mod resolve;
mod response;
mod skin;
mod solids;
mod strain;
mod strike;
mod surface;
#[cfg(test)]
mod tests;
mod untangle;

pub use crate::geometry::{ClosedMesh, Closest, PairKind, Shape, Simplices, closest, weighted};
pub use advance::time_of_impact;
pub(crate) use approach::{Approach, earliest};
pub(crate) use bulge::bulge;
pub(crate) use check::is_crowded;
pub use check::{Crossed, crossed};
pub use check::{Crossing, crossings};
pub use cut::Pinched;
pub(crate) use guard::{Bodies, guard};
pub(crate) use impulse::{Impulses, rebound_speed, shortest_rebound};
pub use layer::ContactLayer;
pub(crate) use met::SIMULTANEOUS_SHARE;
pub use met::Step;
pub use met::{Statistics, Stop};
pub use motion::Guarded;
pub(crate) use obstacle::Course;
pub use obstacle::Obstacle;
pub(crate) use obstacle::reaching_on;
pub use resolve::{ContactPhase, resolve};
pub(crate) use response::Joints;
pub use skin::Skin;
pub use strain::{StrainLimit, StrainLimiter, Strained};
pub use surface::Surface;
pub(crate) use untangle::{Freedom, untangle};
