//! The camera of a scene.

use a3_render::Camera;
use a3_scenes::Presentation;

use super::vectors::to_f32;

/// Returns the camera that first shows a scene.
pub fn camera(presentation: &Presentation) -> Camera {
    let viewpoint = presentation.viewpoint;
    Camera::look_at(to_f32(viewpoint.eye), to_f32(viewpoint.target))
}
