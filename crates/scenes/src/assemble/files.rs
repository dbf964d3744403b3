//! What the bodies of a scene are made from: files of meshes, and its budget.

use std::sync::Arc;

use a3_core::contact::{ClosedMesh, Shape};
use a3_core::{Vector3, rotation};

use crate::budget::{BODIES, Budget, FACES, PARTICLES, Part, TOUCHING, TRIANGLES};
use crate::check::{at, positive};
use crate::description::Triple;
use crate::fault::Fault;
use crate::mesh::Mesh;

/// Reader of the files of a scene, and the budget from which their parts are taken.
pub(super) struct Files<'a> {
    pub budget: Budget,
    pub mesh: &'a mut dyn FnMut(&str) -> Result<Mesh, String>,
    /// Whether surfaces touch.
    pub touching: bool,
}

impl Files<'_> {
    /// Takes a body, its particles and other parts from the budget, before any memory is reserved.
    pub fn spend(&mut self, particles: usize, others: &[(usize, Part)]) -> Result<(), Fault> {
        let touching = if self.touching { particles } else { 0 };
        let own = [(1, BODIES), (particles, PARTICLES), (touching, TOUCHING)];
        for (count, part) in own.iter().chain(others) {
            self.budget.spend("", *count, *part)?;
        }
        Ok(())
    }

    /// Reads the mesh of a file.
    pub fn read(&mut self, file: &str) -> Result<Mesh, Fault> {
        at("file", (self.mesh)(file))
    }

    /// Reads the solid within the triangles of a file, scaled and turned about the file's origin,
    /// and its smallest extent (m). Points at the same place are merged.
    pub fn solid(
        &mut self,
        file: &str,
        scale: Option<f64>,
        turn: Option<Triple>,
    ) -> Result<(Shape, f64), Fault> {
        let scale = scale.unwrap_or(1.0);
        at("scale", positive("it", scale))?;
        let turn = rotation(Vector3::from(turn.unwrap_or_default()));
        let mesh = self.read(file)?;
        self.budget.spend("file", mesh.triangles.len(), TRIANGLES)?;
        let mesh = mesh.welded();
        self.budget.spend("file", mesh.triangles.len(), FACES)?;
        let points = mesh.positions.iter();
        let points: Vec<_> = points.map(|p| turn * (Vector3::from(*p) * scale)).collect();
        let far = Vector3::repeat(f64::INFINITY);
        let around = |(low, high): (Vector3<f64>, Vector3<f64>), p| (low.inf(p), high.sup(p));
        let (low, high) = points.iter().fold((far, -far), around);
        let solid = at("file", ClosedMesh::new(points, mesh.triangles))?;
        Ok((Shape::Mesh(Arc::new(solid)), (high - low).min()))
    }
}
