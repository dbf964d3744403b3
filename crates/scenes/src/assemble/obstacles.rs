//! Obstacles.

use a3_core::contact::{Obstacle, Shape};
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
pub(super) fn is_one_thick(all: &Description) -> bool {
    let spheres = all.sphere.iter().map(|spec| spec.thickness);
    let boxes = all.boxes.iter().map(|spec| spec.thickness);
    let capsules = all.capsule.iter().map(|spec| spec.thickness);
    let solids = all.obstacle.iter().map(|spec| spec.thickness);
    let mut thicknesses = spheres.chain(boxes).chain(capsules).chain(solids);
    thicknesses.any(|thickness| thickness.is_some())
        || matches!(all.floor, Some(Floor::Table(floor)) if floor.thickness.is_some())
}

/// Adds the obstacles of the description, the floor last.
pub(super) fn add(
    all: &Description,
    network: &mut Network,
    files: &mut Files,
) -> Result<(), Fault> {
    each(["sphere", "radius"], &all.sphere, network, sphere)?;
    each(["box", "size"], &all.boxes, network, cuboid)?;
    each(["capsule", "radius"], &all.capsule, network, capsule)?;
    let solid = |spec: &ObstacleSpec| solid(spec, files);
    each(["obstacle", "file"], &all.obstacle, network, solid)?;
    match &all.floor {
        None => Ok(()),
        Some(spec) => at("floor", network.add_obstacle(floor(spec)?)),
    }
}

/// Adds the obstacles of one kind. A network that refuses one has a fault of the other key.
fn each<T>(
    [kind, key]: [&str; 2],
    specs: &[T],
    network: &mut Network,
    mut make: impl FnMut(&T) -> Result<Obstacle, Fault>,
) -> Result<(), Fault> {
    let count = specs.len();
    if count > MAX_OBSTACLES {
        let why = format!("at most {MAX_OBSTACLES} are allowed, not {count}");
        return Err(Fault::new(kind, why));
    }
    for (k, spec) in specs.iter().enumerate() {
        let added = make(spec).and_then(|made| at(key, network.add_obstacle(made)));
        added.map_err(|fault| fault.within(&key_of(kind, k, count)))?;
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
        let solid = files.solid(&spec.file, spec.scale, spec.rotation);
        solid.map(|(shape, _)| shape)
    })
}

fn floor(spec: &Floor) -> Result<Obstacle, Fault> {
    let spec = match *spec {
        Floor::Height(height) => FloorSpec {
            height,
            ..FloorSpec::default()
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
    let (sine, shift) = (keys.sine.as_ref(), keys.shift.as_ref());
    let turn = keys.turn.as_ref();
    let (path, turn) = motion(sine, shift, turn, Vector3::from(from))?;
    let shape = shape()?;
    let thickness = keys.thickness.unwrap_or(0.0);
    at("friction", at_least(0.0, "it", keys.friction))?;
    at("restitution", share("it", keys.restitution))?;
    at("thickness", at_least(0.0, "it", thickness))?;
    Ok(Obstacle {
        shape,
        path,
        turn,
        friction: keys.friction,
        restitution: keys.restitution,
        thickness,
    })
}
