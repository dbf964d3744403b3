//! `PointCache2`: positions of every particle and frame, as Blender, 3ds Max and Maya read them onto a mesh that has as many
//! points. That mesh is written beside, as OBJ, and stays whole when something tears.
//!
//! A header of 32 bytes, all little endian: "POINTCACHE2\0", version 1 (i32), points (i32), first frame (f32), frames a
//! sample (f32), samples (i32). Then x, y, z (f32) of every point of every sample.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use a3_core::Simulation;

use super::Export;
use super::shape::positions;
use super::{obj, rows};
use crate::output::{self, Draft};
use crate::{Failure, frames::Frames};

pub struct Pc2 {
    draft: Draft,
    mesh: Draft,
    /// The mesh is still to be written.
    first: bool,
    names: (PathBuf, PathBuf),
}

/// How many bytes it has.
pub fn size(simulation: &Simulation, frames: Frames) -> f64 {
    32.0 + 12.0 * simulation.particles() as f64 * frames.count as f64
}

impl Pc2 {
    pub fn new(path: &Path, simulation: &Simulation, frames: Frames) -> Result<Self, Failure> {
        let mesh = path.with_extension("obj");
        output::check(&mesh, &["obj"])?;
        let mut draft = Draft::new(path)?;
        header(&mut draft, simulation.particles(), frames.count).map_err(|e| draft.failure(&e))?;
        Ok(Self {
            draft,
            mesh: Draft::new(&mesh)?,
            first: true,
            names: (path.into(), mesh),
        })
    }
}

fn header(file: &mut dyn Write, points: usize, samples: usize) -> io::Result<()> {
    file.write_all(b"POINTCACHE2\0")?;
    file.write_all(&1i32.to_le_bytes())?;
    file.write_all(&(points as i32).to_le_bytes())?;
    file.write_all(&0f32.to_le_bytes())?;
    file.write_all(&1f32.to_le_bytes())?;
    file.write_all(&(samples as i32).to_le_bytes())
}

impl Export for Pc2 {
    fn add(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        if std::mem::take(&mut self.first) {
            obj::write(&mut self.mesh, simulation).map_err(|e| self.mesh.failure(&e))?;
        }
        let written = rows(&mut self.draft, &positions(simulation));
        written.map_err(|e| self.draft.failure(&e))
    }

    fn finish(self: Box<Self>) -> Result<(), Failure> {
        self.mesh.place()?;
        self.draft.place()?;
        let (cache, mesh) = &self.names;
        output::say(&format!(
            "{}: the mesh that {} moves\n",
            mesh.display(),
            cache.display()
        ))
    }
}
