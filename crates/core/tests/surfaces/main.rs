//! Contact of surfaces.

#[path = "../common/mod.rs"]
mod common;

mod bounce;
mod collisions;
mod conserved;
mod force;
mod hands;
mod impact;
mod implicit;
mod led;
mod pairs;
mod resting;
mod scenes;
mod slope;
