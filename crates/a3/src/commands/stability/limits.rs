//! The limits of methods on a scene.

use a3_core::Method;
use a3_core::stability::{Limit, Mode, Motion, Observation, RestState};

/// Measurements of a scene.
pub struct Found {
    /// Limits of each method.
    pub rows: Vec<MethodLimits>,
    /// Accurate motion from the start.
    pub motion: Motion,
    /// State of rest, if the scene has one.
    pub hanging: Option<RestState>,
    /// Modes at the start.
    pub at_start: Vec<Mode>,
}

/// Limits of a method.
#[derive(Clone, Copy)]
pub struct MethodLimits {
    pub method: &'static Method,
    /// Limit by the modes at rest, if the scene comes to rest.
    pub rest: Option<Limit>,
    /// Step at which a disturbance at rest grew tenfold in runs.
    pub seen_at_rest: Option<Observation>,
    /// Step up to which runs from the start stay bounded.
    pub bounded: Option<Observation>,
    /// Largest step of an accurate run (s).
    pub accurate: Option<f64>,
    /// Whether the work limit made runs shorter or fewer than usual.
    pub is_short: bool,
}
