//! Depths of penetration into obstacles that steps distinguish.

use nalgebra::Vector3;

use crate::control::Control;
use crate::scene::StepLimits;

/// Largest depth, over the scene's radius, to which a step of an adaptive method may take a
/// particle into an obstacle. States between the ends of the step are shown as they are, and at
/// this depth nobody sees that a particle sinks in.
const MAX_PENETRATION: f64 = 1e-3;

/// Share of a length of the scene below which a distance counts as zero.
pub(super) const NEGLIGIBLE_SHARE: f64 = 1e-9;

/// Way in which a motion that counts as rest ends, over the tolerated error. If it were larger,
/// users would see particles stop; if smaller, particles that friction has nearly stopped would
/// creep on, in tiny steps.
const STILL_SHARE: f64 = 1e-2;

/// Height of a rebound that may be a rounding error, over the distance from the origin and the
/// radius of the scene.
const ROUNDING_SHARE: f64 = 1e-14;

/// Depths into an obstacle, and heights above it (m).
#[derive(Clone, Copy, Debug)]
pub(super) struct Depths {
    /// Distance from an obstacle that counts as zero.
    pub none: f64,
    /// Depth within an adaptive method's tolerance: a particle that ends a step less deep than this
    /// needs no event.
    pub shallow: f64,
    /// Largest depth to which a step of an adaptive method may take a particle.
    pub deepest: f64,
    /// Radius of the scene.
    radius: f64,
}

impl Depths {
    /// Creates the depths for steps under a control, in a scene of that radius (m).
    pub fn new(radius: f64, limits: StepLimits, control: Control) -> Self {
        let relative = control.tolerance().unwrap_or(0.0);
        let absolute = limits.absolute.unwrap_or(relative * radius);
        let deepest = MAX_PENETRATION * radius;
        Self { none: NEGLIGIBLE_SHARE * radius, shallow: absolute.min(deepest), deepest, radius }
    }

    /// Returns the way (m) in which friction stops a slide that counts as rest.
    pub fn still(&self) -> f64 {
        STILL_SHARE * self.none.max(self.shallow)
    }

    /// Returns the height (m) up to which a rebound from an obstacle of that restitution, at a
    /// place (m), is left out, with all that follow it.
    ///
    /// A rebound at the speed u to the height H = u^2 / 2 p, under an acceleration p, is followed
    /// by others at e u, e^2 u, ... All of them end after T = 2 u / (p (1 - e)), and until then
    /// nothing moves farther than u T = 4 H / (1 - e) from where it would be without them.
    pub fn left_out(&self, restitution: f64, place: Vector3<f64>) -> f64 {
        let height = 0.25 * (1.0 - restitution) * STILL_SHARE * self.shallow;
        height.max(ROUNDING_SHARE * (place.norm() + self.radius))
    }
}
