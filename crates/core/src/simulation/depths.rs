//! Depths of penetration into obstacles that steps distinguish.

use crate::control::Control;
use crate::scene::StepLimits;

/// Largest depth, over the scene's radius, to which a step of an adaptive method may take a
/// particle into an obstacle. States between the ends of the step are shown as they are, and at
/// this depth nobody sees that a particle sinks in.
const MAX_PENETRATION: f64 = 1e-3;

/// Share of a length of the scene below which a distance counts as zero.
pub(super) const NEGLIGIBLE_SHARE: f64 = 1e-9;

/// Depths into an obstacle (m).
#[derive(Clone, Copy, Debug)]
pub(super) struct Depths {
    /// Distance from an obstacle that counts as zero.
    pub none: f64,
    /// Depth within an adaptive method's tolerance: a particle that ends a step less deep than this
    /// needs no event.
    pub shallow: f64,
    /// Largest depth to which a step of an adaptive method may take a particle.
    pub deepest: f64,
}

impl Depths {
    /// Creates the depths for steps under a control, in a scene of that radius (m).
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
