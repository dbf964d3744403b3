//! Contact of surfaces.

#[path = "../common/mod.rs"]
mod common;

mod bounce;
mod conserved;
mod force;
mod impact;
mod implicit;
mod pairs;
mod resting;
mod slope;
