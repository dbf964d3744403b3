//! Cloths from files of triangles.

use a3_core::elements::{Gas, GasLaw};
use a3_core::{SpringKind, SpringLaw, Vector3};
use nalgebra::Rotation3;

use super::assembly::{Assembly, Body, Counts};
use super::laws::damping_time;
use super::pins::extreme;
use super::skins::SkinSpec;
use crate::check::{at, positive};
use crate::description::{MeshCloth, Pin, Spot};
use crate::fault::Fault;
use crate::mesh::Mesh;

/// Cloth with the mesh of its file.
pub(super) struct LoadedMesh<'a> {
    pub cloth: &'a MeshCloth,
    pub mesh: Mesh,
}

/// Returns the volume (m3) that triangles between these positions (m) enclose; it is negative if
/// they are clockwise from outside.
fn volume(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> f64 {
    let of_one = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| Vector3::from(positions[i as usize]));
        a.dot(&b.cross(&c)) / 6.0
    };
    triangles.iter().map(of_one).sum()
}

impl Body for LoadedMesh<'_> {
    fn counts(&self) -> Result<Counts, Fault> {
        if self.mesh.triangles.is_empty() {
            return Err(Fault::new("file", "the mesh has no triangles"));
        }
        Ok(Counts {
            particles: self.mesh.positions.len(),
            springs: 3 * self.mesh.triangles.len(),
            ..Counts::default()
        })
    }

    fn add_to(&self, assembly: &mut Assembly) -> Result<(), Fault> {
        let Self { cloth, mesh } = self;
        let scale = cloth.scale.unwrap_or(1.0);
        at("scale", positive("it", scale))?;
        at("density", positive("it", cloth.density))?;
        let rotation = Rotation3::new(Vector3::from(cloth.rotation.unwrap_or_default()));
        let origin = Vector3::from(cloth.at.unwrap_or_default());
        let velocity = Vector3::from(cloth.velocity.unwrap_or_default());
        let first = assembly.masses.len();
        let scaled = mesh.scaled(scale);
        let masses: Vec<_> = scaled
            .areas()
            .iter()
            .map(|area| area * cloth.density)
            .collect();
        if let Some(bad) = masses.iter().position(|m| !m.is_finite() || *m <= 0.0) {
            let (number, [x, y, z]) = (mesh.number(bad), mesh.positions[bad]);
            return Err(Fault::new(
                "file",
                format!("the triangles around point {number} at ({x}, {y}, {z}) have no area"),
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
        let springs = at("stiffness", scaled.springs(law))?;
        for p in &scaled.positions {
            assembly
                .positions
                .push(origin + rotation * Vector3::from(*p));
            assembly.velocities.push(velocity);
        }
        let law = match (cloth.pressure, cloth.fill) {
            (Some(_), Some(_)) => return Err(Fault::not_both("pressure", "fill")),
            (Some(pressure), None) => Some(("pressure", GasLaw::Pressure(pressure))),
            (None, Some(fill)) => {
                at("fill", positive("it", fill))?;
                let volume = volume(&scaled.positions, &mesh.triangles).abs();
                at("fill", positive("the volume of the mesh", volume))?;
                Some(("fill", GasLaw::Amount(fill * volume)))
            }
            (None, None) => None,
        };
        if let Some((key, law)) = law {
            let mut triangles = mesh.triangles.clone();
            if volume(&scaled.positions, &triangles) < 0.0 {
                for triangle in &mut triangles {
                    triangle.swap(1, 2);
                }
            }
            for i in triangles.iter_mut().flatten() {
                *i += first as u32;
            }
            assembly.gases.push(at(key, Gas::new(law, triangles))?);
        }
        let skin = SkinSpec {
            thickness: cloth.thickness,
            contact_stiffness: cloth.contact_stiffness,
            friction: cloth.friction,
            restitution: cloth.restitution,
            stiffness: structural,
            time,
        };
        assembly
            .skins
            .extend(skin.fitted(&masses, &scaled.heights())?);
        assembly.masses.extend(masses);
        assembly.add_surface(first, mesh.triangles.iter().copied());
        assembly.add_springs(first, springs, cloth.tension_only);
        Ok(())
    }

    fn strain_limit(&self) -> Option<f64> {
        self.cloth.strain_limit
    }

    fn pins(&self) -> &[Pin] {
        &self.cloth.pin
    }

    fn spot(&self, spot: Spot, positions: &[Vector3<f64>]) -> Option<Vec<usize>> {
        match spot {
            Spot::Top | Spot::Bottom => extreme(spot, positions),
            _ => None,
        }
    }
}
