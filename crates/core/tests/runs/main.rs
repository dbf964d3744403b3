//! Simulations and the built-in scenes: what a run does, survives and reports.

#[path = "../common/mod.rs"]
mod common;

mod checkpoint;
mod default_cloth;
mod jelly;
mod mit;
mod scenes;
mod simulation;
mod tuning;
