//! Assembly of the bodies of a scene: their particles, numbered through, and the springs, rods and
//! skins that join and cover them; what they are made from, and their state. A skin is the
//! thickness, stiffness and friction of a body where surfaces touch.

use std::ops::Range;
use std::sync::Arc;

use a3_core::contact::{ClosedMesh, Shape, Skin};
use a3_core::elements::{Buckling, FluidLaw, Gas, Outflow, Sheet, Solid};
use a3_core::rigid::{ROTATION, Rotation};
use a3_core::{Constraint, Spring, Vector3, rigid, rotation};
use nalgebra::Rotation3;

use super::motion::Pinned;
use crate::budget::{BODIES, Budget, FACES, PARTICLES, Part, TOUCHING, TRIANGLES};
use crate::description::{EARTH, Fluid, Keys, SkinKeys, Spot, State, Triple};
use crate::fault::{COORDINATES, Fault, at, at_least, is_coordinate, positive, share};
use crate::mesh::Mesh;
use crate::setup::Presentation;

/// Body of a scene. The keys of its faults are relative to the body.
pub(super) trait Body: Keys {
    /// Adds the body's particles, springs, constraints and surface. It spends their budget before
    /// any memory is reserved.
    fn add_to(&self, assembly: &mut Assembly, files: &mut Files) -> Result<(), Fault>;

    /// Finds the particles of a spot, numbered from 0 in this body; `None` if the body has no such
    /// spot.
    fn spot(&self, _: Spot, _: &[Vector3<f64>]) -> Option<Vec<usize>> {
        None
    }
}

/// Returns the function that turns a point of a body about its origin, and moves that to `at` (m).
pub(super) fn placed(
    at: Triple,
    rotation: Option<Triple>,
) -> impl Fn(Vector3<f64>) -> Vector3<f64> {
    let rotation = Rotation3::new(Vector3::from(rotation.unwrap_or_default()));
    move |point| Vector3::from(at) + rotation * point
}

/// Bodies of a scene that were added so far.
#[derive(Default)]
pub(super) struct Assembly<'a> {
    /// Liquid that touches rigid bodies.
    pub liquid: Option<&'a Fluid>,
    /// Gravity that contact suits (m/s2).
    pub gravity: f64,
    pub masses: Vec<f64>,
    pub positions: Vec<Vector3<f64>>,
    pub velocities: Vec<Vector3<f64>>,
    /// Springs of each cloth.
    pub sheets: Vec<Sheet>,
    /// Tetrahedra of each solid.
    pub solids: Vec<Solid>,
    /// Surface, tanks, and sentences about what may not be meant.
    pub presentation: Presentation,
    pub springs: Vec<Spring>,
    /// Gas in closed meshes.
    pub gases: Vec<Gas>,
    /// Springs that only pull.
    pub cords: Vec<Spring>,
    pub strips: Vec<Buckling>,
    pub rods: Vec<Constraint>,
    /// Rigid bodies with their orientations and angular momenta.
    pub rigid: Vec<(rigid::Body, Rotation)>,
    /// Skin of each particle, where surfaces touch.
    pub skins: Vec<Skin>,
    /// Edges that are in no triangle, and such points, as edges with equal ends.
    pub edges: Vec<[u32; 2]>,
    /// Particles of fluids that are not in walls.
    pub drops: Vec<u32>,
    pub pins: Pinned,
    /// Largest length over rest length of the springs of the body that is being added.
    pub strain_limit: Option<f64>,
    /// Bodies whose strain is limited: key, particles and limit.
    pub strain_limits: Vec<(String, Range<usize>, f64)>,
    /// Law of the fluid, and the particles of each of its bodies.
    pub fluid: Option<(FluidLaw, Vec<Range<usize>>)>,
    /// Boxes in which the fluid leaves the scene.
    pub outflows: Vec<Outflow>,
    /// Points of each rigid body that the fluid touches.
    pub soaked: Vec<Range<usize>>,
}

impl Assembly<'_> {
    /// Adds particles of these masses (kg), which have a velocity (m/s) in common, and returns the
    /// number of the first.
    pub fn add_particles(
        &mut self,
        masses: &[f64],
        positions: impl IntoIterator<Item = Vector3<f64>>,
        velocity: Option<Triple>,
    ) -> usize {
        let first = self.masses.len();
        self.masses.extend(masses);
        self.positions.extend(positions);
        let velocity = Vector3::from(velocity.unwrap_or_default());
        self.velocities.resize(self.masses.len(), velocity);
        first
    }

    /// Adds springs whose particles are counted from `first`, and which may only pull.
    pub fn add_springs(
        &mut self,
        first: usize,
        springs: impl IntoIterator<Item = Spring>,
        only_pull: bool,
    ) {
        let kinds = [&mut self.springs, &mut self.cords];
        let moved = |s: Spring| Spring { i: s.i + first, j: s.j + first, ..s };
        kinds[usize::from(only_pull)].extend(springs.into_iter().map(moved));
    }

    /// Adds the surface of the body that was added last. Its particles are counted from `first`.
    pub fn add_surface(&mut self, first: usize, triangles: impl IntoIterator<Item = [u32; 3]>) {
        let triangles = triangles.into_iter().map(|t| t.map(|i| i + first as u32));
        let surface = &mut self.presentation.surface;
        surface.triangles.extend(triangles);
        surface.bodies.push(self.masses.len());
    }

    /// Adds the body of a key, with its pins.
    pub fn add(&mut self, key: &str, body: &dyn Body, files: &mut Files) -> Result<(), Fault> {
        let (first, noted) = (self.masses.len(), self.presentation.notes.len());
        body.add_to(self, files)?;
        self.check(first)?;
        if let Some(limit) = self.strain_limit.take() {
            let particles = first..self.masses.len();
            self.strain_limits.push((key.into(), particles, limit));
        }
        for note in &mut self.presentation.notes[noted..] {
            *note = format!("{key}: {note}");
        }
        let positions = &self.positions[first..];
        let spot = |spot| body.spot(spot, positions);
        let (pins, budget) = (body.pins(), &mut files.budget);
        self.pins.add(first, pins, positions, budget, spot)
    }

    /// Checks that the positions of the particles from `first` on are within the bounds, and that
    /// each mass has a finite reciprocal.
    fn check(&self, first: usize) -> Result<(), Fault> {
        for (i, p) in self.positions[first..].iter().enumerate() {
            if !p.iter().all(|x| is_coordinate(*x)) {
                let [x, y, z]: [f64; 3] = (*p).into();
                refuse!("": "its particle {i} would be at ({x:e}, {y:e}, {z:e}): {COORDINATES}");
            }
        }
        let masses = &self.masses[first..];
        let is_wrong = |m: &f64| !m.is_finite() || !m.recip().is_finite();
        if let Some(i) = masses.iter().position(is_wrong) {
            refuse!("": "its particle {i} would have a mass of {:e} kg", masses[i]);
        }
        Ok(())
    }
}

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

/// Creates the state of particles from their positions (m) and velocities (m/s).
pub(super) fn state_of(positions: &[Vector3<f64>], velocities: &[Vector3<f64>]) -> Vec<f64> {
    let column = |rows: &[Vector3<f64>], axis| rows.iter().map(move |row| row[axis]).collect();
    let columns =
        [positions, velocities].map(|rows| [0, 1, 2].map(|k| -> Vec<_> { column(rows, k) }));
    columns.as_flattened().concat()
}

/// Sets a state to the given one: without positions, those of the bodies stay. A first-order system
/// has positions only.
pub(super) fn write_state(given: &State, particles: usize, state: &mut [f64]) -> Result<(), Fault> {
    let parts = [("state.positions", &given.positions), ("state.velocities", &given.velocities)];
    let positions = 3 * particles;
    let (halves, rotations) = state.split_at_mut(state.len().min(2 * positions));
    write_rotations(given, rotations)?;
    halves[positions..].fill(0.0);
    for ((key, rows), out) in parts.into_iter().zip(halves.chunks_exact_mut(positions)) {
        if rows.is_empty() {
            continue;
        }
        refuse!(if rows.len() != particles => key:
            "there are {}, but {particles} particles", rows.len());
        for (i, row) in rows.iter().enumerate() {
            for axis in 0..3 {
                out[axis * particles + i] = row[axis];
            }
        }
    }
    Ok(())
}

/// Sets the rotations of rigid bodies to the given ones, if there are any.
fn write_rotations(given: &State, state: &mut [f64]) -> Result<(), Fault> {
    let bodies = state.len() / ROTATION;
    let (turned, momenta) = (&given.orientations, &given.angular_momenta);
    for (key, count) in
        [("state.orientations", turned.len()), ("state.angular_momenta", momenta.len())]
    {
        refuse!(if count != 0 && count != bodies => key:
            "there are {count}, but {bodies} rigid bodies");
    }
    for (k, numbers) in state.chunks_exact_mut(ROTATION).enumerate() {
        if let Some(q) = turned.get(k) {
            let squared: f64 = q.iter().map(|q| q * q).sum();
            refuse!(if squared == 0.0 => "state.orientations":
                "that of body {k}, counted from 0, has no length");
            numbers[..4].copy_from_slice(q);
        }
        if let Some(momentum) = momenta.get(k) {
            numbers[4..].copy_from_slice(momentum);
        }
    }
    Ok(())
}

/// Default and largest thickness of a surface, relative to the distance of its particles:
/// neighbours in a surface do not repel each other.
const MAX_THICKNESS: f64 = 0.25;

/// Returns the largest thickness (m) of a surface whose particles are at this distance (m).
pub fn max_thickness(spacing: f64) -> f64 {
    MAX_THICKNESS * spacing
}

/// Smallest acceleration (m/s2) against which the contact force keeps surfaces apart on Earth.
/// Elsewhere it is in proportion to gravity.
const ACCELERATION: f64 = 100.0;

/// Damping of contact, relative to that of a spring of the same stiffness.
const DAMPING: f64 = 4.0;

/// Damping of the contact of rigid bodies and of fluids: the speed that they gain over their
/// thickness at that acceleration, relative to the speed at which damping counts fully.
const POINT_DAMPING: f64 = 1.5;

/// Material of a body and the keys that describe its skin.
pub(super) struct SkinSpec {
    keys: SkinKeys,
    /// Stiffness of its springs (N/m).
    stiffness: f64,
    /// Damping over stiffness of its springs (s).
    time: f64,
    /// Gravity that the contact suits (m/s2).
    gravity: f64,
}

impl SkinSpec {
    /// Creates the description of a body's skin that suits this gravity (m/s2), over springs of a
    /// stiffness (N/m) whose damping over stiffness is `time` (s).
    pub fn of(body: &dyn Keys, gravity: f64, [stiffness, time]: [f64; 2]) -> Self {
        Self { keys: body.skin(), stiffness, time, gravity }
    }

    /// Returns the smallest acceleration (m/s2) against which the skin keeps surfaces apart.
    fn acceleration(&self) -> f64 {
        ACCELERATION * (self.gravity / EARTH)
    }

    /// Creates the skin of a particle of this mass (kg) with this thickness (m).
    fn skin(&self, mass: f64, thickness: f64) -> Skin {
        Skin {
            thickness,
            stiffness: (self.keys.contact_stiffness).unwrap_or_else(|| {
                let own = mass * self.acceleration() / thickness;
                self.stiffness.max(own)
            }),
            // Damping counts fully where the gap would close within four times the springs' own
            // time: bounces die away as fast as the springs' oscillations.
            damping: DAMPING * self.time / thickness,
            friction: self.keys.friction,
            rolling: 0.0,
            restitution: self.keys.restitution,
            mass,
        }
    }

    /// Creates the skins of particles of these masses (kg), all at this distance (m) from their
    /// neighbours.
    pub fn uniform(&self, masses: &[f64], spacing: f64) -> Result<Vec<Skin>, Fault> {
        self.check()?;
        let most = MAX_THICKNESS * spacing;
        let thickness = self.keys.thickness.unwrap_or(most);
        refuse!(if thickness > most * (1.0 + 1e-9) => "thickness":
            "it must be at most {most}, a quarter of the distance of neighbouring particles, not {thickness}");
        let skin = |m: &f64| self.skin(*m, thickness);
        Ok(masses.iter().map(skin).collect())
    }

    /// Creates the skins of particles of these masses (kg), which are no thicker than their
    /// distances (m) from their neighbours allow.
    pub fn fitted(&self, masses: &[f64], spacings: &[f64]) -> Result<Vec<Skin>, Fault> {
        self.check()?;
        let given = self.keys.thickness.unwrap_or(f64::INFINITY);
        let skin = |(m, spacing): (&f64, &f64)| self.skin(*m, given.min(MAX_THICKNESS * spacing));
        Ok(masses.iter().zip(spacings).map(skin).collect())
    }

    fn check(&self) -> Result<(), Fault> {
        if let Some(thickness) = self.keys.thickness {
            at("thickness", positive("it", thickness))?;
        }
        if let Some(stiffness) = self.keys.contact_stiffness {
            at("contact_stiffness", positive("it", stiffness))?;
        }
        at("friction", at_least(0.0, "it", self.keys.friction))?;
        at("restitution", share("it", self.keys.restitution))
    }
}

/// Creates the skin of a point of a rigid body, or of a fluid, of this mass (kg) and thickness (m),
/// that suits this gravity (m/s2).
pub(super) fn point_skin(
    keys: SkinKeys,
    gravity: f64,
    [mass, thickness]: [f64; 2],
) -> Result<Skin, Fault> {
    let thick = Some(thickness);
    let keys = SkinKeys { thickness: thick, ..keys };
    let spec = SkinSpec { keys, stiffness: 0.0, time: 0.0, gravity };
    spec.check()?;
    Ok(Skin {
        damping: POINT_DAMPING / (spec.acceleration() * thickness).sqrt(),
        ..spec.skin(mass, thickness)
    })
}
