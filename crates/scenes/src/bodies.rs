//! What bodies there are, and how each is put together.

use a3_core::elements::{Buckling, Sheet};
use a3_core::{Constraint, Error, Grid, Spring, SpringKind, SpringLaw, Vector3};
use nalgebra::Rotation3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::build::{Assembly, Sizes};
use crate::check::{at_least, positive};
use crate::lattice::Lattice;
use crate::{BucklingSpec, Fault, Mesh, Pin, Spot, SpringSpec, Triple};

/// One particle of first order, whose velocity is its position turned by a right angle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Circle {
    /// Where it begins (m).
    pub start: Triple,
}

/// A rectangular cloth: rows x columns of particles, a cell apart, numbered row by row.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cloth {
    /// Rows and columns, at least 2 of each.
    pub grid: [usize; 2],
    /// Width (m), whatever the grid. Or `spacing`.
    pub width: Option<f64>,
    /// From one particle to the next (m). Or `width`.
    pub spacing: Option<f64>,
    /// Mass over area (kg/m2): each particle stands for a cell. Or `mass`.
    pub density: Option<f64>,
    /// Mass of each particle (kg). Or `density`.
    pub mass: Option<f64>,
    /// Of structural, shear and bend springs (N/m).
    pub stiffness: [f64; 3],
    /// Damping over stiffness of every spring (s). Or `damping_ratio`.
    pub damping: Option<f64>,
    /// Damping over the critical one of a particle on a structural spring, whatever the grid. Or `damping`.
    pub damping_ratio: Option<f64>,
    /// Makes bend springs buckle; stretched, they have the stiffness given above.
    pub buckling: Option<BucklingSpec>,
    /// Where the middle of the first row is (m). Or `foot`.
    pub at: Option<Triple>,
    /// Where the middle of the last row is (m), of a cloth without folds. Or `at`.
    pub foot: Option<Triple>,
    /// Along the first row; [1, 0, 0] if not given.
    pub right: Option<Triple>,
    /// From row to row, at a right angle to it; [0, -1, 0] if not given.
    pub down: Option<Triple>,
    /// Number of folds in which the first row is gathered, and with it the whole.
    #[serde(default)]
    pub folds: f64,
    /// How far it turns to and fro in them (rad).
    #[serde(default)]
    pub turn: f64,
    /// Velocity (m/s).
    pub velocity: Option<Triple>,
    /// Velocity of the last row (m/s), less above, nothing in the first; added to `velocity`.
    pub sway: Option<Triple>,
    /// What is pinned.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pin: Vec<Pin>,
}

/// A box of jelly: particles inside too, held together along edges and across faces and cells.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Jelly {
    /// Particles along x, y and z, at least 2 of each.
    pub grid: [usize; 3],
    /// Edges (m).
    pub size: Triple,
    /// Mass over volume (kg/m3). Or `mass`.
    pub density: Option<f64>,
    /// Mass of each particle (kg). Or `density`.
    pub mass: Option<f64>,
    /// Of structural, shear and bend springs (N/m).
    pub stiffness: [f64; 3],
    /// Damping over stiffness of every spring (s). Or `damping_ratio`.
    pub damping: Option<f64>,
    /// Damping over the critical one of a particle on a structural spring. Or `damping`.
    pub damping_ratio: Option<f64>,
    /// Its middle (m).
    pub at: Triple,
    /// Turned about this axis by its length (rad).
    pub rotation: Option<Triple>,
    /// Velocity (m/s).
    pub velocity: Option<Triple>,
    /// What is pinned.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pin: Vec<Pin>,
}

/// A cloth whose particles are the points of a file of triangles: structural springs on edges, bend springs across them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshCloth {
    /// A .obj, .gltf or .glb file, beside the scene's or in a folder beside it.
    pub file: String,
    /// Its unit (m).
    pub scale: Option<f64>,
    /// Where its origin comes to be (m).
    pub at: Option<Triple>,
    /// Turned about this axis by its length (rad).
    pub rotation: Option<Triple>,
    /// Mass over area (kg/m2): a particle has a third of the triangles around it.
    pub density: f64,
    /// Of structural and bend springs (N/m).
    pub stiffness: [f64; 2],
    /// Damping over stiffness of every spring (s). Or `damping_ratio`.
    pub damping: Option<f64>,
    /// Damping over the critical one of a mean particle on a structural spring. Or `damping`.
    pub damping_ratio: Option<f64>,
    /// Velocity (m/s).
    pub velocity: Option<Triple>,
    /// What is pinned. Its top and bottom are what is as high as its highest and lowest point, to a hundredth of its
    /// height.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pin: Vec<Pin>,
}

/// A straight row of particles on springs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Chain {
    /// Number of particles, at least 2.
    pub particles: usize,
    /// Where the first is (m).
    pub from: Triple,
    /// Where the last is (m).
    pub to: Triple,
    /// Mass of each particle (kg).
    pub mass: f64,
    /// Of each spring (N/m).
    #[serde(default)]
    pub stiffness: f64,
    /// Rods instead of springs.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub rigid: bool,
    /// Rest length of each spring (m); without it, that of the beginning.
    pub rest_length: Option<f64>,
    /// Of each spring (N s/m).
    #[serde(default)]
    pub damping: f64,
    /// Holds it straight by bend springs that buckle, from each particle to the next but one.
    pub buckling: Option<BucklingSpec>,
    /// Velocity (m/s).
    pub velocity: Option<Triple>,
    /// What is pinned.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pin: Vec<Pin>,
}

/// Particles and springs, one by one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Particles {
    /// In m.
    pub positions: Vec<Triple>,
    /// In m/s; without them, all are at rest.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub velocities: Vec<Triple>,
    /// Mass of each particle (kg), if they are all the same. Or `masses`.
    pub mass: Option<f64>,
    /// Their masses (kg). Or `mass`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub masses: Vec<f64>,
    /// [i, j, stiffness (N/m), rest length (m), damping (N s/m)], with particles numbered from 0 among these.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub springs: Vec<SpringSpec>,
    /// What is pinned.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pin: Vec<Pin>,
}

/// A key and what is wrong with it, without the body's own.
pub(super) type Wrong = (&'static str, String);

fn at<T>(key: &'static str, result: Result<T, Error>) -> Result<T, Wrong> {
    result.map_err(|e| (key, e.to_string()))
}

/// The one of two that is given.
fn one_of<'a>(
    (a, first): (&'static str, Option<&'a f64>),
    (b, second): (&'static str, Option<&'a f64>),
) -> Result<(bool, f64), Wrong> {
    match (first, second) {
        (Some(x), None) => Ok((true, *x)),
        (None, Some(x)) => Ok((false, *x)),
        (Some(_), Some(_)) => Err((b, format!("give either `{a}` or `{b}`, not both"))),
        (None, None) => Err(("", format!("needs one of the keys `{a}` and `{b}`"))),
    }
}

/// Damping over stiffness (s), of a particle of that mass (kg) on a structural spring.
fn damping_time(
    damping: Option<f64>,
    ratio: Option<f64>,
    mass: f64,
    stiffness: f64,
) -> Result<f64, Wrong> {
    match (damping, ratio) {
        (None, None) => Ok(0.0),
        (Some(_), Some(_)) => Err((
            "damping_ratio",
            "give either `damping` or `damping_ratio`, not both".into(),
        )),
        (Some(time), None) => at("damping", at_least(0.0, "it", time)).map(|()| time),
        (None, Some(ratio)) => {
            at("damping_ratio", at_least(0.0, "it", ratio))?;
            at(
                "damping_ratio",
                positive("the structural stiffness that it refers to", stiffness),
            )?;
            Ok(2.0 * ratio * (mass / stiffness).sqrt())
        }
    }
}

fn finite(key: &'static str, triple: Option<Triple>) -> Result<Vector3<f64>, Wrong> {
    crate::build::finite(triple.unwrap_or_default()).map_err(|why| (key, why))
}

impl BucklingSpec {
    /// Between two particles, of that rest length (m); stretched, of that stiffness and damping.
    fn strip(
        &self,
        [i, j]: [usize; 2],
        rest_length: f64,
        [tension, damping]: [f64; 2],
    ) -> Buckling {
        Buckling {
            i,
            j,
            rest_length,
            bending: self.bending,
            compression: self.compression,
            tension,
            damping,
        }
    }
}

/// A body that a scene is put together from.
pub(super) trait Body {
    /// Particles and springs, checked before memory is taken.
    fn sizes(&self) -> Result<Sizes, Wrong>;

    /// Adds it.
    fn add_to(&self, assembly: &mut Assembly) -> Result<(), Wrong>;

    fn pins(&self) -> &[Pin];

    /// The particles of a spot, numbered from 0 in this body.
    fn spot(&self, spot: Spot, positions: &[Vector3<f64>]) -> Option<Vec<usize>>;
}

impl Cloth {
    pub(super) fn grid(&self) -> Result<Grid, Error> {
        let [rows, cols] = self.grid;
        Grid::new(rows, cols)
    }

    /// From one particle to the next (m).
    pub(super) fn spacing(&self) -> Result<f64, Wrong> {
        let (by_width, size) = one_of(
            ("width", self.width.as_ref()),
            ("spacing", self.spacing.as_ref()),
        )?;
        at(
            if by_width { "width" } else { "spacing" },
            positive("it", size),
        )?;
        let cells = self.grid[1].max(2) - 1;
        Ok(if by_width { size / cells as f64 } else { size })
    }

    fn axis(&self, key: &'static str) -> Result<Vector3<f64>, Wrong> {
        let (given, usual) = match key {
            "right" => (self.right, Vector3::x()),
            _ => (self.down, -Vector3::y()),
        };
        let axis = given.map_or(usual, Vector3::from);
        axis.try_normalize(1e-9)
            .filter(|axis| axis.iter().all(|x| x.is_finite()))
            .ok_or_else(|| (key, "it must be a direction, such as [1, 0, 0]".into()))
    }
}

impl Body for Cloth {
    fn sizes(&self) -> Result<Sizes, Wrong> {
        let grid = at("grid", self.grid())?;
        Ok(Sizes {
            particles: grid.particles(),
            springs: 6 * grid.particles(),
        })
    }

    fn add_to(&self, assembly: &mut Assembly) -> Result<(), Wrong> {
        let grid = at("grid", self.grid())?;
        let (rows, cols, spacing) = (grid.rows(), grid.cols(), self.spacing()?);
        let (by_area, mass) = one_of(
            ("density", self.density.as_ref()),
            ("mass", self.mass.as_ref()),
        )?;
        at(
            if by_area { "density" } else { "mass" },
            positive("it", mass),
        )?;
        let mass = if by_area {
            mass * spacing * spacing
        } else {
            mass
        };
        let time = damping_time(self.damping, self.damping_ratio, mass, self.stiffness[0])?;
        let sheet = at("stiffness", Sheet::new(grid, spacing, self.stiffness, time))?;
        let (sheet, strips) = match &self.buckling {
            None => (sheet, vec![]),
            Some(of) => {
                let [structural, shear, bend] = self.stiffness;
                let ends = sheet.springs().filter(|s| s.kind == SpringKind::Bend);
                let strips = ends.map(|s| of.strip([s.i, s.j], 2.0 * spacing, [bend, bend * time]));
                let strips = strips.collect();
                let rest = Sheet::new(grid, spacing, [structural, shear, 0.0], time);
                (at("stiffness", rest)?, strips)
            }
        };
        let (right, down) = (self.axis("right")?, self.axis("down")?);
        if right.dot(&down).abs() > 1e-6 {
            let key = if self.down.is_some() { "down" } else { "right" };
            return Err((key, "`right` and `down` must be at a right angle".into()));
        }
        let height = down * (spacing * (rows - 1) as f64);
        let top = match (self.at, self.foot) {
            (Some(_), Some(_)) => {
                return Err(("foot", "give either `at` or `foot`, not both".into()));
            }
            (_, Some(_)) => finite("foot", self.foot)? - height,
            _ => finite("at", self.at)?,
        };
        for (key, number) in [("folds", self.folds), ("turn", self.turn)] {
            at(key, at_least(0.0, "it", number))?;
        }
        let edge = gathered(cols, spacing, self.folds, self.turn);
        let middle = 0.5 * edge[cols - 1][0];
        let out = down.cross(&right);
        let first = assembly.masses.len();
        let (velocity, sway) = (
            finite("velocity", self.velocity)?,
            finite("sway", self.sway)?,
        );
        for i in 0..rows {
            let share = i as f64 / (rows - 1) as f64;
            for [along, outwards] in &edge {
                assembly.positions.push(
                    top + right * (along - middle) + out * *outwards + down * (i as f64 * spacing),
                );
                assembly.velocities.push(velocity + sway * share);
            }
        }
        assembly.masses.extend(vec![mass; grid.particles()]);
        let surface = grid.triangles().map(|t| t.map(|i| (first + i) as u32));
        assembly.surface.triangles.extend(surface);
        assembly.end_surface();
        assembly.add_strips(first, strips);
        if first == 0 {
            (assembly.sheet, assembly.grid) = (Some(sheet), Some(grid));
        } else {
            assembly.add_springs(first, sheet.springs());
        }
        Ok(())
    }

    fn pins(&self) -> &[Pin] {
        &self.pin
    }

    fn spot(&self, spot: Spot, _: &[Vector3<f64>]) -> Option<Vec<usize>> {
        let [rows, cols] = self.grid;
        let last = (rows - 1) * cols;
        Some(match spot {
            Spot::Top => (0..cols).collect(),
            Spot::Bottom => (last..rows * cols).collect(),
            Spot::Left => (0..rows).map(|i| i * cols).collect(),
            Spot::Right => (0..rows).map(|i| i * cols + cols - 1).collect(),
            Spot::TopLeft => vec![0],
            Spot::TopRight => vec![cols - 1],
            Spot::BottomLeft => vec![last],
            Spot::BottomRight => vec![rows * cols - 1],
            Spot::First | Spot::Last => return None,
        })
    }
}

/// A row of particles along a sine-generated curve: its direction swings to and fro, and its length is that of the row, so
/// nothing is stretched. How far along and how far out each is (m).
fn gathered(cols: usize, spacing: f64, folds: f64, turn: f64) -> Vec<[f64; 2]> {
    let steps = (0..cols).map(|j| {
        let s = (j as f64 + 0.5) / (cols - 1) as f64;
        let angle = turn * libm::cos(std::f64::consts::TAU * folds * s);
        [libm::cos(angle) * spacing, libm::sin(angle) * spacing]
    });
    let mut here = [0.0, 0.0];
    steps
        .map(|[along, out]| {
            let next = [here[0] + along, here[1] + out];
            std::mem::replace(&mut here, next)
        })
        .collect()
}

impl Body for Jelly {
    fn sizes(&self) -> Result<Sizes, Wrong> {
        let particles = Lattice(self.grid).particles();
        let particles = particles
            .filter(|_| self.grid.iter().all(|n| *n >= 2))
            .ok_or_else(|| {
                let [x, y, z] = self.grid;
                let why = format!(
                    "a jelly has at least 2 particles along each edge, such as [8, 8, 8], not [{x}, {y}, {z}]"
                );
                ("grid", why)
            })?;
        Ok(Sizes {
            particles,
            springs: particles.saturating_mul(16),
        })
    }

    fn add_to(&self, assembly: &mut Assembly) -> Result<(), Wrong> {
        let lattice = Lattice(self.grid);
        let particles = self.sizes()?.particles;
        for size in self.size {
            at("size", positive("each edge", size))?;
        }
        let spacing: [f64; 3] = std::array::from_fn(|a| self.size[a] / (self.grid[a] - 1) as f64);
        let (by_volume, mass) = one_of(
            ("density", self.density.as_ref()),
            ("mass", self.mass.as_ref()),
        )?;
        at(
            if by_volume { "density" } else { "mass" },
            positive("it", mass),
        )?;
        let mass = if by_volume {
            mass * self.size.iter().product::<f64>() / particles as f64
        } else {
            mass
        };
        let [structural, shear, bend] = self.stiffness;
        for k in self.stiffness {
            at("stiffness", at_least(0.0, "each", k))?;
        }
        let time = damping_time(self.damping, self.damping_ratio, mass, structural)?;
        let law = |kind, length| {
            let stiffness = match kind {
                SpringKind::Structural => structural,
                SpringKind::Shear => shear,
                SpringKind::Bend => bend,
            };
            SpringLaw {
                stiffness,
                rest_length: length,
                damping: stiffness * time,
            }
        };
        let first = assembly.masses.len();
        let rotation = Rotation3::new(finite("rotation", self.rotation)?);
        let (middle, velocity) = (
            finite("at", Some(self.at))?,
            finite("velocity", self.velocity)?,
        );
        for place in lattice.places() {
            let from_middle =
                Vector3::from_fn(|a, _| place[a] as f64 * spacing[a] - 0.5 * self.size[a]);
            assembly.positions.push(middle + rotation * from_middle);
            assembly.velocities.push(velocity);
        }
        assembly.masses.extend(vec![mass; particles]);
        let skin = lattice.triangles();
        let skin = skin.into_iter().map(|t| t.map(|i| i + first as u32));
        assembly.surface.triangles.extend(skin);
        assembly.end_surface();
        assembly.add_springs(first, lattice.springs(spacing, law));
        Ok(())
    }

    fn pins(&self) -> &[Pin] {
        &self.pin
    }

    fn spot(&self, spot: Spot, _: &[Vector3<f64>]) -> Option<Vec<usize>> {
        let (axis, far) = match spot {
            Spot::Left => (0, false),
            Spot::Right => (0, true),
            Spot::Bottom => (1, false),
            Spot::Top => (1, true),
            _ => return None,
        };
        let lattice = Lattice(self.grid);
        let at = if far { self.grid[axis] - 1 } else { 0 };
        let there = lattice.places().filter(|place| place[axis] == at);
        Some(there.map(|place| lattice.index_of(place)).collect())
    }
}

/// A cloth and the mesh that its file has.
pub(super) struct Woven<'a> {
    pub cloth: &'a MeshCloth,
    pub mesh: Mesh,
}

impl Body for Woven<'_> {
    fn sizes(&self) -> Result<Sizes, Wrong> {
        if self.mesh.triangles.is_empty() {
            return Err(("file", "it has no triangles".into()));
        }
        Ok(Sizes {
            particles: self.mesh.positions.len(),
            springs: 3 * self.mesh.triangles.len(),
        })
    }

    fn add_to(&self, assembly: &mut Assembly) -> Result<(), Wrong> {
        let Self { cloth, mesh } = self;
        let scale = cloth.scale.unwrap_or(1.0);
        at("scale", positive("it", scale))?;
        at("density", positive("it", cloth.density))?;
        let rotation = Rotation3::new(finite("rotation", cloth.rotation)?);
        let (origin, velocity) = (finite("at", cloth.at)?, finite("velocity", cloth.velocity)?);
        let first = assembly.masses.len();
        let placed = Mesh {
            positions: mesh
                .positions
                .iter()
                .map(|p| p.map(|x| x * scale))
                .collect(),
            triangles: mesh.triangles.clone(),
        };
        let masses: Vec<_> = placed
            .areas()
            .iter()
            .map(|area| area * cloth.density)
            .collect();
        if let Some(bad) = masses.iter().position(|m| !m.is_finite() || *m <= 0.0) {
            return Err((
                "file",
                format!("the triangles around point {bad} have no area"),
            ));
        }
        let mean = masses.iter().sum::<f64>() / masses.len() as f64;
        let [structural, bend] = cloth.stiffness;
        let time = damping_time(cloth.damping, cloth.damping_ratio, mean, structural)?;
        let law = |kind, length| {
            let k = if kind == SpringKind::Bend {
                bend
            } else {
                structural
            };
            SpringLaw::new(k, length, k * time)
        };
        let springs = at("stiffness", placed.springs(law))?;
        for p in &placed.positions {
            assembly
                .positions
                .push(origin + rotation * Vector3::from(*p));
            assembly.velocities.push(velocity);
        }
        assembly.masses.extend(masses);
        let triangles = mesh.triangles.iter().map(|t| t.map(|i| i + first as u32));
        assembly.surface.triangles.extend(triangles);
        assembly.end_surface();
        assembly.add_springs(first, springs);
        Ok(())
    }

    fn pins(&self) -> &[Pin] {
        &self.cloth.pin
    }

    fn spot(&self, spot: Spot, positions: &[Vector3<f64>]) -> Option<Vec<usize>> {
        let heights = || positions.iter().map(|p| p.y);
        let (low, high) = (
            heights().fold(f64::INFINITY, f64::min),
            heights().fold(f64::NEG_INFINITY, f64::max),
        );
        let near = 0.01 * (high - low);
        let there = |at: f64| {
            let all = heights().enumerate();
            all.filter(|(_, y)| (y - at).abs() <= near)
                .map(|(i, _)| i)
                .collect()
        };
        match spot {
            Spot::Top => Some(there(high)),
            Spot::Bottom => Some(there(low)),
            _ => None,
        }
    }
}

impl Body for Chain {
    fn sizes(&self) -> Result<Sizes, Wrong> {
        if self.particles < 2 {
            return Err((
                "particles",
                format!("a chain has at least 2, not {}", self.particles),
            ));
        }
        Ok(Sizes {
            particles: self.particles,
            springs: self.particles,
        })
    }

    fn add_to(&self, assembly: &mut Assembly) -> Result<(), Wrong> {
        let n = self.particles;
        let (from, to) = (
            finite("from", Some(self.from))?,
            finite("to", Some(self.to))?,
        );
        at("mass", positive("it", self.mass))?;
        at("stiffness", at_least(0.0, "it", self.stiffness))?;
        at("damping", at_least(0.0, "it", self.damping))?;
        let rest_length = self
            .rest_length
            .unwrap_or((to - from).norm() / (n - 1) as f64);
        at("rest_length", at_least(0.0, "it", rest_length))?;
        let law = SpringLaw {
            stiffness: self.stiffness,
            rest_length,
            damping: self.damping,
        };
        let velocity = finite("velocity", self.velocity)?;
        let first = assembly.masses.len();
        for i in 0..n {
            let share = i as f64 / (n - 1) as f64;
            assembly.positions.push(from + (to - from) * share);
            assembly.velocities.push(velocity);
        }
        assembly.masses.extend(vec![self.mass; n]);
        let springs = (0..n - 1).map(|i| Spring {
            kind: SpringKind::Structural,
            i,
            j: i + 1,
            law,
        });
        if self.rigid {
            at("rest_length", positive("that of a rod", rest_length))?;
            assembly.rods.extend(springs.map(|s| Constraint::Rod {
                i: first + s.i,
                j: first + s.j,
                length: rest_length,
            }));
        } else {
            assembly.add_springs(first, springs);
        }
        if let Some(of) = &self.buckling {
            let strip = |i| of.strip([i, i + 2], 2.0 * rest_length, [0.0, 0.0]);
            assembly.add_strips(first, (0..n - 2).map(strip).collect());
        }
        Ok(())
    }

    fn pins(&self) -> &[Pin] {
        &self.pin
    }

    fn spot(&self, spot: Spot, _: &[Vector3<f64>]) -> Option<Vec<usize>> {
        match spot {
            Spot::First => Some(vec![0]),
            Spot::Last => Some(vec![self.particles - 1]),
            _ => None,
        }
    }
}

impl Body for Particles {
    fn sizes(&self) -> Result<Sizes, Wrong> {
        let n = self.positions.len();
        for (key, count) in [
            ("velocities", self.velocities.len()),
            ("masses", self.masses.len()),
        ] {
            if count != 0 && count != n {
                return Err((key, format!("there are {count} for {n} positions")));
            }
        }
        if n == 0 {
            return Err(("positions", "there must be at least one".into()));
        }
        Ok(Sizes {
            particles: n,
            springs: self.springs.len(),
        })
    }

    fn add_to(&self, assembly: &mut Assembly) -> Result<(), Wrong> {
        let n = self.positions.len();
        let masses = match (self.mass, &self.masses[..]) {
            (Some(mass), []) => vec![mass; n],
            (None, [_, ..]) => self.masses.clone(),
            (Some(_), _) => {
                return Err(("masses", "give either `mass` or `masses`, not both".into()));
            }
            (None, []) => return Err(("", "needs one of the keys `mass` and `masses`".into())),
        };
        let key = if self.mass.is_some() {
            "mass"
        } else {
            "masses"
        };
        for m in &masses {
            at(key, positive("each", *m))?;
        }
        for p in &self.positions {
            assembly.positions.push(finite("positions", Some(*p))?);
        }
        for i in 0..n {
            let velocity = self.velocities.get(i).copied();
            assembly.velocities.push(finite("velocities", velocity)?);
        }
        let first = assembly.masses.len();
        assembly.masses.extend(masses);
        let springs = crate::build::springs(&self.springs, n).map_err(|why| ("springs", why))?;
        assembly.add_springs(first, springs);
        Ok(())
    }

    fn pins(&self) -> &[Pin] {
        &self.pin
    }

    fn spot(&self, _: Spot, _: &[Vector3<f64>]) -> Option<Vec<usize>> {
        None
    }
}

/// Puts the key of the body before that of what is wrong.
pub(super) fn in_body(key: &str, (part, why): Wrong) -> Fault {
    if part.is_empty() {
        Fault::new(key, why)
    } else {
        Fault::new(format!("{key}.{part}"), why)
    }
}
