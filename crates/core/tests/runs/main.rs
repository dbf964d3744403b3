//! Tests of simulations and of the built-in scenes.

#[path = "../common/mod.rs"]
mod common;

mod balance;
mod broken;
mod checkpoint;
mod default_cloth;
mod hands;
mod jelly;
mod mit;
mod scenes;
mod simulation;
mod strain;
mod tuning;
mod turning;
mod work;
