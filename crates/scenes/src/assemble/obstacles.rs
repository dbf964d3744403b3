//! Obstacles.

use std::sync::Arc;

use a3_core::contact::{ClosedMesh, Obstacle, Shape};
use a3_core::{Network, Vector3};

use super::files::Files;
use super::motion::motion;
use crate::check::{at, at_least, key_of, positive, share};
use crate::description::{
    BoxSpec, CapsuleSpec, Description, Floor, FloorSpec, Movable, ObstacleKeys, ObstacleSpec,
    SphereSpec, Triple,
};
use crate::fault::Fault;

/// Largest number of obstacles of one kind.
const MAX_OBSTACLES: usize = 1000;

/// Returns whether an obstacle has a thickness, so that surfaces touch it.
pub(super) fn is_one_thick(description: &Description) -> bool {
    let spheres = description.sphere.iter().map(|spec| spec.thickness);
    let boxes = description.boxes.iter().map(|spec| spec.thickness);
    let capsules = description.capsule.iter().map(|spec| spec.thickness);
    let solids = description.obstacle.iter().map(|spec| spec.thickness);
    let floor = match description.floor {
        Some(Floor::Table(FloorSpec { thickness, .. })) => thickness,
        _ => None,
    };
    let mut all = spheres.chain(boxes).chain(capsules).chain(solids);
    floor.is_some() || all.any(|thickness| thickness.is_some())
}

/// Adds the obstacles of the description, the floor last.
pub(super) fn add(
    description: &Description,
    network: &mut Network,
    files: &mut Files,
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
        at("file", network.add_obstacle(solid(spec, files)?))
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
    made(&spec.keys(), spec.center, || Ok(Shape::Sphere { radius }))
}

fn cuboid(spec: &BoxSpec) -> Result<Obstacle, Fault> {
    made(&spec.keys(), spec.center, || {
        let size = Vector3::from(spec.size);
        let rotation = Vector3::from(spec.rotation.unwrap_or_default());
        for edge in spec.size {
            at("size", positive("each edge", edge))?;
        }
        at("size", Shape::turned_box(0.5 * size, rotation))
    })
}

fn capsule(spec: &CapsuleSpec) -> Result<Obstacle, Fault> {
    let axis = Vector3::from(spec.to) - Vector3::from(spec.from);
    let shape = Shape::Capsule {
        ends: [Vector3::zeros(), axis],
        radius: spec.radius,
    };
    made(&spec.keys(), spec.from, || Ok(shape))
}

/// Reads the solid within the triangles of a file.
fn solid(spec: &ObstacleSpec, files: &mut Files) -> Result<Obstacle, Fault> {
    made(&spec.keys(), spec.at.unwrap_or_default(), || {
        let (points, triangles) = files.surface(&spec.file, spec.scale, spec.rotation)?;
        let mesh = at("file", ClosedMesh::new(points, triangles))?;
        Ok(Shape::Mesh(Arc::new(mesh)))
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
    let keys = ObstacleKeys {
        friction: spec.friction,
        restitution: spec.restitution,
        thickness: spec.thickness,
        ..ObstacleKeys::default()
    };
    let floor = made(&keys, [0.0, spec.height, 0.0], || Ok(Shape::Floor));
    floor.map_err(|fault| fault.within("floor"))
}

/// Makes an obstacle that begins at `from` (m).
fn made(
    keys: &ObstacleKeys,
    from: Triple,
    shape: impl FnOnce() -> Result<Shape, Fault>,
) -> Result<Obstacle, Fault> {
    let ObstacleKeys {
        friction,
        restitution,
        thickness,
        sine,
        shift,
        turn,
    } = keys;
    let from = Vector3::from(from);
    let (path, turn) = motion(sine.as_ref(), shift.as_ref(), turn.as_ref(), from)?;
    let shape = shape()?;
    let thickness = thickness.unwrap_or(0.0);
    at("friction", at_least(0.0, "it", *friction))?;
    at("restitution", share("it", *restitution))?;
    at("thickness", at_least(0.0, "it", thickness))?;
    Ok(Obstacle {
        shape,
        path,
        turn,
        friction: *friction,
        restitution: *restitution,
        thickness,
    })
}
