//! Skins of bodies: how thick, stiff and rough they are where surfaces touch.

use a3_core::contact::Skin;

use crate::check::{at, at_least, positive, share};
use crate::fault::Fault;

/// Thickness of a surface if none is given, and the most that is allowed, as a share of the
/// distance of its particles: neighbours are never so near that they repel each other.
const SHARE: f64 = 0.25;

/// Largest thickness (m) of a surface whose particles are at that distance (m).
pub fn most_thickness(spacing: f64) -> f64 {
    SHARE * spacing
}

/// Acceleration (m/s2) that contact withstands at least before surfaces meet.
const WITHSTOOD: f64 = 100.0;

/// Damping of contact over that of a spring of the same stiffness.
const DAMPING: f64 = 4.0;

/// Damping of the contact of rigid bodies: the speed that a body gains over its thickness, at the
/// acceleration that contact withstands, over that at which damping counts fully.
const RIGID_DAMPING: f64 = 1.5;

/// What a body says of its skin, and what it is made of.
pub(super) struct SkinSpec {
    pub thickness: Option<f64>,
    pub friction: f64,
    pub restitution: f64,
    /// Stiffness of its springs (N/m).
    pub stiffness: f64,
    /// Damping over stiffness of its springs (s).
    pub time: f64,
}

impl SkinSpec {
    /// Skin of a particle of that mass (kg), at that distance (m) of its neighbours.
    fn skin(&self, mass: f64, thickness: f64) -> Skin {
        Skin {
            thickness,
            stiffness: self.stiffness.max(mass * WITHSTOOD / thickness),
            // Damping counts fully where the gap would close within four times the springs' own
            // time: bounces die away as fast as the springs' oscillations.
            damping: DAMPING * self.time / thickness,
            friction: self.friction,
            restitution: self.restitution,
            mass,
        }
    }

    /// Skins of particles of these masses (kg), all at that distance (m) of their neighbours.
    pub fn uniform(&self, masses: &[f64], spacing: f64) -> Result<Vec<Skin>, Fault> {
        self.check()?;
        let most = SHARE * spacing;
        let thickness = self.thickness.unwrap_or(most);
        if thickness > most * (1.0 + 1e-9) {
            let why = format!(
                "it must be at most {most}, a quarter of the distance of neighbouring particles, not {thickness}"
            );
            return Err(Fault::new("thickness", why));
        }
        let skin = |m: &f64| self.skin(*m, thickness);
        Ok(masses.iter().map(skin).collect())
    }

    /// Skins of particles of these masses (kg), at these distances (m) of their neighbours, and no
    /// thicker than these allow.
    pub fn fitted(&self, masses: &[f64], spacings: &[f64]) -> Result<Vec<Skin>, Fault> {
        self.check()?;
        let thickness = |spacing: f64| {
            let most = SHARE * spacing;
            self.thickness.map_or(most, |thickness| thickness.min(most))
        };
        let all = masses.iter().zip(spacings);
        Ok(all
            .map(|(m, spacing)| self.skin(*m, thickness(*spacing)))
            .collect())
    }

    fn check(&self) -> Result<(), Fault> {
        if let Some(thickness) = self.thickness {
            at("thickness", positive("it", thickness))?;
        }
        at("friction", at_least(0.0, "it", self.friction))?;
        at("restitution", share("it", self.restitution))
    }
}

/// Skin of the points of a rigid body of that mass (kg).
pub(super) fn rigid_skin(
    mass: f64,
    thickness: f64,
    [friction, restitution]: [f64; 2],
) -> Result<Skin, Fault> {
    let spec = SkinSpec {
        thickness: Some(thickness),
        friction,
        restitution,
        stiffness: 0.0,
        time: 0.0,
    };
    spec.check()?;
    Ok(Skin {
        damping: RIGID_DAMPING / (WITHSTOOD * thickness).sqrt(),
        // A face rests on several points.
        ..spec.skin(0.25 * mass, thickness)
    })
}
