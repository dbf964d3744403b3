//! Chains of springs or rods, and single particles.

use a3_core::{Constraint, Spring, SpringKind, SpringLaw, Vector3};

use super::assembly::{Assembly, Body, Counts};
use super::laws::{springs, strip};
use super::skins::SkinSpec;
use crate::check::{at, at_least, positive};
use crate::description::{Chain, Particles, Pin, Spot};
use crate::fault::Fault;

/// Assumed distance between single particles (m), from which their thickness follows if none is
/// given.
const POINT_SPACING: f64 = 0.04;

impl Body for Chain {
    fn counts(&self) -> Result<Counts, Fault> {
        if self.particles < 2 {
            return Err(Fault::new(
                "particles",
                format!("a chain has at least 2 particles, not {}", self.particles),
            ));
        }
        Ok(Counts {
            particles: self.particles,
            springs: if self.rigid { 0 } else { self.particles },
            strips: if self.buckling.is_some() {
                self.particles
            } else {
                0
            },
            rods: if self.rigid { self.particles } else { 0 },
            ..Counts::default()
        })
    }

    fn add_to(&self, assembly: &mut Assembly) -> Result<(), Fault> {
        let n = self.particles;
        let (from, to) = (Vector3::from(self.from), Vector3::from(self.to));
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
        let velocity = Vector3::from(self.velocity.unwrap_or_default());
        let first = assembly.masses.len();
        for i in 0..n {
            let share = i as f64 / (n - 1) as f64;
            assembly.positions.push(from + (to - from) * share);
            assembly.velocities.push(velocity);
        }
        let skin = SkinSpec {
            thickness: self.thickness,
            contact_stiffness: self.contact_stiffness,
            friction: self.friction,
            restitution: self.restitution,
            stiffness: self.stiffness,
            time: if self.stiffness > 0.0 {
                self.damping / self.stiffness
            } else {
                0.0
            },
        };
        let masses = vec![self.mass; n];
        let length = (to - from).norm() / (n - 1) as f64;
        let spacing = if length > 0.0 { length } else { POINT_SPACING };
        assembly.skins.extend(skin.uniform(&masses, spacing)?);
        let edges = (first..first + n - 1).map(|i| [i as u32, i as u32 + 1]);
        assembly.edges.extend(edges);
        assembly.masses.extend(masses);
        let links = (0..n - 1).map(|i| [i, i + 1]);
        if self.rigid && self.tension_only {
            let why = "a rigid chain has rods, which also push; leave out one of `rigid` and `tension_only`";
            return Err(Fault::new("tension_only", why));
        }
        if self.rigid {
            at("rest_length", positive("the length of a rod", rest_length))?;
            assembly.rods.extend(links.map(|[i, j]| Constraint::Rod {
                i: first + i,
                j: first + j,
                length: rest_length,
            }));
        } else {
            let kind = SpringKind::Structural;
            let springs = links.map(|[i, j]| Spring { kind, i, j, law });
            assembly.add_springs(first, springs, self.tension_only);
        }
        if let Some(law) = &self.buckling {
            let strip = |i| strip(law, [i, i + 2], 2.0 * rest_length, [0.0, 0.0]);
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
    fn counts(&self) -> Result<Counts, Fault> {
        let n = self.positions.len();
        for (key, count) in [
            ("velocities", self.velocities.len()),
            ("masses", self.masses.len()),
        ] {
            if count != 0 && count != n {
                return Err(Fault::new(
                    key,
                    format!("there are {count}, but {n} positions"),
                ));
            }
        }
        if n == 0 {
            return Err(Fault::new(
                "positions",
                "there must be at least one position",
            ));
        }
        Ok(Counts {
            particles: n,
            springs: self.springs.len(),
            ..Counts::default()
        })
    }

    fn add_to(&self, assembly: &mut Assembly) -> Result<(), Fault> {
        let n = self.positions.len();
        let (key, masses) = match (self.mass, &self.masses[..]) {
            (Some(mass), []) => ("mass", vec![mass; n]),
            (None, [_, ..]) => ("masses", self.masses.clone()),
            (Some(_), _) => return Err(Fault::not_both("mass", "masses")),
            (None, []) => {
                return Err(Fault::new(
                    "",
                    "one of the keys `mass` and `masses` is needed",
                ));
            }
        };
        for m in &masses {
            at(key, positive("each", *m))?;
        }
        for p in &self.positions {
            assembly.positions.push(Vector3::from(*p));
        }
        for i in 0..n {
            let velocity = self.velocities.get(i).copied();
            let velocity = Vector3::from(velocity.unwrap_or_default());
            assembly.velocities.push(velocity);
        }
        let first = assembly.masses.len();
        let springs = springs(&self.springs, n)?;
        let stiffest = springs.iter().map(|s| s.law.stiffness).fold(0.0, f64::max);
        let skin = SkinSpec {
            thickness: self.thickness,
            contact_stiffness: self.contact_stiffness,
            friction: self.friction,
            restitution: self.restitution,
            stiffness: stiffest,
            time: springs.iter().map(|s| s.law.damping).fold(0.0, f64::max) / stiffest.max(1.0),
        };
        let spacing = self
            .thickness
            .map_or(POINT_SPACING, |thickness| 4.0 * thickness);
        assembly.skins.extend(skin.uniform(&masses, spacing)?);
        assembly
            .edges
            .extend((first..first + n).map(|i| [i as u32; 2]));
        assembly.masses.extend(masses);
        assembly.add_springs(first, springs, self.tension_only);
        Ok(())
    }

    fn pins(&self) -> &[Pin] {
        &self.pin
    }

    fn spot(&self, _: Spot, _: &[Vector3<f64>]) -> Option<Vec<usize>> {
        None
    }
}
