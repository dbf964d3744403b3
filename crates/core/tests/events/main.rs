//! Tests of what begins, ends, is hit or breaks within a step.

#[path = "../common/mod.rs"]
mod common;

mod frames;
mod known_times;
mod rebounds;
mod resting;
mod tears;
mod thin;
mod touches;
