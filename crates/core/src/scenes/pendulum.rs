//! One particle on a spring that hangs from a fixed point.

use std::sync::Arc;

use nalgebra::Vector3;

use super::{Model, Scene, SceneEntry, Swing, View, at_rest};
use crate::error::Error;
use crate::forces::Wind;
use crate::network::Network;
use crate::path::Path;
use crate::spring::{Spring, SpringKind, SpringLaw};

pub(super) const ENTRY: SceneEntry = SceneEntry {
    name: "pendulum",
    summary: "one particle on a spring, with gravity and drag",
    grid: None,
    make: |_| make(),
};

fn make() -> Result<Scene, Error> {
    let positions = [Vector3::zeros(), Vector3::x()];
    let mut network = Network::new(vec![1.0; 2])?;
    network.add_spring(Spring {
        kind: SpringKind::Structural,
        i: 0,
        j: 1,
        law: SpringLaw::new(50.0, 1.0, 0.0)?,
    })?;
    network.pin(0, Path::Still(positions[0]))?;
    network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
    network.set_drag(0.1)?;
    Ok(Scene {
        name: "pendulum".into(),
        model: Model::Network(Box::new(network)),
        state: at_rest(&positions),
        grid: None,
        surface: Arc::default(),
        swing: Some(Swing {
            amplitude: Vector3::new(0.3, 0.0, 0.0),
            rate: 2.0,
        }),
        wind: Some(Wind::new(1, Vector3::new(0.8, 0.0, 1.5))),
        trail: Some(1),
        view: View {
            eye: Vector3::new(0.6, -0.3, 4.2),
            target: Vector3::new(0.0, -0.75, 0.0),
        },
        step_scale: 1.0,
        reach: 10.0,
    })
}
