//! The cloth of MIT's course 6.837, with the numbers of its sample program, alone and with its sphere. It is soft: it
//! stretches to 2.8 times its length, and `t 0.01` tears it apart.

use nalgebra::Vector3;

use super::{Model, Scene, SceneEntry, Surface, Swing, View, at_rest};
use crate::colliders::{Floor, Sphere};
use crate::error::Error;
use crate::forces::Wind;
use crate::grid::Grid;
use crate::network::Network;
use crate::path::Path;
use crate::sheet::Sheet;

pub(super) const ENTRY: SceneEntry = SceneEntry {
    name: "mit",
    summary: "the cloth of MIT 6.837, soft, two corners pinned",
    grid: Some((15, 15)),
    make: |grid| make("mit", grid, None),
};

pub(super) const WITH_SPHERE: SceneEntry = SceneEntry {
    name: "mit-sphere",
    summary: "the cloth of MIT 6.837 with its sphere and floor",
    grid: Some((15, 15)),
    make: |grid| {
        let sphere = Sphere {
            path: Path::Still(Vector3::new(1.0, -4.0, 0.0)),
            radius: 1.5,
        };
        make("mit-sphere", grid, Some(sphere))
    },
};

const SPACING: f64 = 0.2;
const MASS: f64 = 0.04;

fn make(name: &'static str, grid: Grid, sphere: Option<Sphere>) -> Result<Scene, Error> {
    let middle = 0.5 * (grid.cols() - 1) as f64;
    let positions: Vec<_> = (0..grid.particles())
        .map(|k| {
            let (i, j) = (k / grid.cols(), k % grid.cols());
            Vector3::new((j as f64 - middle) * SPACING, 0.0, i as f64 * SPACING)
        })
        .collect();
    let mut network = Network::new(vec![MASS; grid.particles()])?;
    network.set_sheet(Sheet::new(grid, SPACING, [30.0, 30.0, 22.5], 0.0)?)?;
    for corner in [grid.index_of(0, 0), grid.index_of(0, grid.cols() - 1)] {
        network.pin(corner, Path::Still(positions[corner]))?;
    }
    network.set_gravity(Vector3::new(0.0, -9.8, 0.0));
    network.set_drag(0.1)?;
    if let Some(sphere) = sphere {
        network.add_sphere(sphere);
        network.set_floor(Floor { height: -5.0 });
    }
    let size = (grid.rows().max(grid.cols()) as f64 / 15.0).max(1.0);
    Ok(Scene {
        name: name.into(),
        model: Model::Network(Box::new(network)),
        state: at_rest(&positions),
        grid: Some(grid),
        surface: Surface::of_grid(grid).into(),
        swing: Some(Swing {
            amplitude: Vector3::new(0.0, 0.0, 2.0),
            rate: 1.0 / 1.5,
        }),
        wind: Some(Wind::new(1, Vector3::new(0.0, 0.0, 0.15))),
        trail: None,
        view: View {
            eye: Vector3::new(4.5, -0.4, 8.0) * size,
            target: Vector3::new(0.0, -2.2, -0.3) * size,
        },
        step_scale: 1.0,
        reach: 10.0,
    })
}
