//! Rigid bodies, and their points that a fluid touches: particles of the fluid that the body
//! carries.

use a3_core::contact::Shape;
use a3_core::rigid::{Body as Rigid, MassProperties, Part, Rotation};
use a3_core::{Vector3, rotation};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion};

use super::assembly::{Assembly, Body, Files, point_skin};
use super::fluid::LAYERS;
use crate::budget::{PARTS, SMOOTHED};
use crate::description::{Fluid, Keys, PartSpec, RigidBody};
use crate::fault::{Fault, at, at_least, key_of, positive, positive_one};

/// Default thickness of a body, relative to its smallest part.
const THICKNESS: f64 = 0.02;

/// Returns the mass, the centre and the inertia of all parts together at 1 kg/m3, relative to the
/// origin.
fn of_parts(parts: &[Part]) -> Result<MassProperties, Fault> {
    let mut all = MassProperties::default();
    for part in parts {
        let own = at("parts", MassProperties::of(&part.shape, 1.0))?;
        all += own.moved(part.at);
    }
    Ok(all)
}

impl RigidBody {
    /// Returns the parts, relative to the origin, and the smallest extent of one (m).
    fn loaded(&self, files: &mut Files) -> Result<(Vec<Part>, f64), Fault> {
        refuse!(if self.parts.is_empty() => "parts":
            "a body needs at least one, such as [{{ box = [1, 1, 1] }}]");
        let (mut parts, mut smallest) = (vec![], f64::INFINITY);
        for (k, spec) in self.parts.iter().enumerate() {
            let within = |fault: Fault| fault.within(&key_of("parts", k, self.parts.len()));
            let (shape, extent) = shape(spec, files).map_err(within)?;
            smallest = extent.min(smallest);
            let at = Vector3::from(spec.at.unwrap_or_default());
            parts.push(Part { shape, at });
        }
        Ok((parts, smallest))
    }

    /// Returns the mass, the centre and the inertia of the body, relative to the origin.
    fn properties(&self, parts: &[Part]) -> Result<MassProperties, Fault> {
        let (by_volume, number) = positive_one(("density", self.density), ("mass", self.mass))?;
        let mut all = of_parts(parts)?;
        let scale = if by_volume { number } else { number / all.mass };
        (all.mass, all.inertia) = (all.mass * scale, all.inertia * scale);
        if let Some(inertia) = self.inertia {
            all.inertia = Matrix3::from_diagonal(&Vector3::from(inertia));
        }
        Ok(all)
    }
}

impl Body for RigidBody {
    fn add_to(&self, assembly: &mut Assembly, files: &mut Files) -> Result<(), Fault> {
        let (mut parts, smallest) = self.loaded(files)?;
        let mut wet = vec![];
        if let Some(fluid) = assembly.liquid {
            wet = soaked(&parts, of_parts(&parts)?.mass, fluid)?;
            let leak = leak(&parts, wet.len(), fluid);
            assembly.presentation.notes.extend(leak);
        }
        let points = parts.iter().map(|part| part.shape.simplices().points.len());
        let particles = 1 + points.sum::<usize>() + wet.len();
        files.spend(particles, &[(parts.len(), PARTS), (wet.len(), SMOOTHED)])?;
        let properties = self.properties(&parts)?;
        let (moments, axes) = properties.principal();
        for part in &mut parts {
            part.shape = at("parts", part.shape.turned(&axes.transpose()))?;
            part.at = axes.tr_mul(&(part.at - properties.center));
        }
        let center = assembly.masses.len();
        let made = Rigid::new(center, center + 1, moments, parts);
        let key = self.inertia.map_or("parts", |_| "inertia");
        let own = |place: &Vector3<f64>| axes.tr_mul(&(place - properties.center));
        let made = at(key, made)?.with_points(wet.iter().map(own));
        let turn = rotation(Vector3::from(self.rotation.unwrap_or_default()));
        let orientation = Rotation3::from_matrix_unchecked(turn * axes);
        let q = *UnitQuaternion::from_rotation_matrix(&orientation).quaternion();
        let spin = Vector3::from(self.spin.unwrap_or_default());
        let rotation = Rotation { q, momentum: made.momentum(q, spin) };
        let origin = Vector3::from(self.at.unwrap_or_default());
        let place = origin + turn * properties.center;
        let count = 1 + made.points().len();
        // The network moves the points to their places when it is complete.
        let (masses, places) = (vec![properties.mass; count], vec![place; count]);
        assembly.add_particles(&masses, places, self.velocity);
        let thickness = self.thickness.unwrap_or(THICKNESS * smallest);
        let of_point = [0.25 * properties.mass, thickness];
        let rolling = self.rolling_friction;
        at("rolling_friction", at_least(0.0, "it", rolling))?;
        // A face rests on several points.
        let mut skin = point_skin(self.skin(), assembly.gravity, of_point)?;
        skin.rolling = rolling;
        assembly.skins.extend(vec![skin; count]);
        if !wet.is_empty() {
            let end = made.points().end;
            assembly.soaked.push(end - wet.len()..end);
        }
        assembly.rigid.push((made, rotation));
        Ok(())
    }
}

/// Returns the shape of a part, and its smallest extent (m).
fn shape(spec: &PartSpec, files: &mut Files) -> Result<(Shape, f64), Fault> {
    let turn = Vector3::from(spec.rotation.unwrap_or_default());
    refuse!(if spec.scale.is_some() && spec.file.is_none() => "scale":
        "it is that of a `file`, which is missing");
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
        (None, None, None, Some(file)) => files.solid(file, spec.scale, spec.rotation),
        _ => refuse!("": "a part is one of box, ball, capsule and file, such as {{ ball = 0.2 }}"),
    }
}

/// Largest number of points of the lattice around a body.
const MAX_POINTS: f64 = 500_000.0;
/// Differences of distances that count as none, as a share of the spacing.
const SAME: f64 = 1e-6;

/// Least number of layers of points in a wall that stops a liquid. Cups with walls of 2 spacings
/// and more keep all of it, wherever the lattice is; those with one layer lose some where it falls
/// in.
const LEAST_LAYERS: f64 = 2.0;
/// Share of the surface of a body up to which its walls may be thin, as masts and tips are.
const THIN_SHARE: f64 = 0.1;
/// Number of depths at which the thickness of a wall is looked for.
const DEPTHS: u32 = 40;

/// Lists the points of a body of a volume (m3) that a fluid touches, relative to the body's origin
/// (m): those of a lattice of the fluid's spacing around the middle of its parts, up to a few
/// layers below its surface. There are as many as the volume has cells, so that the body displaces
/// its volume. In two dimensions, the points in the plane of the origin and in the parts are taken.
fn soaked(parts: &[Part], volume: f64, fluid: &Fluid) -> Result<Vec<Vector3<f64>>, Fault> {
    let spacing = fluid.spacing;
    at("spacing", positive("it", spacing)).map_err(|fault| fault.within("fluid"))?;
    let (low, high) = bounds(parts);
    let size = high - low;
    let flat = fluid.dimensions == 2;
    // One more cell on each side; if the count is odd, half of that cell is outside.
    let counts = size.map(|size| (size / spacing).round() + 2.0);
    let counts = Vector3::new(counts.x, counts.y, if flat { 1.0 } else { counts.z });
    refuse!(if counts.product() > MAX_POINTS => "parts":
        "the fluid's spacing {spacing} is too fine for this body, which is {} x {} x {} m large",
        size.x, size.y, size.z);
    let mut first = 0.5 * (low + high) - 0.5 * spacing * (counts - Vector3::repeat(1.0));
    if flat {
        first.z = 0.0;
    }
    let [nx, ny, nz] = [counts.x, counts.y, counts.z].map(|count| count as usize);
    let all = (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])));
    let near = all.map(|index| {
        let place = first + spacing * Vector3::from(index.map(|i| i as f64));
        let distances = parts.iter().map(|it| it.shape.distance(place - it.at));
        (place, distances.fold(f64::INFINITY, f64::min))
    });
    let mut near: Vec<_> = near.filter(|(_, distance)| *distance < spacing).collect();
    let outermost = if flat {
        0.0
    } else {
        outermost(&near, (volume / spacing.powi(3)).round() as usize, spacing)
    };
    near.retain(|(_, distance)| *distance < outermost);
    let deepest = outermost.min(0.0) - f64::from(LAYERS) * spacing;
    let shell = near.into_iter().filter(|(_, distance)| *distance > deepest);
    Ok(shell.map(|(place, _)| place).collect())
}

/// Returns the sentence that a liquid can pass through walls of a body with this number of points,
/// if some are too thin: the points of a wall stop it if there are two layers of them. A body of
/// one convex part has no walls, but needs points.
fn leak(parts: &[Part], points: usize, fluid: &Fluid) -> Option<String> {
    let needed = LEAST_LAYERS * fluid.spacing;
    let is_convex = matches!(parts, [part] if !matches!(part.shape, Shape::Mesh(_)));
    if is_convex {
        let why = "it is too thin for the liquid to feel it: it needs to be at least";
        return (points == 0).then(|| format!("{why} {needed} m thick, {LEAST_LAYERS} spacings"));
    }
    let (mut area, mut of_thin, mut thinnest) = (0.0, 0.0, f64::INFINITY);
    for [middle, normal] in parts.iter().flat_map(sides) {
        // A sheet of liquid reaches across z.
        let size = normal.norm();
        if fluid.dimensions == 2 && normal.z.abs() > 0.5 * size {
            continue;
        }
        area += size;
        let is_outside = |depth: &f64| {
            let place = middle - normal * (depth / size);
            let mut all = parts.iter();
            all.all(|part| part.shape.distance(place - part.at) > -SAME * fluid.spacing)
        };
        let depths = (1..=DEPTHS).map(|k| needed * (1.0 - SAME) * f64::from(k) / f64::from(DEPTHS));
        if let Some(depth) = depths.into_iter().find(is_outside) {
            of_thin += size;
            thinnest = depth.min(thinnest);
        }
    }
    (of_thin > THIN_SHARE * area).then(|| {
        format!(
            "the liquid can pass through walls that are only {thinnest:.2} m thick: what holds it is \
             at least {needed} m thick, {LEAST_LAYERS} spacings of the fluid"
        )
    })
}

/// Lists the middles of the sides of a part, with the areas (m2) times the normals.
fn sides(part: &Part) -> Vec<[Vector3<f64>; 2]> {
    let simplices = part.shape.simplices();
    if simplices.triangles.is_empty() {
        // A ball or a capsule is as thick everywhere.
        let radius = simplices.radius;
        let places = simplices.points.iter().map(|point| part.at + point);
        let across = places.flat_map(|place| {
            let [side, other] = [Vector3::x(), Vector3::z()];
            [side, -side, other, -other].map(|out| [place + out * radius, out * (radius * radius)])
        });
        return across.collect();
    }
    let side = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|i| part.at + simplices.points[i as usize]);
        [(a + b + c) / 3.0, 0.5 * (b - a).cross(&(c - a))]
    };
    let sides = simplices.triangles.iter().map(side);
    sides.filter(|[_, area]| area.norm() > 0.0).collect()
}

/// Returns the distance (m) from the surface below which about `count` of the places lie. Places at
/// the same distance stay together, so that symmetric bodies have symmetric points.
fn outermost(places: &[(Vector3<f64>, f64)], count: usize, spacing: f64) -> f64 {
    let mut distances: Vec<_> = places.iter().map(|(_, distance)| *distance).collect();
    distances.sort_by(f64::total_cmp);
    let Some(last) = distances.get(count.saturating_sub(1)) else {
        return spacing;
    };
    let edges = [-SAME, SAME].map(|by| last + by * spacing);
    let counts = edges.map(|edge| distances.partition_point(|d| *d < edge));
    let is_nearer_below = count - counts[0].min(count) < counts[1] - count.min(counts[1]);
    edges[usize::from(!is_nearer_below)]
}

/// Returns the least and the largest coordinates of all parts (m).
fn bounds(parts: &[Part]) -> (Vector3<f64>, Vector3<f64>) {
    let around = Vector3::repeat(f64::INFINITY);
    parts.iter().fold((around, -around), |bounds, part| {
        let simplices = part.shape.simplices();
        let radius = Vector3::repeat(simplices.radius);
        simplices.points.iter().fold(bounds, |(low, high), point| {
            let at = part.at + point;
            (low.inf(&(at - radius)), high.sup(&(at + radius)))
        })
    })
}
