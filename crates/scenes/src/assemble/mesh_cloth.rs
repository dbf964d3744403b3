//! Cloths from files of triangles.

use a3_core::elements::{Gas, GasLaw};
use a3_core::{SpringKind, SpringLaw, Vector3};

use super::assembly::{Assembly, Body, placed};
use super::files::Files;
use super::laws::damping_time;
use super::pins::extreme;
use super::skins::SkinSpec;
use crate::budget::{SPRINGS, TRIANGLES};
use crate::check::{at, positive};
use crate::description::{MeshCloth, Spot};
use crate::fault::Fault;

/// Returns the volume (m3) that triangles between these positions (m) enclose; it is negative if
/// they are clockwise from outside.
fn volume(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> f64 {
    let of_one = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| Vector3::from(positions[i as usize]));
        a.dot(&b.cross(&c)) / 6.0
    };
    triangles.iter().map(of_one).sum()
}

impl Body for MeshCloth {
    fn add_to(&self, assembly: &mut Assembly, files: &mut Files) -> Result<(), Fault> {
        let mesh = files.read(&self.file)?;
        files.budget.spend("", mesh.triangles.len(), TRIANGLES)?;
        let mesh = mesh.welded();
        if mesh.triangles.is_empty() {
            return Err(Fault::new("file", "the mesh has no triangles"));
        }
        files.spend(mesh.positions.len(), &[(3 * mesh.triangles.len(), SPRINGS)])?;
        let scale = self.scale.unwrap_or(1.0);
        at("scale", positive("it", scale))?;
        at("density", positive("it", self.density))?;
        let scaled = mesh.scaled(scale);
        let areas = scaled.areas();
        let masses: Vec<_> = areas.iter().map(|area| area * self.density).collect();
        if let Some(bad) = masses.iter().position(|m| !m.is_finite() || *m <= 0.0) {
            let (number, [x, y, z]) = (mesh.number(bad), mesh.positions[bad]);
            let point = format!("point {number} at ({x}, {y}, {z})");
            let why = format!("the triangles around {point} have no area");
            return Err(Fault::new("file", why));
        }
        let mean = masses.iter().sum::<f64>() / masses.len() as f64;
        let structural = self.stiffness[0];
        let time = damping_time(self.damping, self.damping_ratio, mean, structural)?;
        let law = |kind, length| {
            let k = self.stiffness[usize::from(kind == SpringKind::Bend)];
            SpringLaw::new(k, length, k * time)
        };
        let springs = at("stiffness", scaled.springs(law))?;
        let points = scaled.positions.iter().map(|p| Vector3::from(*p));
        let places = points.map(placed(self.at.unwrap_or_default(), self.rotation));
        let first = assembly.add_particles(&masses, places, self.velocity);
        let law = match (self.pressure, self.fill) {
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
        let skin = SkinSpec::of(self, assembly.gravity, [structural, time]);
        let skins = skin.fitted(&masses, &scaled.heights())?;
        assembly.skins.extend(skins);
        assembly.add_surface(first, mesh.triangles.iter().copied());
        assembly.add_springs(first, springs, self.tension_only);
        assembly.strain_limit = self.strain_limit;
        Ok(())
    }

    fn spot(&self, spot: Spot, positions: &[Vector3<f64>]) -> Option<Vec<usize>> {
        match spot {
            Spot::Top | Spot::Bottom => extreme(spot, positions),
            _ => None,
        }
    }
}
