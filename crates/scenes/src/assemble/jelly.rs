//! Boxes of jelly.

use a3_core::{SpringKind, SpringLaw, Vector3};

use super::assembly::{Assembly, Body, placed};
use super::files::Files;
use super::lattice::Lattice;
use super::laws::damping_time;
use super::skins::SkinSpec;
use crate::budget::SPRINGS;
use crate::check::{at, at_least, positive, positive_one};
use crate::description::{Jelly, Spot};
use crate::fault::Fault;

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
        let mass = if by_volume {
            mass * self.size.iter().product::<f64>() / particles as f64
        } else {
            mass
        };
        let structural = self.stiffness[0];
        for k in self.stiffness {
            at("stiffness", at_least(0.0, "each", k))?;
        }
        let time = damping_time(self.damping, self.damping_ratio, mass, structural)?;
        let law = |kind: SpringKind, rest_length| {
            let stiffness = self.stiffness[kind as usize];
            SpringLaw {
                stiffness,
                rest_length,
                damping: stiffness * time,
            }
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
