//! Implicit stages y = base + a f(t, y), solved by Newton's method from a guess: in a mechanical
//! system by its tangent ([`mechanical`]), in any other by the Jacobian of f ([`dense`]). Several
//! stages at once are those of collocation ([`collocation`]).

mod bdf;
mod collocation;
mod consistent;
mod dense;
mod divided;
mod euler;
mod jacobian;
mod joined;
mod kept;
mod lu;
mod mechanical;
mod midpoint;
mod newton;
mod pattern;
mod radau;
mod sparse;
mod stage;
mod tr_bdf2;

pub(super) use bdf::METHOD as BDF;
pub use bdf::bdf_growth;
pub(super) use dense::Dense;
pub(super) use euler::METHOD as EULER;
pub(super) use midpoint::METHOD as MIDPOINT;
pub(super) use radau::METHOD as RADAU;
pub(super) use tr_bdf2::METHOD as TR_BDF2;
