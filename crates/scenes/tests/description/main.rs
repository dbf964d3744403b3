//! Scenes as text: reading and writing them, building them, and their faults.

#[path = "../common/mod.rs"]
mod common;

mod building;
mod edits;
mod faults;
mod fluids;
mod joints;
mod json;
mod masses;
mod materials;
mod parts;
mod resolution;
mod solids;
mod words;

use a3_core::{Grid, Network, Scene};
use a3_scenes::{Description, Fault, Mesh, Places, Setup, find, nearest, parse_toml};

use common::{begins, random, refused, run, seed};

/// Builds a built-in scene, with this grid or its own.
fn scene(name: &str, grid: Option<[usize; 2]>) -> Setup {
    let grid = grid.map(|[rows, cols]| Grid::new(rows, cols).unwrap());
    find(name).unwrap().build(grid).unwrap()
}

fn mesh(name: &str) -> Result<Mesh, String> {
    match name {
        // Two triangles of a unit square, with a corner twice.
        "square.obj" => Ok(Mesh {
            positions: vec![
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [1.0, 1.0, 0.0],
                [0.0, 1.0, 0.0],
                [1.0, 1.0, 0.0],
                [0.0, 0.0, 0.0],
            ],
            triangles: vec![[0, 1, 2], [5, 4, 3]],
            ..Mesh::default()
        }),
        _ => Err(format!("{name}: there is no such file")),
    }
}

/// Builds what was read from a text, or says where it is wrong.
fn made((description, places): (Description, Places)) -> Result<Setup, Fault> {
    let built = description.build(None, &mut mesh);
    built.map_err(|fault| places.locate(fault))
}

fn set_up(text: &str) -> Result<Setup, Fault> {
    parse_toml(text).and_then(made)
}

fn build(text: &str) -> Result<Scene, Fault> {
    set_up(text).map(|setup| setup.scene)
}

fn read(text: &str) -> Description {
    Description::parse(text).unwrap_or_else(|fault| panic!("{fault}\n{text}"))
}

/// Builds a scene that needs no files.
fn built(description: &Description) -> Scene {
    let built = description.build(None, &mut |name| Err(format!("{name}: there is no file")));
    built.unwrap_or_else(|fault| panic!("{fault}")).scene
}

fn network(scene: &Scene) -> &Network {
    scene.model.network().unwrap()
}

/// Returns the message about a wrong text.
fn said(text: &str) -> String {
    match build(text) {
        Ok(_) => panic!("this was taken:\n{text}"),
        Err(fault) => fault.to_string(),
    }
}

const CLOTH: &str = "\
gravity = [0, -9.81, 0]

[[cloth]]
grid = [3, 4]
spacing = 0.5
mass = 0.1
stiffness = [10, 5, 2]
at = [0, 2, 0]
";
