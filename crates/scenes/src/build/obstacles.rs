//! Obstacles.

use a3_core::colliders::{Capsule, Cuboid, Floor, Sphere};
use a3_core::{Network, Vector3};

use super::pins::path;
use crate::check::{at, key_of, number, positive, vector};
use crate::description::{BoxSpec, CapsuleSpec, Description, SphereSpec};
use crate::fault::Fault;

/// Largest number of obstacles of one kind.
const MAX_OBSTACLES: usize = 1000;

/// Adds the obstacles of the description.
pub(super) fn add(description: &Description, network: &mut Network) -> Result<(), Fault> {
    if let Some(height) = description.floor {
        let height = number("floor", height)?;
        network.set_floor(Floor { height });
    }
    each("sphere", &description.sphere, |spec| {
        network.add_sphere(sphere(spec)?);
        Ok(())
    })?;
    each("box", &description.boxes, |spec| {
        network.add_box(cuboid(spec)?);
        Ok(())
    })?;
    each("capsule", &description.capsule, |spec| {
        network.add_capsule(capsule(spec)?);
        Ok(())
    })
}

/// Adds each of the obstacles of a kind.
fn each<T>(
    kind: &str,
    specs: &[T],
    mut add: impl FnMut(&T) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let count = specs.len();
    if count > MAX_OBSTACLES {
        let why = format!("there are at most {MAX_OBSTACLES}, not {count}");
        return Err(Fault::new(kind, why));
    }
    for (k, spec) in specs.iter().enumerate() {
        add(spec).map_err(|fault| fault.within(&key_of(kind, k, count)))?;
    }
    Ok(())
}

fn sphere(spec: &SphereSpec) -> Result<Sphere, Fault> {
    at("radius", positive("it", spec.radius))?;
    let center = vector("center", spec.center)?;
    Ok(Sphere {
        path: path(center, spec.sine.as_ref(), spec.shift.as_ref())?,
        radius: spec.radius,
    })
}

fn cuboid(spec: &BoxSpec) -> Result<Cuboid, Fault> {
    let center = vector("center", spec.center)?;
    let path = path(center, spec.sine.as_ref(), spec.shift.as_ref())?;
    let size = vector("size", spec.size)?;
    let turn = vector("rotation", spec.rotation.unwrap_or_default())?;
    for edge in spec.size {
        at("size", positive("each edge", edge))?;
    }
    at("size", Cuboid::new(path, 0.5 * size, turn))
}

fn capsule(spec: &CapsuleSpec) -> Result<Capsule, Fault> {
    let (from, to) = (vector("from", spec.from)?, vector("to", spec.to)?);
    let path = path(from, spec.sine.as_ref(), spec.shift.as_ref())?;
    let ends = [Vector3::zeros(), to - from];
    at("radius", Capsule::new(path, ends, spec.radius))
}
