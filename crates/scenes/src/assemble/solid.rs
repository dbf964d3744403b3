//! Boxes of jelly, and elastic solids: boxes, or the tetrahedra of a file.
//!
//! The lattice of a jelly has structural springs along the axes, shear springs across faces and
//! cells, and bend springs to the next particle but one; that of a solid has six tetrahedra a cell.

use a3_core::SpringKind::{Bend, Shear, Structural};
use a3_core::elements::{Hyperelastic, Material, Solid as Elastic};
use a3_core::{Error, Spring, SpringKind, SpringLaw, Vector3};

use super::assembly::{Assembly, Body, Files, SkinSpec, placed};
use super::motion::{extreme, side};
use super::springs::damping_time;
use crate::budget::{CELLS, SPRINGS, TETRAHEDRA};
use crate::description::{Jelly, Solid, SolidModel, Spot};
use crate::fault::{Fault, at, at_least, positive, positive_one};
use crate::mesh::{Mesh, boundary};

impl Body for Jelly {
    fn add_to(&self, assembly: &mut Assembly, files: &mut Files) -> Result<(), Fault> {
        let lattice = Lattice(self.grid);
        let particles = lattice.particles("jelly", [8, 8, 8])?;
        files.spend(particles, &[(particles.saturating_mul(16), SPRINGS)])?;
        for size in self.size {
            at("size", positive("each edge", size))?;
        }
        let spacing: [f64; 3] = std::array::from_fn(|a| self.size[a] / (self.grid[a] - 1) as f64);
        let (by_volume, mass) = positive_one(("density", self.density), ("mass", self.mass))?;
        let share = mass * self.size.iter().product::<f64>() / particles as f64;
        let mass = if by_volume { share } else { mass };
        let structural = self.stiffness[0];
        for k in self.stiffness {
            at("stiffness", at_least(0.0, "each", k))?;
        }
        let time = damping_time(self.damping, self.damping_ratio, mass, structural)?;
        let law = |kind: SpringKind, rest_length| {
            let stiffness = self.stiffness[kind as usize];
            let damping = stiffness * time;
            SpringLaw { stiffness, rest_length, damping }
        };
        let from_center = |cell: [usize; 3]| {
            Vector3::from_fn(|a, _| cell[a] as f64 * spacing[a] - 0.5 * self.size[a])
        };
        let places = lattice.cells().map(from_center);
        let places = places.map(placed(self.at, self.rotation));
        let skin = SkinSpec::of(self, assembly.gravity, [structural, time]);
        let masses = vec![mass; particles];
        let nearest = spacing.into_iter().fold(f64::INFINITY, f64::min);
        assembly.skins.extend(skin.uniform(&masses, nearest)?);
        let first = assembly.add_particles(&masses, places, self.velocity);
        assembly.add_surface(first, lattice.triangles());
        assembly.add_springs(first, lattice.springs(spacing, law), false);
        assembly.strain_limit = self.strain_limit;
        Ok(())
    }

    fn spot(&self, spot: Spot, _: &[Vector3<f64>]) -> Option<Vec<usize>> {
        Lattice(self.grid).face(spot)
    }
}

/// Points and tetrahedra of a solid, relative to its origin.
struct Shape {
    positions: Vec<Vector3<f64>>,
    tetrahedra: Vec<[u32; 4]>,
    boundary: Vec<[u32; 3]>,
}

impl Solid {
    /// Returns the lattice of a box and the lengths of its edges (m); `None` for a file.
    fn lattice(&self) -> Result<Option<(Lattice, Vector3<f64>)>, Fault> {
        match (self.file.is_some(), self.grid, self.size) {
            (false, Some(grid), Some(size)) if self.scale.is_none() => {
                Ok(Some((Lattice(grid), Vector3::from(size))))
            }
            (true, None, None) => Ok(None),
            _ => refuse!("":
                "a solid is a box with the keys `grid` and `size`, or from a `file` with a `scale`"),
        }
    }

    /// Returns the shape of a box, or that of the mesh of its file.
    fn shape(&self, mesh: Option<&Mesh>) -> Result<Shape, Fault> {
        let Some((lattice, size)) = self.lattice()? else {
            let scale = self.scale.unwrap_or(1.0);
            at("scale", positive("it", scale))?;
            let mesh = mesh.map(|mesh| mesh.scaled(scale));
            let mesh = mesh.unwrap_or_default();
            return Ok(Shape {
                positions: mesh.positions.into_iter().map(Vector3::from).collect(),
                tetrahedra: mesh.tetrahedra,
                boundary: mesh.triangles,
            });
        };
        for size in &size {
            at("size", positive("each edge", *size))?;
        }
        let place = |cell: [usize; 3]| {
            let share = |axis: usize| cell[axis] as f64 / (lattice.0[axis] - 1) as f64;
            Vector3::from_fn(|axis, _| (share(axis) - 0.5) * size[axis])
        };
        let tetrahedra: Vec<_> = lattice.tetrahedra().collect();
        Ok(Shape {
            positions: lattice.cells().map(place).collect(),
            boundary: boundary(&tetrahedra),
            tetrahedra,
        })
    }

    fn material(&self) -> Result<Material, Fault> {
        let (young, poisson, damping) = (self.young, self.poisson, self.damping);
        at("young", positive("it", young))?;
        at("damping", at_least(0.0, "it", damping))?;
        let model = match self.model {
            SolidModel::NeoHookean => Hyperelastic::NeoHookean,
            SolidModel::StVenantKirchhoff => Hyperelastic::StVenantKirchhoff,
        };
        let material = Material { model, young, poisson, damping };
        at("poisson", material.check()).map(|()| material)
    }
}

/// Rewrites an error of a tetrahedron with the numbers that the file gives to it and its corners.
fn in_file(why: Error, mesh: Option<&Mesh>, shape: &Shape, material: Material) -> Error {
    let Shape { positions, tetrahedra, .. } = shape;
    let is_wrong = |t: &[u32; 4]| Elastic::new(0, &[*t], positions, material).is_err();
    let found = tetrahedra.iter().position(is_wrong).zip(mesh);
    let numbered = found.and_then(|(k, mesh)| {
        let number = mesh.tetrahedron_numbers.get(k)?;
        let [a, b, c, d] = tetrahedra[k].map(|i| mesh.number(i as usize));
        Some(format!(
            "{why}; in the file it is number {number}, with the points {a}, {b}, {c} and {d}"
        ))
    });
    numbered.map_or(why, Error::Invalid)
}

impl Body for Solid {
    fn add_to(&self, assembly: &mut Assembly, files: &mut Files) -> Result<(), Fault> {
        let file = self.file.as_deref().map(|file| files.read(file));
        let mesh = file.transpose()?;
        let count = mesh.as_ref().map_or(0, |mesh| mesh.tetrahedra.len());
        files.budget.spend("", count, CELLS)?;
        let (particles, tetrahedra) = match (self.lattice()?, &mesh) {
            (Some((lattice, _)), _) => {
                let particles = lattice.particles("solid", [20, 4, 4])?;
                (particles, particles.saturating_mul(6))
            }
            (None, Some(mesh)) if !mesh.tetrahedra.is_empty() => {
                (mesh.positions.len(), mesh.tetrahedra.len())
            }
            _ => {
                refuse!("file": "the file has no tetrahedra: a solid needs a .msh or an .ele file");
            }
        };
        files.spend(particles, &[(tetrahedra, TETRAHEDRA)])?;
        let material = self.material()?;
        at("density", positive("it", self.density))?;
        let source = if mesh.is_some() { "file" } else { "size" };
        let shape = self.shape(mesh.as_ref())?;
        let first = assembly.masses.len();
        let solid = Elastic::new(first, &shape.tetrahedra, &shape.positions, material);
        let solid = solid.map_err(|why| in_file(why, mesh.as_ref(), &shape, material));
        let solid = at(source, solid)?;
        let Shape { positions, tetrahedra, boundary } = shape;
        let mut masses = vec![0.0; positions.len()];
        let mut spacings = vec![f64::INFINITY; positions.len()];
        for (corners, volume) in tetrahedra.iter().zip(solid.volumes()) {
            let height = height(corners.map(|i| positions[i as usize]), volume);
            for i in corners.map(|i| i as usize) {
                masses[i] += 0.25 * self.density * volume;
                spacings[i] = spacings[i].min(height);
            }
        }
        let mean = spacings.iter().sum::<f64>() / spacings.len() as f64;
        let law = [material.young * mean, material.damping];
        let skin = SkinSpec::of(self, assembly.gravity, law);
        assembly.skins.extend(skin.fitted(&masses, &spacings)?);
        let places = positions.into_iter().map(placed(self.at, self.rotation));
        assembly.add_particles(&masses, places, self.velocity);
        assembly.solids.push(solid);
        assembly.add_surface(first, boundary);
        Ok(())
    }

    fn spot(&self, spot: Spot, positions: &[Vector3<f64>]) -> Option<Vec<usize>> {
        match self.lattice() {
            Ok(Some((lattice, _))) => lattice.face(spot),
            _ => extreme(spot, positions),
        }
    }
}

/// Returns the smallest height of a tetrahedron over one of its faces (m).
fn height([a, b, c, d]: [Vector3<f64>; 4], volume: f64) -> f64 {
    let sides = [[b - a, c - a], [b - a, d - a], [c - a, d - a], [c - b, d - b]];
    let doubled = sides.map(|[u, v]| u.cross(&v).norm());
    6.0 * volume / doubled.into_iter().fold(0.0, f64::max)
}

/// Lattice of nx x ny x nz particles, in which x is counted fastest, then y, then z.
#[derive(Clone, Copy)]
pub(super) struct Lattice(pub [usize; 3]);

/// Kinds of springs, and the offset from one end to the other in particles.
#[rustfmt::skip]
const OFFSETS: [(SpringKind, [isize; 3]); 16] = [
    (Structural, [1, 0, 0]), (Structural, [0, 1, 0]), (Structural, [0, 0, 1]),
    (Shear, [1, 1, 0]), (Shear, [1, -1, 0]), (Shear, [1, 0, 1]), (Shear, [1, 0, -1]),
    (Shear, [0, 1, 1]), (Shear, [0, 1, -1]), (Shear, [1, 1, 1]), (Shear, [1, 1, -1]),
    (Shear, [1, -1, 1]), (Shear, [1, -1, -1]),
    (Bend, [2, 0, 0]), (Bend, [0, 2, 0]), (Bend, [0, 0, 2]),
];

/// Kuhn's tetrahedra of a cell: the order of the axes along which each goes from one corner to the
/// opposite one. Neighbouring cells agree on the diagonals of their faces.
#[rustfmt::skip]
const KUHN_PATHS: [[usize; 3]; 6] =
    [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];

impl Lattice {
    /// Counts the particles of a body of this name, which needs two along each edge as in the
    /// example.
    pub fn particles(self, body: &str, example: [usize; 3]) -> Result<usize, Fault> {
        let [nx, ny, nz] = self.0;
        let particles = nx.checked_mul(ny).and_then(|layer| layer.checked_mul(nz));
        let Some(particles) = particles.filter(|_| self.0.iter().all(|n| *n >= 2)) else {
            refuse!("grid":
                "a {body} has at least 2 particles along each edge, such as {example:?}, not {:?}",
                self.0);
        };
        Ok(particles)
    }

    /// Returns the number of the particle at a lattice point.
    pub fn index_of(self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.0[1] + j) * self.0[0] + i
    }

    /// Lists the lattice points [i, j, k] of all particles, in the order of their numbers.
    pub fn cells(self) -> impl Iterator<Item = [usize; 3]> {
        let [nx, ny, nz] = self.0;
        (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
    }

    /// Lists the particles of a face, if the spot is one.
    pub fn face(self, spot: Spot) -> Option<Vec<usize>> {
        let (axis, far) = side(spot)?;
        let at = if far { self.0[axis] - 1 } else { 0 };
        let there = self.cells().filter(|cell| cell[axis] == at);
        Some(there.map(|cell| self.index_of(cell)).collect())
    }

    /// Lists the tetrahedra, six in each cell, with positive volumes.
    pub fn tetrahedra(self) -> impl Iterator<Item = [u32; 4]> {
        let cells = self.cells();
        let whole = cells.filter(move |cell| (0..3).all(|axis| cell[axis] + 1 < self.0[axis]));
        whole.flat_map(move |cell| {
            KUHN_PATHS.into_iter().enumerate().map(move |(k, axes)| {
                let mut at = cell;
                let mut corners = [self.index_of(cell) as u32; 4];
                for (corner, axis) in corners[1..].iter_mut().zip(axes) {
                    at[axis] += 1;
                    *corner = self.index_of(at) as u32;
                }
                // The last three paths have the opposite orientation.
                if k >= 3 {
                    corners.swap(1, 2);
                }
                corners
            })
        })
    }

    /// Lists the springs of a lattice with this spacing (m). `law` gives the law of a spring by its
    /// kind and length (m).
    pub fn springs(
        self,
        spacing: [f64; 3],
        law: impl Fn(SpringKind, f64) -> SpringLaw,
    ) -> impl Iterator<Item = Spring> {
        let laws = OFFSETS.map(|(kind, offset)| {
            let squares = (0..3).map(|axis| (offset[axis] as f64 * spacing[axis]).powi(2));
            law(kind, squares.sum::<f64>().sqrt())
        });
        self.cells().flat_map(move |here| {
            let all = OFFSETS.into_iter().zip(laws);
            all.filter_map(move |((kind, offset), law)| {
                let mut there = here;
                for axis in 0..3 {
                    let k = here[axis].checked_add_signed(offset[axis])?;
                    there[axis] = Some(k).filter(|k| *k < self.0[axis])?;
                }
                let (i, j) = (self.index_of(here), self.index_of(there));
                Some(Spring { kind, i, j, law })
            })
        })
    }

    /// Lists the triangles of the six faces, counterclockwise as seen from outside.
    pub fn triangles(self) -> Vec<[u32; 3]> {
        let mut triangles = vec![];
        for axis in 0..3 {
            // (u, v, axis) are right-handed: the far face turns from u to v.
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            for far in [false, true] {
                for a in 0..self.0[u] - 1 {
                    for b in 0..self.0[v] - 1 {
                        let corner = |da: usize, db: usize| {
                            let mut at = [0; 3];
                            (at[u], at[v]) = (a + da, b + db);
                            at[axis] = if far { self.0[axis] - 1 } else { 0 };
                            self.index_of(at) as u32
                        };
                        let [p, q, r, s] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                        let halves = [[[p, r, q], [p, s, r]], [[p, q, r], [p, r, s]]];
                        triangles.extend(halves[usize::from(far)]);
                    }
                }
            }
        }
        triangles
    }
}
