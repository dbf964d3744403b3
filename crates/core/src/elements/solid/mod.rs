//! Solids of linear tetrahedra. With the edges D = [x1 - x0, x2 - x0, x3 - x0] of a tetrahedron,
//! those at rest R and its volume at rest V, the deformation gradient is F = D R^-1, and the force
//! on corner k is -V P(F) `g_k`, where P is the stress and `g_k` row k of R^-1, the gradient of the
//! corner's shape function; corner 0 has minus the sum of the others.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

mod body;
mod force;
mod material;
mod number;
mod tangent;
mod tetrahedra;

pub use body::Solid;
pub use material::{Hyperelastic, Material};
