//! Forces, constraints and obstacles against what physics says of them.

#[path = "../common/mod.rs"]
mod common;

mod buckling;
mod constraints;
mod contact;
mod elements;
mod forces;
mod friction;
mod networks;
mod sweeps;
mod tearing;
mod wind;
