//! Chains of springs or rods, single particles, and the laws of springs as descriptions give them.

use a3_core::elements::Buckling;
use a3_core::{Constraint, Spring, SpringKind, SpringLaw, Vector3};

use super::assembly::{Assembly, Body, Files, SkinSpec};
use crate::budget::{RODS, SPRINGS, STRIPS};
use crate::description::{BucklingSpec, Chain, Particles, Spot, SpringSpec};
use crate::fault::{Fault, at, at_least, one_of, positive};

/// Assumed distance between single particles (m), from which their thickness follows if none is
/// given.
const POINT_SPACING: f64 = 0.04;

impl Body for Chain {
    fn add_to(&self, assembly: &mut Assembly, files: &mut Files) -> Result<(), Fault> {
        let n = self.particles;
        refuse!(if n < 2 => "particles": "a chain has at least 2 particles, not {n}");
        let count = |is_there: bool| n * usize::from(is_there);
        let (springs, strips) = (count(!self.rigid), count(self.buckling.is_some()));
        let rods = count(self.rigid);
        files.spend(n, &[(springs, SPRINGS), (strips, STRIPS), (rods, RODS)])?;
        let (from, to) = (Vector3::from(self.from), Vector3::from(self.to));
        at("mass", positive("it", self.mass))?;
        at("stiffness", at_least(0.0, "it", self.stiffness))?;
        at("damping", at_least(0.0, "it", self.damping))?;
        let length = (to - from).norm() / (n - 1) as f64;
        refuse!(if from == to => "to": "a chain leads to another point than `from`");
        let rest_length = self.rest_length.unwrap_or(length);
        at("rest_length", at_least(0.0, "it", rest_length))?;
        let (stiffness, damping) = (self.stiffness, self.damping);
        let law = SpringLaw { stiffness, rest_length, damping };
        let ratio = damping / stiffness;
        let time = if stiffness > 0.0 { ratio } else { 0.0 };
        let skin = SkinSpec::of(self, assembly.gravity, [stiffness, time]);
        let masses = vec![self.mass; n];
        let places = (0..n).map(|i| from + (to - from) * (i as f64 / (n - 1) as f64));
        let first = assembly.add_particles(&masses, places, self.velocity);
        assembly.skins.extend(skin.uniform(&masses, length)?);
        let edges = (first..first + n - 1).map(|i| [i as u32, i as u32 + 1]);
        assembly.edges.extend(edges);
        let links = (0..n - 1).map(|i| [i, i + 1]);
        refuse!(if self.rigid && self.tension_only => "tension_only":
            "a rigid chain has rods, which also push; leave out one of `rigid` and `tension_only`");
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
            let strips = (first..first + n - 2).map(strip);
            assembly.strips.extend(strips);
        }
        Ok(())
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
    fn add_to(&self, assembly: &mut Assembly, files: &mut Files) -> Result<(), Fault> {
        let n = self.positions.len();
        for (key, count) in [("velocities", self.velocities.len()), ("masses", self.masses.len())] {
            refuse!(if count != 0 && count != n => key: "there are {count}, but {n} positions");
        }
        refuse!(if n == 0 => "positions": "there must be at least one position");
        files.spend(n, &[(self.springs.len(), SPRINGS)])?;
        let same = self.mass.map(|mass| vec![mass; n]);
        let listed = Some(self.masses.clone()).filter(|all| !all.is_empty());
        let (is_same, masses) = one_of(("mass", same), ("masses", listed))?;
        let key = if is_same { "mass" } else { "masses" };
        for m in &masses {
            at(key, positive("each", *m))?;
        }
        let velocities = self.velocities.iter().map(|v| Vector3::from(*v));
        assembly.velocities.extend(velocities);
        let places = self.positions.iter().map(|p| Vector3::from(*p));
        // Without velocities, the particles are at rest.
        let first = assembly.add_particles(&masses, places, None);
        let springs = springs(&self.springs, n)?;
        let stiffest = springs.iter().map(|s| s.law.stiffness).fold(0.0, f64::max);
        let most = springs.iter().map(|s| s.law.damping).fold(0.0, f64::max);
        let time = if stiffest > 0.0 { most / stiffest } else { 0.0 };
        let skin = SkinSpec::of(self, assembly.gravity, [stiffest, time]);
        let given = self.thickness.map(|thickness| 4.0 * thickness);
        let skins = skin.uniform(&masses, given.unwrap_or(POINT_SPACING))?;
        assembly.skins.extend(skins);
        let points = (first..first + n).map(|i| [i as u32; 2]);
        assembly.edges.extend(points);
        assembly.add_springs(first, springs, self.tension_only);
        Ok(())
    }
}

/// Creates springs between the particles of a body that has `particles` of them.
pub(super) fn springs(specs: &[SpringSpec], particles: usize) -> Result<Vec<Spring>, Fault> {
    let spring = |(k, &(i, j, stiffness, rest_length, damping)): (usize, &SpringSpec)| {
        let law = if i.max(j) >= particles || i == j {
            let last = particles - 1;
            Err(format!("{i} and {j} must be two different particles from 0 to {last}"))
        } else {
            SpringLaw::new(stiffness, rest_length, damping).map_err(|e| e.to_string())
        };
        let law = law.map_err(|why| format!("spring {k}, counted from 0: {why}"));
        let law = at("springs", law)?;
        let kind = SpringKind::Structural;
        Ok(Spring { kind, i, j, law })
    };
    specs.iter().enumerate().map(spring).collect()
}

/// Returns damping over stiffness (s), which is given directly or by the damping ratio of a
/// particle of this mass (kg) on a spring of this stiffness (N/m).
pub fn damping_time(
    damping: Option<f64>,
    ratio: Option<f64>,
    mass: f64,
    stiffness: f64,
) -> Result<f64, Fault> {
    match (damping, ratio) {
        (None, None) => Ok(0.0),
        (Some(_), Some(_)) => Err(Fault::not_both("damping", "damping_ratio")),
        (Some(time), None) => at("damping", at_least(0.0, "it", time)).map(|()| time),
        (None, Some(ratio)) => {
            at("damping_ratio", at_least(0.0, "it", ratio))?;
            let stiff = positive("the structural stiffness that it refers to", stiffness);
            at("damping_ratio", stiff)?;
            Ok(2.0 * ratio * (mass / stiffness).sqrt())
        }
    }
}

/// Creates a buckling spring between two particles from its rest length (m), and its stiffness
/// (N/m) and damping (N s/m) under tension.
pub(super) fn strip(
    law: &BucklingSpec,
    [i, j]: [usize; 2],
    rest_length: f64,
    [tension, damping]: [f64; 2],
) -> Buckling {
    Buckling {
        i,
        j,
        rest_length,
        bending: law.bending,
        compression: law.compression,
        tension,
        damping,
    }
}
