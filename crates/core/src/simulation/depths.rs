//! Depths into obstacles that a step tells apart.

use crate::control::Control;
use crate::scene::StepLimits;

/// Largest depth, as a share of the scene's radius, to which a step of an adaptive method may take
/// a particle into an obstacle: a state between the ends of the step is shown as it is, and must
/// not sink visibly.
const MAX_PENETRATION: f64 = 1e-3;

/// Share of a length of the scene that counts as none of it.
pub(super) const NEGLIGIBLE_SHARE: f64 = 1e-9;

/// Depths into an obstacle (m).
#[derive(Clone, Copy, Debug)]
pub(super) struct Depths {
    /// Distance from an obstacle that counts as none.
    pub none: f64,
    /// Depth that an adaptive method's tolerance allows a particle that comes to an obstacle within
    /// a step: it needs no event.
    pub shallow: f64,
    /// Largest depth to which a step of an adaptive method may take a particle.
    pub deepest: f64,
}

impl Depths {
    /// Depths for a step with that control in a scene of that radius (m).
    pub fn new(radius: f64, limits: StepLimits, control: Control) -> Self {
        let relative = control.tolerance().unwrap_or(0.0);
        let absolute = limits.absolute.unwrap_or(relative * radius);
        let deepest = MAX_PENETRATION * radius;
        Self {
            none: NEGLIGIBLE_SHARE * radius,
            shallow: absolute.min(deepest),
            deepest,
        }
    }
}
