//! Errors of states, and the scope in which they are taken.

use crate::error::Error;
use crate::scene::Model;

/// Particles and times at which errors are taken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Scope {
    /// The only particle whose position and phase count; `None` for all of them, or for all numbers
    /// of a state without particles.
    pub particle: Option<usize>,
    /// Whether only the last frame counts, instead of the largest error of all frames.
    pub at_end: bool,
}

impl Scope {
    /// Checks that the only particle that counts, if there is one, is among this number of
    /// particles.
    pub(super) fn check(self, particles: usize) -> Result<(), Error> {
        match self.particle {
            Some(i) if i >= particles => Err(Error::Invalid(match particles.checked_sub(1) {
                Some(last) => {
                    format!("there is no particle {i}: the scene has particles 0 to {last}")
                }
                None => format!("there is no particle {i}: the scene has plain numbers"),
            })),
            _ => Ok(()),
        }
    }
}

/// Errors of a state, or the largest ones over the frames of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Root mean square over the particles of the distance from their reference positions (m); 0
    /// without particles.
    pub position: f64,
    /// Root mean square over the numbers of the state of their errors, where it has no particles; 0
    /// otherwise.
    pub state: f64,
    /// Absolute error of the total energy (J); 0 for a first-order scene.
    pub energy: f64,
    /// Root mean square over the structural springs of the error of length over rest length; 0
    /// without such springs.
    pub strain: f64,
    /// Length of the error of the total momentum of the particles that are not pinned (kg m/s); 0
    /// for a first-order scene.
    pub momentum: f64,
    /// Time (s) by which the run is ahead of the reference or behind it: the error of the positions
    /// along the reference velocities, over the largest speed squared of the reference. Without
    /// particles, those of the numbers of the state.
    pub phase: f64,
    /// Error of the penetration of surfaces in contact: the largest depth over the thickness. 0
    /// where surfaces do not touch.
    pub penetration: f64,
    /// Error of the first impact (s): the larger of the errors of its beginning and of its end. 0
    /// where surfaces do not touch.
    pub impact: f64,
}

impl Errors {
    /// Creates errors with the same value of each quantity.
    pub(super) fn with_all(error: f64) -> Self {
        let zero = Self::default();
        zero.with(zero, |_, _| error)
    }

    /// Applies a function to each quantity of both errors.
    fn with(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self {
            position: f(self.position, other.position),
            state: f(self.state, other.state),
            energy: f(self.energy, other.energy),
            strain: f(self.strain, other.strain),
            momentum: f(self.momentum, other.momentum),
            phase: f(self.phase, other.phase),
            penetration: f(self.penetration, other.penetration),
            impact: f(self.impact, other.impact),
        }
    }

    /// Returns the larger of both errors in each quantity; NaN is larger than any number.
    pub(super) fn max(self, other: Self) -> Self {
        self.with(other, |a, b| if a >= b || a.is_nan() { a } else { b })
    }

    /// Returns the smaller of both errors in each quantity.
    pub(super) fn min(self, other: Self) -> Self {
        self.with(other, f64::min)
    }

    /// Returns the error of the positions or, without particles, of the state.
    pub(super) fn of_coordinates(&self) -> f64 {
        // One of both is 0.
        self.position + self.state
    }
}

/// Choice of one of the [`Errors`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Metric {
    /// Error of the positions (m).
    #[default]
    Position,
    /// Error of the numbers of a state without particles, in their unit.
    State,
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
    /// Metrics of scenes with particles.
    pub const OF_PARTICLES: [Self; 7] = [
        Self::Position,
        Self::Energy,
        Self::Strain,
        Self::Momentum,
        Self::Phase,
        Self::Penetration,
        Self::Impact,
    ];

    /// Returns the name of the metric.
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
            Self::State => "state",
        }
    }

    /// Returns the metric of the motion of a model: the error of its positions or, without
    /// particles, of the numbers of its state.
    #[must_use]
    pub fn of_motion(model: &Model) -> Self {
        match model.particles() {
            0 => Self::State,
            _ => Self::Position,
        }
    }

    /// Checks that a model has particles, if the metric needs any, and none if it is for plain
    /// numbers.
    pub(super) fn check(self, model: &Model) -> Result<(), Error> {
        let why = match (self, model.particles()) {
            (Self::State | Self::Phase, 0) => return Ok(()),
            (_, 0) => {
                "the scene has no particles, but plain numbers: ask for the error of the state or \
                 of the phase"
            }
            (Self::State, _) => {
                "the scene has particles: ask for the error of their positions instead of that of \
                 the state"
            }
            _ => return Ok(()),
        };
        Err(Error::Invalid(why.into()))
    }

    /// Returns the error that the metric chooses, in its unit.
    #[must_use]
    pub fn of(self, errors: &Errors) -> f64 {
        match self {
            Self::Position => errors.position,
            Self::State => errors.state,
            Self::Energy => errors.energy,
            Self::Strain => errors.strain,
            Self::Momentum => errors.momentum,
            Self::Phase => errors.phase,
            Self::Penetration => errors.penetration,
            Self::Impact => errors.impact,
        }
    }
}
