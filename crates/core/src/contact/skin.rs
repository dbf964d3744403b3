//! Contact materials, and the law of contact between two primitives.

use crate::error::{Error, at_least, share};

/// Least gap that is kept between two surfaces, as a share of their thickness.
pub(super) const KEPT_SHARE: f64 = 1e-3;

/// Share of its energy that a pair without restitution would keep because its force changes over a
/// range of speeds: computed by quadrature, for one and for four points of a body.
pub(super) const TURNING_LOSS: f64 = 0.035;

/// Contact material of a surface. Where two surfaces meet, the thickness and the damping are the
/// means of theirs, the stiffness is the smaller one, and the frictions and the restitution are the
/// larger ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Skin {
    /// Distance up to which two such surfaces repel each other (m).
    pub thickness: f64,
    /// Stiffness k of their repulsion (N/m).
    pub stiffness: f64,
    /// Damping coefficient of their repulsion: one over the speed at which damping is fully
    /// effective (s/m).
    pub damping: f64,
    /// Coefficient mu of Coulomb friction.
    pub friction: f64,
    /// Coefficient of rolling friction of a rigid body (m): the largest torque that resists its
    /// turn where it touches, over the force along the normal.
    pub rolling: f64,
    /// Coefficient e of restitution, from 0 to 1. If it is above 0, it replaces damping.
    pub restitution: f64,
    /// Effective mass of one of its points in an impact (kg), if it is rigid or has a restitution.
    pub mass: f64,
}

impl Skin {
    /// Checks the numbers of the skin.
    ///
    /// # Errors
    /// A number is negative or not finite, or the restitution is above 1.
    pub(crate) fn check(&self) -> Result<(), Error> {
        at_least(0.0, "a thickness", self.thickness)?;
        at_least(0.0, "the stiffness of contact", self.stiffness)?;
        at_least(0.0, "the damping of contact", self.damping)?;
        at_least(0.0, "a friction", self.friction)?;
        at_least(0.0, "a rolling friction", self.rolling)?;
        share("a restitution", self.restitution)?;
        at_least(0.0, "the mass of a point of a surface", self.mass)
    }
}

/// Contact law between the two primitives of a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Law {
    /// Their skin.
    pub skin: Skin,
    /// Sum of the radii of round obstacles and bodies, whose interior is solid (m).
    pub radius: f64,
    /// Speed of an approach that the repulsion stops at gap 0 (m/s), if a side is rigid or elastic.
    pub stopped: f64,
    /// Whether both sides are hard, with less restitution than the repulsion can have: they have an
    /// impact where it begins.
    pub is_dull: bool,
    /// Coefficient of restitution of their impacts. That of their skin, by which the repulsion
    /// follows, is 0 if they are dull.
    pub restitution: f64,
}

impl Law {
    /// Returns the largest distance that the pair keeps (m).
    pub fn max_kept(&self) -> f64 {
        self.radius + KEPT_SHARE * self.skin.thickness
    }

    /// Returns the distance (m) from which on the sides repel each other.
    pub fn range(&self) -> f64 {
        self.radius + self.skin.thickness
    }

    /// Returns the distance that the pair keeps (m), which is less than its distance at first; a
    /// pair within a round body keeps the distance that it has.
    pub fn kept(&self, distance: f64) -> f64 {
        let room = distance - self.radius;
        self.radius + (KEPT_SHARE * self.skin.thickness).min(0.9 * room).min(room)
    }
}
