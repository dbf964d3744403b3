//! Constrained dynamics: C(x) = 0 is held by forces J^T lambda, J = dC/dx, that do no work where C
//! does not move. The acceleration of a free particle is a = W (Q + J^T lambda), with the inverse
//! masses W and all other forces Q; that of a pin is the one of its path, apin. The multipliers
//! solve C'' = J a + J' v = -ks C - kd C', which takes back what a step missed, or
//! J W J^T lambda = -(J' v + J (W Q + apin) + ks C + kd C').
//! Where J is so nearly singular that lambda would be huge, as for a chain stretched straight
//! between two pins, J W J^T is made a little larger, and C'' is met as nearly as bounded forces
//! allow. Andrew Witkin, *Physically Based Modeling: Constrained Dynamics*, SIGGRAPH course notes.
//!
//! Each row of C is a distance (m), and each row of J a unit vector, and its opposite at the other
//! end of a rod. A force at a point of a rigid body moves and turns the body: W then has the body's
//! inverse inertia too, and J the lever r x g of the force along g.

mod constraint;
mod direct;
mod errors;
mod row;
mod set;
mod solve;
mod turning;

pub use constraint::Constraint;
pub(crate) use set::Constraints;
pub(crate) use turning::Turning;
