//! The default cloth: a curtain 3 m wide, gathered along its pinned top edge, let go from the side.
//!
//! Width and mass are of the cloth, not of a particle: another grid samples the same curtain, with square cells. A
//! spring's stiffness does not depend on the spacing then, a particle's mass falls with its square, and the damping
//! time with the spacing, which leaves the damping ratio of the fastest motion as it is. At 20 x 20 that makes 0.02 kg
//! and k/m = 5000 / 2500 / 1250 s-2. The damping along the springs is what keeps `t 0.01` stable while the cloth
//! still moves freely.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::{Model, Scene, SceneEntry, Swing, View, at_rest};
use crate::colliders::Floor;
use crate::error::Error;
use crate::forces::Wind;
use crate::grid::Grid;
use crate::network::Network;
use crate::path::Path;

pub(super) const ENTRY: SceneEntry = SceneEntry {
    name: "cloth",
    summary: "a curtain with damped springs, top edge pinned, and a floor",
    grid: Some((20, 20)),
    make,
};

/// [m]
const WIDTH: f64 = 3.0;
/// [m]
const TOP: f64 = 3.6;
/// The spacing at which the other figures hold [m].
const SPACING: f64 = WIDTH / 19.0;
/// Of a particle at that spacing [kg].
const MASS: f64 = 0.02;
/// Structural, shear, bend [N/m].
const STIFFNESS: [f64; 3] = [5000.0 * MASS, 2500.0 * MASS, 1250.0 * MASS];
/// Damping over stiffness, at that spacing [s].
const DAMPING_TIME: f64 = 0.006;
/// Drag over mass [1/s].
const DRAG: f64 = 0.3;
/// The breeze pushes with this much per mass [m/s2].
const BREEZE: f64 = 2.0;
/// Width of the gathered edge over the width of the cloth.
const GATHER: f64 = 0.8;
/// Number of folds.
const FOLDS: f64 = 3.5;
/// Depth of a fold either way [m], so that the top edge is about at rest.
const FOLD: f64 = 0.13;
/// How far the cloth is held out from hanging straight [rad].
const TILT: f64 = 0.9;

fn make(grid: Grid) -> Result<Scene, Error> {
    let spacing = WIDTH / (grid.cols() - 1) as f64;
    let fineness = spacing / SPACING;
    let mass = MASS * fineness * fineness;
    let down = Vector3::new(0.0, -libm::cos(TILT), libm::sin(TILT));
    let across = Vector3::new(0.0, libm::sin(TILT), libm::cos(TILT));
    let positions: Vec<_> = (0..grid.particles())
        .map(|k| {
            let (i, j) = (k / grid.cols(), k % grid.cols());
            let s = j as f64 / (grid.cols() - 1) as f64;
            Vector3::new((s - 0.5) * GATHER * WIDTH, TOP, 0.0)
                + across * (FOLD * libm::sin(TAU * FOLDS * s))
                + down * (i as f64 * spacing)
        })
        .collect();
    let mut network = Network::new(vec![mass; grid.particles()])?;
    for family in grid.springs(spacing, STIFFNESS, DAMPING_TIME * fineness)? {
        network.add_family(family)?;
    }
    for (j, position) in positions.iter().enumerate().take(grid.cols()) {
        network.pin(j, Path::Still(*position))?;
    }
    network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
    network.set_drag(DRAG * mass)?;
    network.set_floor(Floor { height: 0.0 });
    Ok(Scene {
        name: "cloth",
        model: Model::Network(Box::new(network)),
        state: at_rest(&positions),
        grid: Some(grid),
        swing: Some(Swing {
            amplitude: Vector3::new(0.0, 0.0, 0.5),
            rate: 2.2,
        }),
        wind: Some(Wind::new(1, Vector3::new(0.3, 0.0, 1.0) * (BREEZE * mass))),
        trail: None,
        view: View {
            eye: Vector3::new(3.4, 2.5, 5.9),
            target: Vector3::new(0.0, 1.8, 0.2),
        },
    })
}
