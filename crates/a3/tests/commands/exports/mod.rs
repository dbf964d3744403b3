//! Files for other programs, read back by independent readers, and compared with their run.
//!
//! Khronos' own validator checks them too if it is installed: `npm install gltf-validator`, and
//! `A3_GLTF_VALIDATOR` set to that `node_modules`.

mod endings;
mod fluid;
mod glb;
mod meshes;
mod numbers;
mod usd;
mod vtu;

use std::path::Path;

use crate::common::{succeed, text};
use a3_core::{Control, Simulation, integrators};

/// Frames per second that are compared.
const RATE: f64 = 25.0;

/// Number of frames: the last one is at 0.2 s, before the end.
const COUNT: usize = 6;

/// Scene of a drop that is drawn out.
const ELLIPSE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes/ellipse.toml");

/// Returns the arguments of the program.
fn words(scene: &str, output: &str) -> String {
    format!("simulate r 0.007 --scene {scene} --until 0.21 --output {output}")
}

fn write(folder: &Path, scene: &str, output: &str) -> String {
    let output = succeed(folder, words(scene, output));
    assert!(output.stderr.is_empty(), "{}", text(&output.stderr));
    text(&output.stdout).to_owned()
}

/// Makes the same run with the library, and calls `frame` at the times of its frames.
fn run(scene: &str, mut frame: impl FnMut(usize, &Simulation)) {
    let scene = a3_scenes::find(scene).unwrap().build(None).unwrap().scene;
    let method = integrators::find("r").unwrap();
    let mut simulation = Simulation::new(scene, method, Control::Step(0.007)).unwrap();
    for k in 0..COUNT {
        simulation.advance_to(k as f64 / RATE).unwrap();
        frame(k, &simulation);
    }
}

/// Row i of an n x 3 matrix.
fn row(matrix: &[f64], i: usize) -> [f64; 3] {
    let n = matrix.len() / 3;
    [matrix[i], matrix[n + i], matrix[2 * n + i]]
}

/// Positions at a frame in single precision.
fn positions(simulation: &Simulation) -> Vec<[f32; 3]> {
    let n = simulation.particles();
    (0..n).map(|i| row(&simulation.state()[..3 * n], i).map(|x| x as f32)).collect()
}

fn triangles(simulation: &Simulation) -> Vec<[u32; 3]> {
    let network = simulation.scene().model.network();
    network.map_or(vec![], |network| network.triangles().to_vec())
}

/// Returns normals by the textbook: cross products of two sides, whose lengths are twice the areas,
/// summed over the triangles around each particle.
fn normals(simulation: &Simulation) -> Vec<[f64; 3]> {
    let mut sums = vec![a3_core::Vector3::zeros(); simulation.particles()];
    for triangle in triangles(simulation) {
        let [a, b, c] = triangle.map(|i| simulation.position(i as usize));
        for i in triangle {
            sums[i as usize] += (b - a).cross(&(c - a));
        }
    }
    sums.iter().map(|n| n.normalize().into()).collect()
}

fn distance(a: [f32; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (f64::from(a[k]) - b[k]).powi(2)).sum::<f64>().sqrt()
}
