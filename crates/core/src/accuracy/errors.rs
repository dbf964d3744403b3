//! Errors of states, and which of them count.

/// Particles and times at which errors are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Scope {
    /// The only particle whose position and phase count; `None` for all of them.
    pub particle: Option<usize>,
    /// Whether only the last frame counts, instead of the largest error of all frames.
    pub at_end: bool,
}

/// Errors of a state, or the largest ones over the frames of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Root mean square over the particles of the distance from their reference positions (m).
    pub position: f64,
    /// Absolute error of the total energy (J); 0 for a first-order scene.
    pub energy: f64,
    /// Root mean square over the structural springs of the error of length over rest length; 0
    /// without such springs.
    pub strain: f64,
    /// Length of the error of the total momentum of the particles that are not pinned (kg m/s); 0
    /// for a first-order scene.
    pub momentum: f64,
    /// Time (s) by which the run is ahead of the reference or behind it: the error of the positions
    /// along the reference velocities, over the largest speed squared of the reference.
    pub phase: f64,
    /// Error of the penetration of surfaces that touch: the largest share of its thickness by which
    /// anything is within it. 0 where surfaces do not touch.
    pub penetration: f64,
    /// Error of the first impact (s): that of the time at which surfaces first touch, or that at
    /// which nothing touches any more, whichever is larger. 0 where surfaces do not touch.
    pub impact: f64,
}

impl Errors {
    /// Errors that are all the same.
    pub(super) fn with_all(error: f64) -> Self {
        let zero = Self::default();
        zero.with(zero, |_, _| error)
    }

    /// Result of a function of each quantity of both errors.
    fn with(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self {
            position: f(self.position, other.position),
            energy: f(self.energy, other.energy),
            strain: f(self.strain, other.strain),
            momentum: f(self.momentum, other.momentum),
            phase: f(self.phase, other.phase),
            penetration: f(self.penetration, other.penetration),
            impact: f(self.impact, other.impact),
        }
    }

    /// Larger of both errors in each quantity; NaN is larger than any number.
    pub(super) fn max(self, other: Self) -> Self {
        self.with(other, |a, b| if a >= b || a.is_nan() { a } else { b })
    }

    /// Smaller of both errors in each quantity.
    pub(super) fn min(self, other: Self) -> Self {
        self.with(other, f64::min)
    }
}

/// Choice of one of the [`Errors`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Metric {
    /// Error of the positions (m).
    #[default]
    Position,
    /// Error of the total energy (J).
    Energy,
    /// Error of length over rest length.
    Strain,
    /// Error of the total momentum (kg m/s).
    Momentum,
    /// Error of the phase (s).
    Phase,
    /// Error of the penetration of surfaces, as a share of the thickness.
    Penetration,
    /// Error of the times of the first impact (s).
    Impact,
}

impl Metric {
    /// All metrics.
    pub const ALL: [Self; 7] = [
        Self::Position,
        Self::Energy,
        Self::Strain,
        Self::Momentum,
        Self::Phase,
        Self::Penetration,
        Self::Impact,
    ];

    /// Name of the metric.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Energy => "energy",
            Self::Strain => "strain",
            Self::Momentum => "momentum",
            Self::Phase => "phase",
            Self::Penetration => "penetration",
            Self::Impact => "impact",
        }
    }

    /// Error that the metric chooses, in its unit.
    #[must_use]
    pub fn of(self, errors: &Errors) -> f64 {
        match self {
            Self::Position => errors.position,
            Self::Energy => errors.energy,
            Self::Strain => errors.strain,
            Self::Momentum => errors.momentum,
            Self::Phase => errors.phase,
            Self::Penetration => errors.penetration,
            Self::Impact => errors.impact,
        }
    }
}
