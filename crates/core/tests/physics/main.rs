//! Tests of forces, constraints and obstacles against laws of physics.

#[path = "../common/mod.rs"]
mod common;

mod airborne;
mod buckling;
mod constraints;
mod contact;
mod cords;
mod elements;
mod fan;
mod floating;
mod fluid;
mod forces;
mod friction;
mod gas;
mod honey;
mod hydrostatics;
mod networks;
mod outflow;
mod restitution;
mod rigid;
mod rolling;
mod solids;
mod sweeps;
mod tearing;
mod threads;
mod turning;
mod wet;
mod wind;
