//! Tests of elastic solids against closed forms, and against differences of their energy.

#[path = "../common/mod.rs"]
mod common;

mod box_of;
mod cantilever;
mod inversion;
mod motion;
mod statics;
mod tangent;
