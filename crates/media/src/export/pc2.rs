//! `PointCache2`: the positions of every particle in every frame. Blender, 3ds Max and Maya apply
//! them to a mesh with as many points. That mesh is written beside the file, as OBJ, and stays
//! whole when something tears. Vertices that are in no face and no line are in neither, because
//! such programs leave them out of the mesh.
//!
//! The header has 32 bytes, all little endian: "POINTCACHE2\0", version 1 (i32), points (i32),
//! first frame (f32), frames a sample (f32), samples (i32). Then follow x, y and z (f32) of every
//! point of every sample.

use std::io::{self, Write};
use std::path::PathBuf;

use a3_core::Simulation;
use a3_files::failure::Failure;
use a3_files::frames::FrameTimes;
use a3_files::output::{self, Draft};
use a3_files::terminal;

use super::geometry::{Export, Geometry, Job, positions, rows, vertices};
use super::obj;

/// A `PointCache2` file that is being written, with its mesh.
pub struct Pc2 {
    draft: Draft,
    mesh: Draft,
    geometry: Geometry,
    /// The vertices that are written.
    kept: Vec<u32>,
    /// Whether the mesh is still to be written.
    first: bool,
    /// Paths of the file and of its mesh.
    names: (PathBuf, PathBuf),
}

/// Returns the largest possible size of the file (bytes).
pub fn size(simulation: &Simulation, frames: FrameTimes) -> f64 {
    32.0 + 12.0 * vertices(simulation) as f64 * frames.count as f64
}

impl Pc2 {
    /// Creates a file.
    pub fn new(job: Job) -> Result<Self, Failure> {
        let (path, mesh) = (job.path, job.path.with_extension("obj"));
        output::check(&mesh, &["obj"])?;
        let mut draft = Draft::new(path)?;
        let geometry = Geometry::of(job.surface, job.simulation);
        let kept = geometry.in_use();
        header(&mut draft, kept.len(), job.frames.count).map_err(|e| draft.failure(&e))?;
        Ok(Self {
            draft,
            mesh: Draft::new(&mesh)?,
            geometry,
            kept,
            first: true,
            names: (path.into(), mesh),
        })
    }
}

/// Writes the header.
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
            let (geometry, kept) = (&self.geometry, &self.kept);
            let (mesh, has_normals) = (&mut self.mesh, !geometry.triangles.is_empty());
            let written = obj::write_vertices(mesh, geometry, kept, simulation, has_normals);
            written.map_err(|e| self.mesh.failure(&e))?;
        }
        let written = positions(simulation).and_then(|all| {
            let kept = self.kept.iter().map(|i| all[*i as usize]);
            rows(&mut self.draft, &kept.collect::<Vec<_>>())
        });
        written.map_err(|e| self.draft.failure(&e))
    }

    fn finish(self: Box<Self>) -> Result<(), Failure> {
        self.mesh.place()?;
        self.draft.place()?;
        let (cache, mesh) = &self.names;
        terminal::say(&format!("{}: the mesh that {} moves\n", mesh.display(), cache.display()))
    }
}
