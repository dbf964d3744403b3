//! Wavefront OBJ, a file for each frame. The vertices are the particles, in their order,
//! and after them the points of rigid bodies.

use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::Arc;

use a3_core::Simulation;
use a3_scenes::{Presentation, Surface};

use super::format::Export;
use super::geometry::{Geometry, positions};
use crate::base::failure::Failure;
use crate::base::rounding::{DIGITS, short};
use crate::draw::surfaces::Liquid;
use crate::files::frames::Sequence;
use crate::files::output;

/// OBJ files that are being written.
pub struct Obj {
    pub presentation: Arc<Presentation>,
    pub files: Files,
}

/// One OBJ file of the final state, or a numbered file for each frame.
pub enum Files {
    /// The file of the final state.
    One(PathBuf),
    /// The numbered files, and the number of the next frame.
    Many(Sequence, usize),
}

impl Export for Obj {
    fn add(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        let path = match &mut self.files {
            Files::One(path) => path.clone(),
            Files::Many(sequence, next) => {
                *next += 1;
                sequence.file(*next - 1)
            }
        };
        output::write_with(&path, |file| {
            write(file, &self.presentation.surface, simulation)
        })
    }

    fn finish(self: Box<Self>) -> Result<(), Failure> {
        Ok(())
    }
}

/// Returns the approximate size of a file (bytes).
pub fn size(surface: &Surface, simulation: &Simulation) -> f64 {
    let geometry = Geometry::of(surface, simulation);
    let rigid = geometry.vertices - geometry.particles;
    let (vertices, normals) = (geometry.vertices, geometry.covered + rigid);
    let (faces, lines) = (geometry.triangles.len(), geometry.lines.len());
    let liquid = Liquid::of(simulation, |_| None);
    let (vertices, normals) = (
        vertices + liquid.corners.len(),
        normals + liquid.corners.len(),
    );
    let faces = faces + liquid.triangles.len();
    36.0 * vertices as f64 + 37.0 * normals as f64 + 42.0 * faces as f64 + 16.0 * lines as f64
}

/// Writes the current state: `v` of all vertices, `vn` and `f` of the surfaces except torn
/// triangles, and `l` and `p` of particles without a surface. The surface of a fluid is an object
/// of its own, with vertices after all others.
fn write(file: &mut dyn Write, surface: &Surface, simulation: &Simulation) -> io::Result<()> {
    let geometry = Geometry::of(surface, simulation);
    let all: Vec<_> = (0..geometry.vertices as u32).collect();
    write_vertices(file, &geometry, &all, simulation)?;
    let liquid = Liquid::of(simulation, |_| None);
    if liquid.triangles.is_empty() {
        return Ok(());
    }
    writeln!(file, "o liquid")?;
    for [x, y, z] in liquid.corners.iter().map(|corner| corner.place) {
        writeln!(file, "v {x} {y} {z}")?;
    }
    for [x, y, z] in liquid.corners.iter().map(|corner| corner.normal) {
        writeln!(file, "vn {x} {y} {z}")?;
    }
    let normals = all.iter().filter(|i| geometry.has_normal(**i)).count();
    for triangle in &liquid.triangles {
        let [a, b, c] = triangle.map(|i| {
            let i = i as usize + 1;
            format!("{}//{}", all.len() + i, normals + i)
        });
        writeln!(file, "f {a} {b} {c}")?;
    }
    Ok(())
}

/// Writes these vertices of the current state, in order, and then the faces and lines that join
/// them.
pub fn write_vertices(
    file: &mut dyn Write,
    geometry: &Geometry,
    kept: &[u32],
    simulation: &Simulation,
) -> io::Result<()> {
    let positions = positions(simulation)?;
    let time = short(simulation.time(), DIGITS);
    writeln!(file, "# a3: t = {time} s, in m, y is up")?;
    let name = simulation.scene().name.replace(char::is_control, " ");
    writeln!(file, "o {name}")?;
    for i in kept {
        let [x, y, z] = positions[*i as usize];
        writeln!(file, "v {x} {y} {z}")?;
    }
    // The numbers of vertices and of their normals in the file, from 1 on; 0 of those left out.
    let mut numbers = vec![[0; 2]; geometry.vertices];
    let (normals, mut next) = (geometry.normals(&positions), 0);
    for (k, i) in kept.iter().enumerate() {
        numbers[*i as usize][0] = k + 1;
        if geometry.has_normal(*i) {
            next += 1;
            numbers[*i as usize][1] = next;
            let [x, y, z] = normals[*i as usize];
            writeln!(file, "vn {x} {y} {z}")?;
        }
    }
    for triangle in &geometry.triangles {
        let [[a, m], [b, n], [c, o]] = triangle.map(|i| numbers[i as usize]);
        writeln!(file, "f {a}//{m} {b}//{n} {c}//{o}")?;
    }
    for line in &geometry.lines {
        let [[a, _], [b, _]] = line.map(|i| numbers[i as usize]);
        writeln!(file, "l {a} {b}")?;
    }
    let points = geometry.points.iter().map(|i| numbers[*i as usize][0]);
    for number in points.filter(|number| *number > 0) {
        writeln!(file, "p {number}")?;
    }
    Ok(())
}
