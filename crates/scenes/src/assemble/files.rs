//! Files of meshes that a scene names, and its budget.

use a3_core::{Vector3, rotation};

use crate::budget::{Budget, FACES, TRIANGLES};
use crate::check::{at, positive};
use crate::description::Triple;
use crate::fault::Fault;
use crate::mesh::Mesh;

/// Reader of the files of a scene, and the budget from which their parts are taken.
pub(super) struct Files<'a> {
    pub budget: Budget,
    pub mesh: &'a mut dyn FnMut(&str) -> Result<Mesh, String>,
}

impl Files<'_> {
    /// Reads the mesh of a file.
    pub fn read(&mut self, file: &str) -> Result<Mesh, Fault> {
        at("file", (self.mesh)(file))
    }

    /// Reads the points (m), scaled and turned about the file's origin, and the triangles of the
    /// surface of a solid. Points at the same place are merged.
    pub fn surface(
        &mut self,
        file: &str,
        scale: Option<f64>,
        turn: Option<Triple>,
    ) -> Result<(Vec<Vector3<f64>>, Vec<[u32; 3]>), Fault> {
        let scale = scale.unwrap_or(1.0);
        at("scale", positive("it", scale))?;
        let turn = rotation(Vector3::from(turn.unwrap_or_default()));
        let mesh = self.read(file)?;
        self.budget.spend("file", mesh.triangles.len(), TRIANGLES)?;
        let mesh = mesh.welded();
        self.budget.spend("file", mesh.triangles.len(), FACES)?;
        let points = mesh.positions.iter();
        let points = points.map(|p| turn * (Vector3::from(*p) * scale));
        Ok((points.collect(), mesh.triangles))
    }
}
