//! Where a scene is looked at from.

use a3_core::{Scene, Simulation};
use a3_render::Camera;

use super::vectors::to_f32;

/// The camera of the run's scene.
pub fn camera(simulation: &Simulation) -> Camera {
    camera_of(simulation.scene())
}

/// The camera of a scene.
pub fn camera_of(scene: &Scene) -> Camera {
    let view = scene.view;
    Camera::look_at(to_f32(view.eye), to_f32(view.target))
}
