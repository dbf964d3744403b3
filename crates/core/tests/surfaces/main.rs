//! Contact of surfaces.

#[path = "../common/mod.rs"]
mod common;

mod bounce;
mod collisions;
mod conserved;
mod felt;
mod flat;
mod force;
mod hands;
mod impact;
mod implicit;
mod kinematic;
mod pairs;
mod rebound;
mod resting;
mod rigid;
mod scenes;
mod slope;
mod swift;
mod untangle;

use a3_core::contact::{Obstacle, Shape, Skin};
use a3_core::{Network, Path, Touch, Vector3};

/// A particle of that mass (kg) under that gravity (m/s2), and a floor at 0 that it touches with
/// that thickness (m) and stiffness (N/m), without damping.
fn bead_above_floor(mass: f64, gravity: f64, [thickness, stiffness]: [f64; 2]) -> Network {
    let mut network = Network::new(vec![mass]).unwrap();
    network.set_gravity(Vector3::new(0.0, -gravity, 0.0));
    let floor =
        Obstacle { thickness, ..Obstacle::smooth(Shape::Floor, Path::Still(Vector3::zeros())) };
    network.add_obstacle(floor).unwrap();
    let skin = Skin { thickness, stiffness, ..Skin::default() };
    let touch = Touch { skins: vec![skin], edges: vec![[0, 0]], drops: vec![], bodies: false };
    network.set_touch(Some(touch)).unwrap();
    network
}
