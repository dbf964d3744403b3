//! The default cloth: a curtain 4 m wide, gathered along its pinned top edge, pushed so that it sways.
//!
//! Width and mass are of the cloth, not of a particle: another grid samples the same curtain, with square cells. A
//! spring's stiffness does not depend on the spacing then, a particle's mass falls with its square, and the damping
//! time with the spacing, which leaves the damping ratio of the fastest motion as it is. At 20 x 20 that makes 0.02 kg
//! and k/m = 2500 / 1250 / 625 s-2: it hangs stretched by a fifth at most, and `t 0.01` holds it whatever a hand does.
//! The damping along the springs is what does that while the cloth still moves freely.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::{Model, Scene, SceneEntry, Surface, Swing, View, at_rest};
use crate::colliders::Floor;
use crate::error::Error;
use crate::forces::Wind;
use crate::grid::Grid;
use crate::network::Network;
use crate::path::Path;
use crate::sheet::Sheet;

pub(super) const ENTRY: SceneEntry = SceneEntry {
    name: "cloth",
    summary: "a curtain with damped springs, top edge pinned, and a floor",
    grid: Some((20, 20)),
    make,
};

/// In m.
const WIDTH: f64 = 4.0;
/// The spacing at which the other figures hold (m).
const SPACING: f64 = WIDTH / 19.0;
/// Of a particle at that spacing (kg).
const MASS: f64 = 0.02;
/// Structural, shear, bend (N/m).
const STIFFNESS: [f64; 3] = [2500.0 * MASS, 1250.0 * MASS, 625.0 * MASS];
/// Damping over stiffness, at that spacing (s).
const DAMPING_TIME: f64 = 0.006;
/// Drag over mass (1/s).
const DRAG: f64 = 0.3;
/// The breeze pushes with this much per mass (m/s2).
const BREEZE: f64 = 4.0;
/// Number of folds.
const FOLDS: f64 = 3.5;
/// How far the gathered edge turns from straight (rad).
const TURN: f64 = 1.15;
/// Speed of the lower edge as it starts (m/s).
const SWAY: f64 = 5.0;

fn make(grid: Grid) -> Result<Scene, Error> {
    let spacing = WIDTH / (grid.cols() - 1) as f64;
    let height = spacing * (grid.rows() - 1) as f64;
    let fineness = spacing / SPACING;
    let mass = MASS * fineness * fineness;
    // Stretched by a fifth, it still hangs free of the floor.
    let top = 1.2 * height + 0.1;
    // A sine-generated curve: its direction swings to and fro, its length is that of the cloth, so nothing is stretched.
    let edge: Vec<_> = (0..grid.cols())
        .scan(Vector3::new(0.0, top, 0.0), |at, j| {
            let s = (j as f64 + 0.5) / (grid.cols() - 1) as f64;
            let turn = TURN * libm::cos(TAU * FOLDS * s);
            let here = *at;
            *at += (Vector3::x() * libm::cos(turn) + Vector3::z() * libm::sin(turn)) * spacing;
            Some(here)
        })
        .collect();
    let middle = Vector3::x() * (0.5 * edge[grid.cols() - 1].x);
    let positions: Vec<_> = (0..grid.rows())
        .flat_map(|i| {
            edge.iter()
                .map(move |at| at - middle - Vector3::y() * (i as f64 * spacing))
        })
        .collect();
    let mut network = Network::new(vec![mass; grid.particles()])?;
    network.set_sheet(Sheet::new(
        grid,
        spacing,
        STIFFNESS,
        DAMPING_TIME * fineness,
    )?)?;
    for (j, position) in positions.iter().enumerate().take(grid.cols()) {
        network.pin(j, Path::Still(*position))?;
    }
    network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
    network.set_drag(DRAG * mass)?;
    network.set_floor(Floor { height: 0.0 });
    let mut state = at_rest(&positions);
    for (k, vz) in state[5 * grid.particles()..].iter_mut().enumerate() {
        *vz = SWAY * (k / grid.cols()) as f64 / (grid.rows() - 1) as f64;
    }
    let target = Vector3::new(0.0, 0.48 * top, 0.2);
    Ok(Scene {
        name: "cloth".into(),
        model: Model::Network(Box::new(network)),
        state,
        grid: Some(grid),
        surface: Surface::of_grid(grid).into(),
        swing: Some(Swing {
            amplitude: Vector3::new(0.0, 0.0, 0.5),
            rate: 2.2,
        }),
        wind: Some(Wind::new(1, Vector3::new(0.3, 0.0, 1.0) * (BREEZE * mass))),
        trail: None,
        view: View {
            eye: target + Vector3::new(4.6, 0.75, 7.4) * (top / 4.9).max(1.0),
            target,
        },
        step_scale: fineness.min(1.0),
        reach: 3.0,
    })
}
