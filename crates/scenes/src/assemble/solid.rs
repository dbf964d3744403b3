//! Elastic solids: boxes, or the tetrahedra of a file.

use a3_core::elements::{Hyperelastic, Material, Solid as Elastic};
use a3_core::{Error, Vector3};

use super::assembly::{Assembly, Body, placed};
use super::files::Files;
use super::lattice::Lattice;
use super::pins::extreme;
use super::skins::SkinSpec;
use crate::budget::{CELLS, TETRAHEDRA};
use crate::check::{at, at_least, positive};
use crate::description::{Solid, SolidModel, Spot};
use crate::fault::Fault;
use crate::mesh::{Mesh, boundary};

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
            _ => Err(Fault::new(
                "",
                "a solid is a box with the keys `grid` and `size`, or from a `file` with a `scale`",
            )),
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
        let Solid {
            young,
            poisson,
            damping,
            ..
        } = *self;
        at("young", positive("it", young))?;
        at("damping", at_least(0.0, "it", damping))?;
        let material = Material {
            model: match self.model {
                SolidModel::NeoHookean => Hyperelastic::NeoHookean,
                SolidModel::StVenantKirchhoff => Hyperelastic::StVenantKirchhoff,
            },
            young,
            poisson,
            damping,
        };
        at("poisson", material.check()).map(|()| material)
    }
}

/// Rewrites an error of a tetrahedron with the numbers that the file gives to it and its corners.
fn in_file(why: Error, mesh: Option<&Mesh>, shape: &Shape, material: Material) -> Error {
    let Shape {
        positions,
        tetrahedra,
        ..
    } = shape;
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
                let why = "the file has no tetrahedra: a solid needs a .msh or an .ele file";
                return Err(Fault::new("file", why));
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
        let Shape {
            positions,
            tetrahedra,
            boundary,
        } = shape;
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
    let faces = [
        (b - a, c - a),
        (b - a, d - a),
        (c - a, d - a),
        (c - b, d - b),
    ];
    let largest = faces
        .iter()
        .map(|(u, v)| u.cross(v).norm())
        .fold(0.0, f64::max);
    6.0 * volume / largest
}
