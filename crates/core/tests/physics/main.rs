//! Forces, constraints and obstacles against what physics says of them.

#[path = "../common/mod.rs"]
mod common;

mod buckling;
mod colliders;
mod constraints;
mod forces;
mod tearing;
mod wind;
