//! Mode of motion.

/// Rate of growth of a mode, over its frequency, that may be an error of differences of forces.
const ROUNDING: f64 = 1e-6;
/// Distance of an eigenvalue from that of the feedback of constraints, over its size, below which
/// it is that one: differences of forces split a double eigenvalue.
const FEEDBACK_SHARE: f64 = 0.05;

/// Mode of motion x'' = -stiffness x - (drag + damping) x'.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mode {
    /// Stiffness over mass, the angular frequency squared (1/s2).
    pub stiffness: f64,
    /// Viscous drag over mass (1/s).
    pub drag: f64,
    /// Damping of the springs over mass (1/s).
    pub damping: f64,
    /// Whether forces other than drag depend on velocities in the system, even if not in this mode:
    /// splitting methods then use other kicks.
    pub reads_velocity: bool,
}

impl Mode {
    /// Creates a mode with the eigenvalue re + i im (1/s) and its conjugate, damped by drag.
    #[must_use]
    pub fn of_eigenvalue(re: f64, im: f64) -> Self {
        Self {
            stiffness: re * re + im * im,
            drag: -2.0 * re,
            ..Self::default()
        }
    }

    /// Returns the angular frequency w of the undamped mode (rad/s); 0 for negative stiffness.
    #[must_use]
    pub fn frequency(&self) -> f64 {
        self.stiffness.max(0.0).sqrt()
    }

    /// Returns whether the mode has a restoring force and does not grow by itself, except by
    /// rounding.
    #[must_use]
    pub fn returns(&self) -> bool {
        self.stiffness > 0.0 && self.drag + self.damping >= -ROUNDING * self.frequency()
    }

    /// Returns both eigenvalues as [re, im] (1/s).
    #[must_use]
    pub fn eigenvalues(&self) -> [[f64; 2]; 2] {
        let half = 0.5 * (self.drag + self.damping);
        let square = half * half - self.stiffness;
        if square < 0.0 {
            let im = (-square).sqrt();
            [[-half, im], [-half, -im]]
        } else {
            let root = square.sqrt();
            [[-half + root, 0.0], [-half - root, 0.0]]
        }
    }
}

/// Returns the fastest mode that returns, of modes in this order. The feedback that reduces errors
/// of constraints, of this natural frequency (rad/s), is no motion: its modes are left out.
#[must_use]
pub fn fastest(modes: &[Mode], feedback: Option<f64>) -> Option<&Mode> {
    let is_feedback = |mode: &Mode| {
        let near = |w: f64| {
            let [[re, im], _] = mode.eigenvalues();
            (re + w).hypot(im) < FEEDBACK_SHARE * w
        };
        feedback.is_some_and(near)
    };
    modes
        .iter()
        .find(|mode| mode.returns() && !is_feedback(mode))
}

/// Sorts modes, the fastest first.
pub(super) fn sort(modes: &mut [Mode]) {
    modes.sort_by(|a, b| b.stiffness.total_cmp(&a.stiffness));
}
