//! Wavefront OBJ: a file a frame. Particles are its vertices, in their order.

use std::io::{self, Write};
use std::path::PathBuf;

use a3_core::Simulation;

use super::Export;
use super::shape::{Shape, positions};
use crate::frames::Sequence;
use crate::{Failure, output};

/// A file a frame, or the last one only.
pub enum Obj {
    /// The only one.
    One(PathBuf),
    /// Those that are still to be written, and how many are.
    Many(Sequence, usize),
}

impl Export for Obj {
    fn add(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        let path = match self {
            Self::One(path) => path.clone(),
            Self::Many(sequence, count) => {
                *count += 1;
                sequence.file(*count - 1)
            }
        };
        output::write_with(&path, |file| write(file, simulation))
    }

    fn finish(self: Box<Self>) -> Result<(), Failure> {
        Ok(())
    }
}

/// About how many bytes a file has.
pub fn size(simulation: &Simulation) -> f64 {
    let shape = Shape::of(simulation);
    let (vertices, normals) = (simulation.particles(), shape.covered);
    let (faces, lines) = (shape.triangles.len(), shape.lines.len());
    36.0 * vertices as f64 + 37.0 * normals as f64 + 42.0 * faces as f64 + 16.0 * lines as f64
}

/// The state as it is now: `v`, and `vn` and `f` of what has a surface that is not torn, `l` and `p` of what has none.
pub fn write(file: &mut dyn Write, simulation: &Simulation) -> io::Result<()> {
    let shape = Shape::of(simulation);
    let positions = positions(simulation);
    writeln!(file, "# a3: t = {} s, in m, y is up", simulation.time())?;
    writeln!(file, "o {}", simulation.scene().name)?;
    for [x, y, z] in &positions {
        writeln!(file, "v {x} {y} {z}")?;
    }
    for [x, y, z] in &shape.normals(&positions)[..shape.covered] {
        writeln!(file, "vn {x} {y} {z}")?;
    }
    for triangle in &shape.triangles {
        let [a, b, c] = triangle.map(|i| i + 1);
        writeln!(file, "f {a}//{a} {b}//{b} {c}//{c}")?;
    }
    for [a, b] in &shape.lines {
        writeln!(file, "l {} {}", a + 1, b + 1)?;
    }
    for i in &shape.points {
        writeln!(file, "p {}", i + 1)?;
    }
    Ok(())
}
