//! What acts on bodies: gravity, drag, tearing, wind and obstacles.

use a3_core::contact::{Obstacle, Shape};
use a3_core::elements::{Air, Region, Wind};
use a3_core::{Network, Vector3};

use super::assembly::Files;
use super::motion::motion;
use crate::description::{
    BoxSpec, CapsuleSpec, Description, Floor, FloorSpec, Movable, ObstacleKeys, ObstacleSpec,
    RegionSpec, SphereSpec, Triple, WindSpec,
};
use crate::fault::{Fault, at, at_least, key_of, positive, share};

/// Density of air (kg/m3), drag coefficient and lift coefficient, where they are not given.
const AIR: [(&str, f64); 3] = [("density", 1.2), ("drag", 1.2), ("lift", 0.6)];

/// Sets gravity, drag and the stretch at which springs break, and breaks the springs that are torn.
pub(super) fn set(description: &Description, network: &mut Network) -> Result<(), Fault> {
    if let Some(g) = description.gravity {
        network.set_gravity(Vector3::from(g));
    }
    let drag = match (description.drag, description.drag_per_mass) {
        (Some(_), Some(_)) => return Err(Fault::not_both("drag", "drag_per_mass")),
        (Some(drag), None) => Some(("drag", drag)),
        (None, Some(rate)) => Some(("drag_per_mass", rate * mean_mass(network))),
        (None, None) => None,
    };
    if let Some((key, drag)) = drag {
        at(key, network.set_drag(drag))?;
    }
    at("tear", network.set_tear(description.tear))?;
    at("torn", network.break_springs(&description.torn))
}

/// Creates the wind on the particles or the triangles of a network.
pub(super) fn wind(spec: &WindSpec, network: &Network) -> Result<Wind, Fault> {
    let given = [
        ("force", spec.force),
        ("force_per_mass", spec.force_per_mass),
        ("velocity", spec.velocity),
    ];
    let given = given.into_iter().filter_map(|(key, x)| Some((key, x?)));
    let given: Vec<_> = given.collect();
    let [(key, mean_wind)] = given[..] else {
        refuse!("": "give one of the keys `force`, `force_per_mass` and `velocity`");
    };
    let mean_wind = Vector3::from(mean_wind);
    if key != "velocity" {
        for (&(key, _), given) in AIR.iter().zip([spec.density, spec.drag, spec.lift]) {
            refuse!(if given.is_some() => key: "only a wind with a `velocity` has this key");
        }
        let by_mass = key == "force_per_mass";
        let factor = if by_mass { mean_mass(network) } else { 1.0 };
        return blown(spec, Wind::new(spec.seed, mean_wind * factor));
    }
    let [density, drag, lift] = air(spec);
    for ((key, _), number) in AIR.iter().zip([density, drag, lift]) {
        at(key, at_least(0.0, "it", number))?;
    }
    let air = at("", Air::new(density, drag, lift))?;
    blown(spec, Wind::on_triangles(spec.seed, mean_wind, air))
}

/// Returns the density of the air of a wind (kg/m3), its drag coefficient and its lift coefficient.
pub fn air(spec: &WindSpec) -> [f64; 3] {
    let given = [spec.density, spec.drag, spec.lift];
    [0, 1, 2].map(|k| given[k].unwrap_or(AIR[k].1))
}

/// Sets the region of a wind, shifts it in time, and leaves out its gusts if it is steady.
fn blown(spec: &WindSpec, mut wind: Wind) -> Result<Wind, Fault> {
    if let Some(region) = &spec.region {
        let region = self::region(region).map_err(|fault| fault.within("region"))?;
        wind = at("region", wind.within(region))?;
    }
    if spec.steady {
        wind = wind.steady();
    }
    Ok(wind.ahead(spec.ahead))
}

fn region(spec: &RegionSpec) -> Result<Region, Fault> {
    let length = spec.length.unwrap_or(spec.radius);
    at("radius", positive("it", spec.radius))?;
    at("length", positive("it", length))?;
    let (sine, shift, turn) = (spec.sine.as_ref(), spec.shift.as_ref(), spec.turn.as_ref());
    let (path, turn) = motion(sine, shift, turn, Vector3::from(spec.at))?;
    Ok(Region { path, turn, radius: spec.radius, length })
}

/// Returns the mean mass (kg) of the particles. Points of rigid bodies have none, and do not count.
fn mean_mass(network: &Network) -> f64 {
    let masses = network.masses().iter().copied().filter(|m| *m > 0.0);
    let masses: Vec<_> = masses.collect();
    // The mean of equal masses is their common value, without rounding.
    if masses.iter().all(|m| *m == masses[0]) {
        masses[0]
    } else {
        masses.iter().sum::<f64>() / masses.len() as f64
    }
}

/// Largest number of obstacles of one kind.
const MAX_OBSTACLES: usize = 1000;

/// Returns whether an obstacle has a thickness, so that surfaces touch it.
pub(super) fn is_one_thick(all: &Description) -> bool {
    all.sphere.iter().any(|it| it.thickness.is_some())
        || all.boxes.iter().any(|it| it.thickness.is_some())
        || all.capsule.iter().any(|it| it.thickness.is_some())
        || all.obstacle.iter().any(|it| it.thickness.is_some())
        || matches!(all.floor, Some(Floor::Table(floor)) if floor.thickness.is_some())
}

/// Adds the obstacles of the description, the floor last.
pub(super) fn add_obstacles(
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
    refuse!(if count > MAX_OBSTACLES => kind: "at most {MAX_OBSTACLES} are allowed, not {count}");
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
    let shape = Shape::Capsule { ends: [Vector3::zeros(), axis], radius: spec.radius };
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
        Floor::Height(height) => FloorSpec { height, ..FloorSpec::default() },
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
