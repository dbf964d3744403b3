//! The plane below a scene, from which heights are read.

use a3_core::contact::Shape;
use a3_core::{Network, Scene, Vector3};
use a3_render::Floor;
use a3_scenes::{Presentation, TANK_LAYERS, Viewpoint};

/// Depth of the ground below the point that the camera looks at, as a share of its distance from
/// the camera. It is near the lower edge of the picture.
const DEPTH: f64 = 0.36;
/// Depth from which on obstacles, such as poles, stand on the ground.
const STANDING_DEPTH: f64 = 0.2;

/// Returns the ground of a scene that has gravity but no floor: below everything that is there at
/// the start, and where tanks and poles stand. Nothing touches it.
pub fn below(scene: &Scene, network: &Network, presentation: &Presentation) -> Option<Floor> {
    network.gravity().filter(|g| g.y < 0.0)?;
    let n = scene.model.particles();
    let lowest = scene.state[n..2 * n].iter().copied().fold(f64::INFINITY, f64::min);
    let foot = obstacles(network).fold(f64::INFINITY, f64::min);
    let Viewpoint { eye, target } = presentation.viewpoint;
    let below = |share: f64| target.y - share * (eye - target).norm();
    let spacing = network.fluid().map(|fluid| fluid.law().spacing);
    let height = if let Some(spacing) = spacing.filter(|_| !presentation.tanks.is_empty()) {
        // The ground is where the edges of the tank are drawn: inside its walls.
        lowest + (f64::from(TANK_LAYERS) - 0.5) * spacing
    } else if foot < below(STANDING_DEPTH) {
        lowest.min(foot)
    } else {
        lowest.min(foot).min(below(DEPTH))
    };
    height.is_finite().then_some(Floor { height: height as f32, solid: false })
}

/// Returns the heights of the lowest points of the obstacles at the start (m).
fn obstacles(network: &Network) -> impl Iterator<Item = f64> {
    network.obstacles().iter().flat_map(|obstacle| {
        let pose = obstacle.at(0.0);
        let (points, below): (Vec<Vector3<f64>>, f64) = match &obstacle.shape {
            Shape::Sphere { radius } => (vec![Vector3::zeros()], *radius),
            Shape::Capsule { ends, radius } => (ends.to_vec(), *radius),
            shape => (shape.simplices().points.clone(), 0.0),
        };
        points.into_iter().map(move |point| pose.of(point).position.y - below)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn height(scene: &str) -> Option<f32> {
        let setup = a3_scenes::find(scene).unwrap().build(None).unwrap();
        let network = setup.scene.model.network()?;
        let ground = below(&setup.scene, network, &setup.presentation)?;
        assert!(!ground.solid);
        Some(ground.height)
    }

    #[test]
    fn poles_and_tanks_stand_on_the_ground_and_all_else_is_above_it() {
        let pole = height("flag").unwrap();
        assert!((pole + 1.62).abs() < 1e-6, "{pole}");
        assert!(height("mit").unwrap() < -4.0 && height("pendulum").unwrap() < -1.5);
        // The tank's inside begins at height 0.
        let tank = height("dam-break").unwrap();
        assert!(tank.abs() < 1e-6, "{tank}");
    }

    #[test]
    fn weightless_scenes_have_no_ground() {
        for scene in ["t-handle", "simple"] {
            assert_eq!(height(scene), None, "{scene}");
        }
    }
}
