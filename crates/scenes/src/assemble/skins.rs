//! Skins of bodies: their thickness, stiffness and friction where surfaces touch.

use a3_core::contact::Skin;

use crate::description::{EARTH, Keys, SkinKeys};
use crate::fault::{Fault, at, at_least, positive, share};

/// Default and largest thickness of a surface, relative to the distance of its particles:
/// neighbours in a surface do not repel each other.
const MAX_THICKNESS: f64 = 0.25;

/// Returns the largest thickness (m) of a surface whose particles are at this distance (m).
pub fn max_thickness(spacing: f64) -> f64 {
    MAX_THICKNESS * spacing
}

/// Smallest acceleration (m/s2) against which the contact force keeps surfaces apart on Earth.
/// Elsewhere it is in proportion to gravity.
const ACCELERATION: f64 = 100.0;

/// Damping of contact, relative to that of a spring of the same stiffness.
const DAMPING: f64 = 4.0;

/// Damping of the contact of rigid bodies and of fluids: the speed that they gain over their
/// thickness at that acceleration, relative to the speed at which damping counts fully.
const POINT_DAMPING: f64 = 1.5;

/// Material of a body and the keys that describe its skin.
pub(super) struct SkinSpec {
    keys: SkinKeys,
    /// Stiffness of its springs (N/m).
    stiffness: f64,
    /// Damping over stiffness of its springs (s).
    time: f64,
    /// Gravity that the contact suits (m/s2).
    gravity: f64,
}

impl SkinSpec {
    /// Creates the description of a body's skin that suits this gravity (m/s2), over springs of a
    /// stiffness (N/m) whose damping over stiffness is `time` (s).
    pub fn of(body: &dyn Keys, gravity: f64, [stiffness, time]: [f64; 2]) -> Self {
        Self {
            keys: body.skin(),
            stiffness,
            time,
            gravity,
        }
    }

    /// Returns the smallest acceleration (m/s2) against which the skin keeps surfaces apart.
    fn acceleration(&self) -> f64 {
        ACCELERATION * (self.gravity / EARTH)
    }

    /// Creates the skin of a particle of this mass (kg) with this thickness (m).
    fn skin(&self, mass: f64, thickness: f64) -> Skin {
        Skin {
            thickness,
            stiffness: (self.keys.contact_stiffness).unwrap_or_else(|| {
                let own = mass * self.acceleration() / thickness;
                self.stiffness.max(own)
            }),
            // Damping counts fully where the gap would close within four times the springs' own
            // time: bounces die away as fast as the springs' oscillations.
            damping: DAMPING * self.time / thickness,
            friction: self.keys.friction,
            rolling: 0.0,
            restitution: self.keys.restitution,
            mass,
        }
    }

    /// Creates the skins of particles of these masses (kg), all at this distance (m) from their
    /// neighbours.
    pub fn uniform(&self, masses: &[f64], spacing: f64) -> Result<Vec<Skin>, Fault> {
        self.check()?;
        let most = MAX_THICKNESS * spacing;
        let thickness = self.keys.thickness.unwrap_or(most);
        if thickness > most * (1.0 + 1e-9) {
            let why = format!(
                "it must be at most {most}, a quarter of the distance of neighbouring particles, not {thickness}"
            );
            return Err(Fault::new("thickness", why));
        }
        let skin = |m: &f64| self.skin(*m, thickness);
        Ok(masses.iter().map(skin).collect())
    }

    /// Creates the skins of particles of these masses (kg), which are no thicker than their
    /// distances (m) from their neighbours allow.
    pub fn fitted(&self, masses: &[f64], spacings: &[f64]) -> Result<Vec<Skin>, Fault> {
        self.check()?;
        let given = self.keys.thickness.unwrap_or(f64::INFINITY);
        let skin = |(m, spacing): (&f64, &f64)| self.skin(*m, given.min(MAX_THICKNESS * spacing));
        Ok(masses.iter().zip(spacings).map(skin).collect())
    }

    fn check(&self) -> Result<(), Fault> {
        if let Some(thickness) = self.keys.thickness {
            at("thickness", positive("it", thickness))?;
        }
        if let Some(stiffness) = self.keys.contact_stiffness {
            at("contact_stiffness", positive("it", stiffness))?;
        }
        at("friction", at_least(0.0, "it", self.keys.friction))?;
        at("restitution", share("it", self.keys.restitution))
    }
}

/// Creates the skin of a point of a rigid body, or of a fluid, of this mass (kg) and thickness (m),
/// that suits this gravity (m/s2).
pub(super) fn point_skin(
    keys: SkinKeys,
    gravity: f64,
    [mass, thickness]: [f64; 2],
) -> Result<Skin, Fault> {
    let thick = Some(thickness);
    let keys = SkinKeys {
        thickness: thick,
        ..keys
    };
    let spec = SkinSpec {
        keys,
        stiffness: 0.0,
        time: 0.0,
        gravity,
    };
    spec.check()?;
    Ok(Skin {
        damping: POINT_DAMPING / (spec.acceleration() * thickness).sqrt(),
        ..spec.skin(mass, thickness)
    })
}
