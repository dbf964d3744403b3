//! Elastic solids: boxes, or the tetrahedra of a file.

use a3_core::elements::{Hyperelastic, Material, Solid as Elastic};
use a3_core::{Error, Vector3};
use nalgebra::Rotation3;

use super::assembly::{Assembly, Body, Counts};
use super::lattice::Lattice;
use super::pins::extreme;
use super::skins::SkinSpec;
use crate::check::{at, at_least, positive};
use crate::description::{Pin, Solid, SolidModel, Spot};
use crate::fault::Fault;
use crate::mesh::{Mesh, boundary};

/// Solid with the tetrahedra of its file.
pub(super) struct LoadedSolid<'a> {
    pub solid: &'a Solid,
    /// Mesh of the file; `None` for a box.
    pub mesh: Option<Mesh>,
}

/// Points and tetrahedra of a solid, relative to its origin.
struct Shape {
    positions: Vec<Vector3<f64>>,
    tetrahedra: Vec<[u32; 4]>,
    boundary: Vec<[u32; 3]>,
}

impl LoadedSolid<'_> {
    /// Returns the lattice of a box and the lengths of its edges (m); `None` for a file.
    fn lattice(&self) -> Result<Option<(Lattice, Vector3<f64>)>, Fault> {
        let Solid {
            grid, size, scale, ..
        } = self.solid;
        match (self.mesh.is_some(), grid, size) {
            (false, Some(grid), Some(size)) if scale.is_none() => {
                Ok(Some((Lattice(*grid), Vector3::from(*size))))
            }
            (true, None, None) => Ok(None),
            _ => Err(Fault::new(
                "",
                "a solid is a box with the keys `grid` and `size`, or from a `file` with a `scale`",
            )),
        }
    }

    fn shape(&self) -> Result<Shape, Fault> {
        let Some((lattice, size)) = self.lattice()? else {
            let scale = self.solid.scale.unwrap_or(1.0);
            at("scale", positive("it", scale))?;
            let mesh = self.mesh.as_ref().map(|mesh| mesh.scaled(scale));
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
        } = *self.solid;
        at("young", positive("it", young))?;
        at("damping", at_least(0.0, "it", damping))?;
        let material = Material {
            model: match self.solid.model {
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

impl LoadedSolid<'_> {
    /// Rewrites an error of a tetrahedron with the numbers that the file gives to it and its
    /// corners.
    fn in_file(
        &self,
        why: Error,
        tetrahedra: &[[u32; 4]],
        positions: &[Vector3<f64>],
        material: Material,
    ) -> Error {
        let is_wrong = |t: &[u32; 4]| Elastic::new(0, &[*t], positions, material).is_err();
        let found = tetrahedra.iter().position(is_wrong).zip(self.mesh.as_ref());
        let numbered = found.and_then(|(k, mesh)| {
            let number = mesh.tetrahedron_numbers.get(k)?;
            let [a, b, c, d] = tetrahedra[k].map(|i| mesh.number(i as usize));
            Some(format!(
                "{why}; in the file it is number {number}, with the points {a}, {b}, {c} and {d}"
            ))
        });
        numbered.map_or(why, Error::Invalid)
    }
}

impl Body for LoadedSolid<'_> {
    fn counts(&self) -> Result<Counts, Fault> {
        let (particles, tetrahedra) = match (self.lattice()?, &self.mesh) {
            (Some((lattice, _)), _) => {
                let particles = lattice
                    .particles()
                    .filter(|_| lattice.0.iter().all(|n| *n >= 2));
                let particles = particles.ok_or_else(|| {
                    let [x, y, z] = lattice.0;
                    let why = format!(
                        "a solid has at least 2 particles along each edge, such as [20, 4, 4], not \
                         [{x}, {y}, {z}]"
                    );
                    Fault::new("grid", why)
                })?;
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
        Ok(Counts {
            particles,
            tetrahedra,
            ..Counts::default()
        })
    }

    fn add_to(&self, assembly: &mut Assembly) -> Result<(), Fault> {
        let material = self.material()?;
        at("density", positive("it", self.solid.density))?;
        let source = if self.mesh.is_some() { "file" } else { "size" };
        let Shape {
            positions,
            tetrahedra,
            boundary,
        } = self.shape()?;
        let first = assembly.masses.len();
        let solid = Elastic::new(first, &tetrahedra, &positions, material);
        let solid = solid.map_err(|why| self.in_file(why, &tetrahedra, &positions, material));
        let solid = at(source, solid)?;
        let mut masses = vec![0.0; positions.len()];
        let mut spacings = vec![f64::INFINITY; positions.len()];
        for (corners, volume) in tetrahedra.iter().zip(solid.volumes()) {
            let height = height(corners.map(|i| positions[i as usize]), volume);
            for i in corners.map(|i| i as usize) {
                masses[i] += 0.25 * self.solid.density * volume;
                spacings[i] = spacings[i].min(height);
            }
        }
        let mean = spacings.iter().sum::<f64>() / spacings.len() as f64;
        let skin = SkinSpec {
            thickness: self.solid.thickness,
            contact_stiffness: self.solid.contact_stiffness,
            friction: self.solid.friction,
            restitution: self.solid.restitution,
            stiffness: material.young * mean,
            time: material.damping,
        };
        assembly.skins.extend(skin.fitted(&masses, &spacings)?);
        let rotation = Rotation3::new(Vector3::from(self.solid.rotation.unwrap_or_default()));
        let origin = Vector3::from(self.solid.at);
        let velocity = Vector3::from(self.solid.velocity.unwrap_or_default());
        let count = positions.len();
        let places = positions.into_iter().map(|p| origin + rotation * p);
        assembly.positions.extend(places);
        assembly.velocities.extend(vec![velocity; count]);
        assembly.masses.extend(masses);
        assembly.solids.push(solid);
        assembly.add_surface(first, boundary);
        Ok(())
    }

    fn pins(&self) -> &[Pin] {
        &self.solid.pin
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
