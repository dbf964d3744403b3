//! Wavefront OBJ, a file for each frame. The vertices are the particles, in their order,
//! and after them the points of rigid bodies.

use std::io;
use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;

use a3_core::Simulation;
use a3_files::failure::Failure;
use a3_files::frames::Sequence;
use a3_files::output;
use a3_files::rounding::{DIGITS, short};
use a3_files::visible::in_a_line;
use a3_scenes::{Presentation, Surface};

use super::geometry::{Export, Geometry, Job, positions};
use crate::surfaces::Liquid;

/// Files of a frame each that are being written, by a function for the format.
pub struct Frames {
    pub presentation: Arc<Presentation>,
    pub files: Files,
    pub write: fn(&mut dyn Write, &Surface, &Simulation) -> io::Result<()>,
}

/// One file of the final state, or a numbered file for each frame.
pub enum Files {
    /// The file of the final state.
    One(PathBuf),
    /// The numbered files, and the number of the next frame.
    Many(Sequence, usize),
}

impl Export for Frames {
    fn add(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        let path = match &mut self.files {
            Files::One(path) => path.clone(),
            Files::Many(sequence, next) => {
                *next += 1;
                sequence.file(*next - 1)
            }
        };
        output::write_with(&path, |file| (self.write)(file, &self.presentation.surface, simulation))
    }

    fn finish(self: Box<Self>) -> Result<(), Failure> {
        Ok(())
    }
}

/// Returns the approximate size of a file (bytes).
pub fn size(job: Job) -> f64 {
    let geometry = Geometry::of(job.surface, job.simulation);
    let (faces, lines) = (geometry.triangles.len(), geometry.lines.len());
    let liquid = Liquid::of(job.simulation, |_| None);
    let vertices = geometry.vertices + liquid.corners.len();
    let faces = faces + liquid.triangles.len();
    73.0 * vertices as f64 + 42.0 * faces as f64 + 16.0 * lines as f64
}

/// Writes the current state: `v` of all vertices, `vn` and `f` of the surfaces except torn
/// triangles, and `l` and `p` of particles without a surface. The surface of a fluid is an object
/// of its own, with vertices after all others.
pub fn write(file: &mut dyn Write, surface: &Surface, simulation: &Simulation) -> io::Result<()> {
    let geometry = Geometry::of(surface, simulation);
    let liquid = Liquid::of(simulation, |_| None);
    let has_normals = !(geometry.triangles.is_empty() && liquid.triangles.is_empty());
    write_vertices(file, &geometry, simulation, has_normals)?;
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
    for triangle in &liquid.triangles {
        let [a, b, c] = triangle.map(|i| geometry.vertices + i as usize + 1);
        writeln!(file, "f {a}//{a} {b}//{b} {c}//{c}")?;
    }
    Ok(())
}

/// Writes the vertices of the current state, all or none with a normal, as other programs expect,
/// and then the faces and lines that join them.
fn write_vertices(
    file: &mut dyn Write,
    geometry: &Geometry,
    simulation: &Simulation,
    has_normals: bool,
) -> io::Result<()> {
    let positions = positions(simulation)?;
    let time = short(simulation.time(), DIGITS);
    writeln!(file, "# a3: t = {time} s, in m, y is up")?;
    let name = in_a_line(&simulation.scene().name);
    writeln!(file, "o {name}")?;
    for [x, y, z] in &positions {
        writeln!(file, "v {x} {y} {z}")?;
    }
    if has_normals {
        for [x, y, z] in geometry.normals(&positions) {
            writeln!(file, "vn {x} {y} {z}")?;
        }
    }
    for triangle in &geometry.triangles {
        let [a, b, c] = triangle.map(|i| i + 1);
        writeln!(file, "f {a}//{a} {b}//{b} {c}//{c}")?;
    }
    for line in &geometry.lines {
        let [a, b] = line.map(|i| i + 1);
        writeln!(file, "l {a} {b}")?;
    }
    for point in &geometry.points {
        writeln!(file, "p {}", point + 1)?;
    }
    Ok(())
}
