//! Obstacles.

use std::sync::Arc;

use a3_core::contact::{ClosedMesh, Obstacle, Shape};
use a3_core::{Network, Path, Vector3, rotation};

use super::motion::motion;
use crate::budget::{Budget, FACES, TRIANGLES};
use crate::check::{at, at_least, key_of, positive, share};
use crate::description::{
    BoxSpec, CapsuleSpec, Description, Floor, FloorSpec, ObstacleSpec, SphereSpec,
};
use crate::fault::Fault;
use crate::mesh::Mesh;

/// Largest number of obstacles of one kind.
const MAX_OBSTACLES: usize = 1000;

/// Returns whether an obstacle has a thickness, so that surfaces touch it.
pub(super) fn is_one_thick(description: &Description) -> bool {
    let spheres = description.sphere.iter().map(|spec| spec.thickness);
    let boxes = description.boxes.iter().map(|spec| spec.thickness);
    let capsules = description.capsule.iter().map(|spec| spec.thickness);
    let floor = match description.floor {
        Some(Floor::Table(FloorSpec { thickness, .. })) => thickness,
        _ => None,
    };
    let solids = description.obstacle.iter().map(|spec| spec.thickness);
    let solid = spheres.chain(boxes).chain(capsules).chain(solids);
    let mut all = solid.chain([floor]);
    all.any(|thickness| thickness.is_some())
}

/// Adds the obstacles of the description, the floor last. `mesh` reads a file of triangles.
pub(super) fn add(
    description: &Description,
    network: &mut Network,
    budget: &mut Budget,
    mesh: &mut dyn FnMut(&str) -> Result<Mesh, String>,
) -> Result<(), Fault> {
    each("sphere", &description.sphere, |spec| {
        at("radius", network.add_obstacle(sphere(spec)?))
    })?;
    each("box", &description.boxes, |spec| {
        at("size", network.add_obstacle(cuboid(spec)?))
    })?;
    each("capsule", &description.capsule, |spec| {
        at("radius", network.add_obstacle(capsule(spec)?))
    })?;
    each("obstacle", &description.obstacle, |spec| {
        at("file", network.add_obstacle(solid(spec, budget, mesh)?))
    })?;
    match &description.floor {
        None => Ok(()),
        Some(spec) => at("floor", network.add_obstacle(floor(spec)?)),
    }
}

/// Adds the obstacles of one kind.
fn each<T>(
    kind: &str,
    specs: &[T],
    mut add: impl FnMut(&T) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let count = specs.len();
    if count > MAX_OBSTACLES {
        let why = format!("at most {MAX_OBSTACLES} are allowed, not {count}");
        return Err(Fault::new(kind, why));
    }
    for (k, spec) in specs.iter().enumerate() {
        add(spec).map_err(|fault| fault.within(&key_of(kind, k, count)))?;
    }
    Ok(())
}

fn sphere(spec: &SphereSpec) -> Result<Obstacle, Fault> {
    let radius = spec.radius;
    at("radius", positive("it", radius))?;
    let center = Vector3::from(spec.center);
    let (path, turn) = motion(
        spec.sine.as_ref(),
        spec.shift.as_ref(),
        spec.turn.as_ref(),
        center,
    )?;
    Ok(Obstacle {
        shape: Shape::Sphere { radius },
        path,
        turn,
        friction: friction(spec.friction)?,
        restitution: restitution(spec.restitution)?,
        thickness: thickness(spec.thickness)?,
    })
}

fn cuboid(spec: &BoxSpec) -> Result<Obstacle, Fault> {
    let center = Vector3::from(spec.center);
    let (path, turn) = motion(
        spec.sine.as_ref(),
        spec.shift.as_ref(),
        spec.turn.as_ref(),
        center,
    )?;
    let size = Vector3::from(spec.size);
    let rotation = Vector3::from(spec.rotation.unwrap_or_default());
    for edge in spec.size {
        at("size", positive("each edge", edge))?;
    }
    Ok(Obstacle {
        shape: at("size", Shape::turned_box(0.5 * size, rotation))?,
        path,
        turn,
        friction: friction(spec.friction)?,
        restitution: restitution(spec.restitution)?,
        thickness: thickness(spec.thickness)?,
    })
}

fn capsule(spec: &CapsuleSpec) -> Result<Obstacle, Fault> {
    let (from, to) = (Vector3::from(spec.from), Vector3::from(spec.to));
    let (path, turn) = motion(
        spec.sine.as_ref(),
        spec.shift.as_ref(),
        spec.turn.as_ref(),
        from,
    )?;
    Ok(Obstacle {
        shape: Shape::Capsule {
            ends: [Vector3::zeros(), to - from],
            radius: spec.radius,
        },
        path,
        turn,
        friction: friction(spec.friction)?,
        restitution: restitution(spec.restitution)?,
        thickness: thickness(spec.thickness)?,
    })
}

/// Reads the solid within the triangles of a file. Points at the same place are merged.
fn solid(
    spec: &ObstacleSpec,
    budget: &mut Budget,
    mesh: &mut dyn FnMut(&str) -> Result<Mesh, String>,
) -> Result<Obstacle, Fault> {
    let (path, turn) = motion(
        spec.sine.as_ref(),
        spec.shift.as_ref(),
        spec.turn.as_ref(),
        Vector3::from(spec.at.unwrap_or_default()),
    )?;
    let scale = spec.scale.unwrap_or(1.0);
    at("scale", positive("it", scale))?;
    let rotation = rotation(Vector3::from(spec.rotation.unwrap_or_default()));
    let mesh = at("file", mesh(&spec.file))?;
    budget.spend("file", mesh.triangles.len(), TRIANGLES)?;
    let mesh = mesh.welded();
    budget.spend("file", mesh.triangles.len(), FACES)?;
    let points = mesh.positions.iter();
    let points = points.map(|p| rotation * (Vector3::from(*p) * scale));
    let mesh = at("file", ClosedMesh::new(points.collect(), mesh.triangles))?;
    Ok(Obstacle {
        shape: Shape::Mesh(Arc::new(mesh)),
        path,
        turn,
        friction: friction(spec.friction)?,
        restitution: restitution(spec.restitution)?,
        thickness: thickness(spec.thickness)?,
    })
}

fn floor(spec: &Floor) -> Result<Obstacle, Fault> {
    let spec = match *spec {
        Floor::Height(height) => FloorSpec {
            height,
            friction: 0.0,
            restitution: 0.0,
            thickness: None,
        },
        Floor::Table(spec) => spec,
    };
    let within = |fault: Fault| fault.within("floor");
    Ok(Obstacle {
        shape: Shape::Floor,
        path: Path::Still(Vector3::new(0.0, spec.height, 0.0)),
        turn: None,
        friction: friction(spec.friction).map_err(within)?,
        restitution: restitution(spec.restitution).map_err(within)?,
        thickness: thickness(spec.thickness).map_err(within)?,
    })
}

fn friction(mu: f64) -> Result<f64, Fault> {
    at("friction", at_least(0.0, "it", mu))?;
    Ok(mu)
}

fn restitution(e: f64) -> Result<f64, Fault> {
    at("restitution", share("it", e))?;
    Ok(e)
}

fn thickness(given: Option<f64>) -> Result<f64, Fault> {
    let thickness = given.unwrap_or(0.0);
    at("thickness", at_least(0.0, "it", thickness))?;
    Ok(thickness)
}
