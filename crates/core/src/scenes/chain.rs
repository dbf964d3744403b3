//! The course's chain: four particles, the first fixed.

use std::sync::Arc;

use nalgebra::Vector3;

use super::{Model, Scene, SceneEntry, Swing, View, at_rest};
use crate::error::Error;
use crate::forces::Wind;
use crate::network::Network;
use crate::path::Path;
use crate::spring::{Spring, SpringKind, SpringLaw};

pub(super) const ENTRY: SceneEntry = SceneEntry {
    name: "chain",
    summary: "four particles on springs, one end fixed: the course's chain",
    grid: None,
    make: |_| make(),
};

fn make() -> Result<Scene, Error> {
    let positions: [_; 4] = std::array::from_fn(|i| Vector3::new(0.5 * i as f64, 0.0, 0.0));
    let mut network = Network::new(vec![1.0; 4])?;
    let law = SpringLaw::new(25.0, 0.5, 0.0)?;
    for i in 0..3 {
        network.add_spring(Spring {
            kind: SpringKind::Structural,
            i,
            j: i + 1,
            law,
        })?;
    }
    network.pin(0, Path::Still(positions[0]))?;
    network.set_gravity(Vector3::new(0.0, -9.8, 0.0));
    network.set_drag(0.1)?;
    Ok(Scene {
        name: "chain".into(),
        model: Model::Network(Box::new(network)),
        state: at_rest(&positions),
        grid: None,
        surface: Arc::default(),
        swing: Some(Swing {
            amplitude: Vector3::new(0.6, 0.0, 0.0),
            rate: 1.5,
        }),
        wind: Some(Wind::new(1, Vector3::new(0.8, 0.0, 1.5))),
        trail: Some(3),
        view: View {
            eye: Vector3::new(2.0, -1.9, 12.5),
            target: Vector3::new(0.0, -2.6, 0.0),
        },
        step_scale: 1.0,
        reach: 10.0,
    })
}
