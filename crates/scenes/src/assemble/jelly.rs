//! Boxes of jelly.

use a3_core::{SpringKind, SpringLaw, Vector3};
use nalgebra::Rotation3;

use super::assembly::{Assembly, Body, Counts};
use super::lattice::Lattice;
use super::laws::damping_time;
use super::skins::SkinSpec;
use crate::check::{at, at_least, one_of, positive};
use crate::description::{Jelly, Pin, Spot};
use crate::fault::Fault;

impl Body for Jelly {
    fn counts(&self) -> Result<Counts, Fault> {
        let particles = Lattice(self.grid).particles();
        let particles = particles
            .filter(|_| self.grid.iter().all(|n| *n >= 2))
            .ok_or_else(|| {
                let [x, y, z] = self.grid;
                let why = format!(
                    "a jelly has at least 2 particles along each edge, such as [8, 8, 8], not [{x}, {y}, {z}]"
                );
                Fault::new("grid", why)
            })?;
        Ok(Counts {
            particles,
            springs: particles.saturating_mul(16),
            ..Counts::default()
        })
    }

    fn add_to(&self, assembly: &mut Assembly) -> Result<(), Fault> {
        let lattice = Lattice(self.grid);
        let particles = self.counts()?.particles;
        for size in self.size {
            at("size", positive("each edge", size))?;
        }
        let spacing: [f64; 3] = std::array::from_fn(|a| self.size[a] / (self.grid[a] - 1) as f64);
        let (by_volume, mass) = one_of(("density", self.density), ("mass", self.mass))?;
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
        let law = |kind, rest_length| {
            let stiffness = match kind {
                SpringKind::Structural => structural,
                SpringKind::Shear => shear,
                SpringKind::Bend => bend,
            };
            SpringLaw {
                stiffness,
                rest_length,
                damping: stiffness * time,
            }
        };
        let first = assembly.masses.len();
        let rotation = Rotation3::new(Vector3::from(self.rotation.unwrap_or_default()));
        let center = Vector3::from(self.at);
        let velocity = Vector3::from(self.velocity.unwrap_or_default());
        for cell in lattice.cells() {
            let from_center =
                Vector3::from_fn(|a, _| cell[a] as f64 * spacing[a] - 0.5 * self.size[a]);
            assembly.positions.push(center + rotation * from_center);
            assembly.velocities.push(velocity);
        }
        let skin = SkinSpec {
            thickness: self.thickness,
            contact_stiffness: self.contact_stiffness,
            friction: self.friction,
            restitution: self.restitution,
            stiffness: structural,
            time,
        };
        let masses = vec![mass; particles];
        let nearest = spacing.into_iter().fold(f64::INFINITY, f64::min);
        assembly.skins.extend(skin.uniform(&masses, nearest)?);
        assembly.masses.extend(masses);
        assembly.add_surface(first, lattice.triangles());
        assembly.add_springs(first, lattice.springs(spacing, law), false);
        Ok(())
    }

    fn strain_limit(&self) -> Option<f64> {
        self.strain_limit
    }

    fn pins(&self) -> &[Pin] {
        &self.pin
    }

    fn spot(&self, spot: Spot, _: &[Vector3<f64>]) -> Option<Vec<usize>> {
        Lattice(self.grid).face(spot)
    }
}
