//! Rigid bodies.

use std::sync::Arc;

use a3_core::contact::{ClosedMesh, Shape, Skin};
use a3_core::rigid::{Body as Rigid, MassProperties, Part, Rotation};
use a3_core::{Vector3, rotation};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion};

use super::assembly::{Assembly, Body, Counts};
use super::skins::point_skin;
use super::soaked::{leak, soaked};
use crate::budget::{Budget, FACES, TRIANGLES};
use crate::check::{at, at_least, key_of, one_of, positive};
use crate::description::{Fluid, PartSpec, Pin, RigidBody, Spot};
use crate::fault::Fault;
use crate::mesh::Mesh;

/// Default thickness of a body, relative to its smallest part.
const THICKNESS: f64 = 0.02;

/// Rigid body with its parts, relative to its origin.
pub(super) struct LoadedBody<'a> {
    body: &'a RigidBody,
    parts: Vec<Part>,
    /// Smallest extent of a part (m).
    smallest: f64,
    /// Places that a fluid touches (m), relative to the origin.
    soaked: Vec<Vector3<f64>>,
    /// Sentence that its walls leak, if they do.
    pub leak: Option<String>,
}

impl<'a> LoadedBody<'a> {
    /// Reads the files of the body by `mesh`. A `fluid` of the scene touches it.
    pub fn load(
        body: &'a RigidBody,
        fluid: Option<&Fluid>,
        budget: &mut Budget,
        mesh: &mut dyn FnMut(&str) -> Result<Mesh, String>,
    ) -> Result<Self, Fault> {
        if body.parts.is_empty() {
            let why = "a body needs at least one, such as [{ box = [1, 1, 1] }]";
            return Err(Fault::new("parts", why));
        }
        let mut loaded = Self {
            body,
            parts: vec![],
            smallest: f64::INFINITY,
            soaked: vec![],
            leak: None,
        };
        for (k, spec) in body.parts.iter().enumerate() {
            let within = |fault: Fault| fault.within(&key_of("parts", k, body.parts.len()));
            let (shape, extent) = shape(spec, budget, mesh).map_err(within)?;
            loaded.smallest = loaded.smallest.min(extent);
            loaded.parts.push(Part {
                shape,
                at: Vector3::from(spec.at.unwrap_or_default()),
            });
        }
        if let Some(fluid) = fluid {
            loaded.soaked = soaked(&loaded.parts, loaded.of_density(1.0)?.mass, fluid)?;
            loaded.leak = leak(&loaded.parts, loaded.soaked.len(), fluid);
        }
        Ok(loaded)
    }

    /// Returns the mass, the centre and the inertia of all parts together at a density (kg/m3),
    /// relative to the origin.
    fn of_density(&self, density: f64) -> Result<MassProperties, Fault> {
        let mut all = MassProperties::default();
        for part in &self.parts {
            let own = at("parts", MassProperties::of(&part.shape, density))?;
            all += own.moved(part.at);
        }
        Ok(all)
    }

    /// Returns the mass, the centre and the inertia of the body, relative to the origin.
    fn properties(&self) -> Result<MassProperties, Fault> {
        let (by_volume, number) = one_of(("density", self.body.density), ("mass", self.body.mass))?;
        at(
            if by_volume { "density" } else { "mass" },
            positive("it", number),
        )?;
        let mut all = self.of_density(1.0)?;
        let scale = if by_volume { number } else { number / all.mass };
        (all.mass, all.inertia) = (all.mass * scale, all.inertia * scale);
        if let Some(inertia) = self.body.inertia {
            all.inertia = Matrix3::from_diagonal(&Vector3::from(inertia));
        }
        Ok(all)
    }
}

impl Body for LoadedBody<'_> {
    fn counts(&self) -> Result<Counts, Fault> {
        let points = |part: &Part| part.shape.simplices().points.len();
        Ok(Counts {
            particles: 1 + self.parts.iter().map(points).sum::<usize>() + self.soaked.len(),
            smoothed: self.soaked.len(),
            parts: self.parts.len(),
            ..Counts::default()
        })
    }

    fn add_to(&self, assembly: &mut Assembly) -> Result<(), Fault> {
        let body = self.body;
        let properties = self.properties()?;
        let (moments, axes) = properties.principal();
        let mut parts = vec![];
        for part in &self.parts {
            parts.push(Part {
                shape: at("parts", part.shape.turned(&axes.transpose()))?,
                at: axes.tr_mul(&(part.at - properties.center)),
            });
        }
        let center = assembly.masses.len();
        let made = Rigid::new(center, center + 1, moments, parts);
        let key = if body.inertia.is_some() {
            "inertia"
        } else {
            "parts"
        };
        let soaked = self.soaked.iter();
        let made = at(key, made)?
            .with_points(soaked.map(|place| axes.tr_mul(&(place - properties.center))));
        let turn = rotation(Vector3::from(body.rotation.unwrap_or_default()));
        let orientation = Rotation3::from_matrix_unchecked(turn * axes);
        let q = *UnitQuaternion::from_rotation_matrix(&orientation).quaternion();
        let spin = Vector3::from(body.spin.unwrap_or_default());
        let rotation = Rotation {
            q,
            momentum: made.momentum(q, spin),
        };
        let origin = Vector3::from(body.at.unwrap_or_default());
        let place = origin + turn * properties.center;
        let count = 1 + made.points().len();
        // The network moves the points to their places when it is complete.
        assembly.positions.extend(vec![place; count]);
        let velocity = Vector3::from(body.velocity.unwrap_or_default());
        assembly.velocities.extend(vec![velocity; count]);
        assembly.masses.extend(vec![properties.mass; count]);
        let thickness = body.thickness.unwrap_or(THICKNESS * self.smallest);
        let rolling = body.rolling_friction;
        at("rolling_friction", at_least(0.0, "it", rolling))?;
        let skin = Skin {
            rolling,
            // A face rests on several points.
            ..point_skin(
                0.25 * properties.mass,
                thickness,
                body.contact_stiffness,
                [body.friction, body.restitution],
            )?
        };
        assembly.skins.extend(vec![skin; count]);
        if !self.soaked.is_empty() {
            let end = made.points().end;
            assembly.soaked.push(end - self.soaked.len()..end);
        }
        assembly.rigid.push((made, rotation));
        Ok(())
    }

    fn pins(&self) -> &[Pin] {
        &self.body.pin
    }

    fn spot(&self, _: Spot, _: &[Vector3<f64>]) -> Option<Vec<usize>> {
        None
    }
}

/// Returns the shape of a part, and its smallest extent (m).
fn shape(
    spec: &PartSpec,
    budget: &mut Budget,
    mesh: &mut dyn FnMut(&str) -> Result<Mesh, String>,
) -> Result<(Shape, f64), Fault> {
    let turn = Vector3::from(spec.rotation.unwrap_or_default());
    if spec.scale.is_some() && spec.file.is_none() {
        return Err(Fault::new(
            "scale",
            "it is that of a `file`, which is missing",
        ));
    }
    match (spec.cuboid, spec.ball, spec.capsule, &spec.file) {
        (Some(size), None, None, None) => {
            for edge in size {
                at("box", positive("each edge", edge))?;
            }
            let size = Vector3::from(size);
            Ok((at("box", Shape::turned_box(0.5 * size, turn))?, size.min()))
        }
        (None, Some(radius), None, None) => {
            at("ball", positive("its radius", radius))?;
            Ok((Shape::Sphere { radius }, 2.0 * radius))
        }
        (None, None, Some([length, radius]), None) => {
            at("capsule", positive("its length", length))?;
            at("capsule", positive("its radius", radius))?;
            let end = rotation(turn) * Vector3::new(0.0, 0.5 * length, 0.0);
            let ends = [-end, end];
            Ok((Shape::Capsule { ends, radius }, 2.0 * radius))
        }
        (None, None, None, Some(file)) => {
            let scale = spec.scale.unwrap_or(1.0);
            at("scale", positive("it", scale))?;
            let read = at("file", mesh(file))?;
            budget.spend("file", read.triangles.len(), TRIANGLES)?;
            let read = read.welded();
            budget.spend("file", read.triangles.len(), FACES)?;
            let turn = rotation(turn);
            let points = read.positions.iter();
            let points: Vec<_> = points.map(|p| turn * (Vector3::from(*p) * scale)).collect();
            let range = |axis: usize| {
                let along = points.iter().map(|p| p[axis]);
                let (low, high) = along
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                        (low.min(x), high.max(x))
                    });
                high - low
            };
            let extent = (0..3).map(range).fold(f64::INFINITY, f64::min);
            let mesh = at("file", ClosedMesh::new(points, read.triangles))?;
            Ok((Shape::Mesh(Arc::new(mesh)), extent))
        }
        _ => Err(Fault::new(
            "",
            "a part is one of box, ball, capsule and file, such as { ball = 0.2 }",
        )),
    }
}
