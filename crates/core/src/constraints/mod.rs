//! Constrained dynamics: C(x) = 0 is maintained by forces J^T lambda, J = dC/dx, which do no work
//! if C does not depend on time. The acceleration of a free particle is a = W (Q + J^T lambda),
//! with the inverse masses W and all other forces Q; that of a pin is the acceleration apin of its
//! path. The multipliers solve C'' = J a + J' v = -ks C - kd C', which reduces the errors of
//! previous steps, or J W J^T lambda = -(J' v + J (W Q + apin) + ks C + kd C'). If J is so nearly
//! singular that lambda would be huge, as for a chain stretched straight between two pins, J W J^T
//! is slightly enlarged, and C'' is met as closely as bounded forces allow. Andrew Witkin,
//! *Physically Based Modeling: Constrained Dynamics*, SIGGRAPH course notes.
//!
//! Each row of C is a distance (m). Each row of J is a unit vector, with its opposite at the other
//! end of a rod. A force at a point of a rigid body moves and rotates the body: W then includes the
//! body's inverse inertia, and J the lever r x g of the force along g.
//!
//! A rope has a row like a rod's while it is taut: see `joints`. A joint of rigid bodies has up to
//! six rows, which also act on the rotations alone: see `joint`.

mod constraint;
mod joint;
mod joints;
mod jump;
mod set;
mod solve;

pub use constraint::Constraint;
pub(crate) use constraint::Projected;
pub use joint::{Joint, JointKind, Stop};
pub(crate) use joints::{
    OneSided, beyond, has_ropes, hold_at_ends, least, loosen, open_ends, rates, set_all_taut,
    set_taut, taut, tensions,
};
pub(crate) use joints::{joints, multipliers, nearest, project};
pub(crate) use jump::{Pushed, Struck, jump, pulls};
pub(crate) use set::{Constraints, Moved};
pub(crate) use solve::Turning;
