//! Mode of motion, the operators of stiffness and damping over mass on the shapes of modes, and
//! the largest step that runs have shown to hold.

use crate::random::SplitMix;
use crate::system::{Linearized, kick_reads_velocity};

/// Rate of growth of a mode, over its frequency, that may be an error of differences of forces.
const ROUNDING: f64 = 1e-6;
/// Stiffness of a mode over its damping squared, up to which damping alone acts: what returns does
/// so a million million times more slowly than a push decays.
const WEAKEST_SHARE: f64 = 1e-12;
/// Distances of eigenvalues from that of the feedback of constraints, over its size: below the
/// first one, an eigenvalue is that one. Rounding splits a multiple eigenvalue up to the second one
/// (0.43 for a chain of rods), but leaves the mean of its parts.
const FEEDBACK_SHARES: [f64; 2] = [0.05, 0.6];

/// Mode of motion x'' = -stiffness x - (drag + damping) x'.
///
/// ```
/// use a3_core::stability::Mode;
///
/// // A mass on a spring of 4 N/m/kg with a quarter of the critical damping.
/// let mode = Mode { stiffness: 4.0, damping: 1.0, ..Mode::default() };
/// assert_eq!((mode.frequency(), mode.damping_ratio()), (2.0, 0.25));
/// assert_eq!(mode.eigenvalues()[0][0], -0.5);
/// ```
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
        Self { stiffness: re * re + im * im, drag: -2.0 * re, ..Self::default() }
    }

    /// Returns the angular frequency w of the undamped mode (rad/s); 0 for negative stiffness.
    #[must_use]
    pub fn frequency(&self) -> f64 {
        self.stiffness.max(0.0).sqrt()
    }

    /// Returns the damping over that at which a push no longer swings back; NaN without stiffness.
    #[must_use]
    pub fn damping_ratio(&self) -> f64 {
        0.5 * (self.drag + self.damping) / self.frequency()
    }

    /// Returns whether the mode has a restoring force and does not grow by itself, except by
    /// rounding.
    #[must_use]
    pub fn returns(&self) -> bool {
        self.stiffness > 0.0 && self.drag + self.damping >= -ROUNDING * self.frequency()
    }

    /// Returns the mode by whose growth steps are judged: this one, unless it falls, buckles or
    /// flutters by any method. Where damping alone acts, it has a restoring force that hardly does:
    /// a push then decays as fast as the damping says.
    #[must_use]
    pub fn judged(&self) -> Option<Self> {
        let damping = self.drag + self.damping;
        let weakest = WEAKEST_SHARE * damping * damping;
        let decays = damping > 0.0 && self.stiffness.abs() <= weakest;
        let stiffness = if decays { weakest } else { self.stiffness };
        Some(Self { stiffness, ..*self }).filter(Self::returns)
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
    let is_near = |mode: &Mode, share: f64| {
        let [[re, im], _] = mode.eigenvalues();
        feedback.is_some_and(|w| (re + w).hypot(im) < share * w)
    };
    let [close, split] = FEEDBACK_SHARES;
    let parts = || modes.iter().filter(|mode| is_near(mode, split));
    let sum = parts().map(|mode| mode.eigenvalues()[0][0]).sum::<f64>();
    let mean = Mode::of_eigenvalue(sum / parts().count() as f64, 0.0);
    let share = if is_near(&mean, close) { split } else { close };
    let is_feedback = |mode: &Mode| is_near(mode, share);
    modes.iter().find(|mode| mode.returns() && !is_feedback(mode))
}

/// Sorts modes, the fastest first.
pub(super) fn sort(modes: &mut [Mode]) {
    modes.sort_by(|a, b| b.stiffness.total_cmp(&a.stiffness));
}

/// Part of a shape's damping that acts on other shapes, over the part that acts on its own, from
/// which on damping counts as mixing shapes.
pub(super) const MIN_MIXING: f64 = 0.02;
/// The same part, over the frequency, from which on damping counts as mixing shapes strongly: it
/// changes the frequency by about a percent.
const MIN_STRONG_MIXING: f64 = 0.1;

/// Degree to which damping couples a shape of the undamped motion to others.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub(super) enum Mixing {
    /// Each shape has its own damping.
    #[default]
    None,
    /// The damping of a shape depends on others.
    Weak,
    /// The frequency depends on others, too.
    Strong,
}

/// Mass-normalised stiffness M^-1/2 K M^-1/2 and damping M^-1/2 D M^-1/2 at the positions x, as
/// operators. The modes are those at zero velocity.
pub(super) struct Normalised<'a> {
    mechanics: &'a dyn Linearized,
    t: f64,
    x: &'a [f64],
    zero: Vec<f64>,
    scaled: Vec<f64>,
}

impl<'a> Normalised<'a> {
    pub fn new(mechanics: &'a dyn Linearized, t: f64, x: &'a [f64]) -> Self {
        Self { mechanics, t, x, zero: vec![0.0; x.len()], scaled: vec![0.0; x.len()] }
    }

    /// Replaces z by M^-1/2 z.
    fn scale(&self, z: &mut [f64]) {
        let w = self.mechanics.inverse_masses();
        for column in z.chunks_exact_mut(w.len()) {
            for (z, w) in column.iter_mut().zip(w) {
                *z *= w.sqrt();
            }
        }
    }

    /// Computes out = K z, or D z if `damping` is set, both mass-normalised.
    pub fn product(&mut self, z: &[f64], damping: bool, out: &mut [f64]) {
        let mut scaled = std::mem::take(&mut self.scaled);
        scaled.copy_from_slice(z);
        self.scale(&mut scaled);
        let (dx, dv) = if damping { (&self.zero, &scaled) } else { (&scaled, &self.zero) };
        self.mechanics.force_differential(self.t, self.x, &self.zero, dx, dv, out);
        self.scaled = scaled;
        self.scale(out);
        for out in out {
            *out = -*out;
        }
    }

    /// Returns the drag over mass of the mode of shape z (1/s).
    fn drag(&self, z: &[f64]) -> f64 {
        let w = self.mechanics.inverse_masses();
        let share = z
            .chunks_exact(w.len())
            .flat_map(|z| z.iter().zip(w).map(|(z, w)| z * z * w))
            .sum::<f64>();
        self.mechanics.drag_coefficient() * share
    }

    /// Returns the mode of shape z and of this stiffness over mass (1/s2), and the degree to which
    /// damping couples z to other shapes.
    pub fn mode(&mut self, stiffness: f64, z: &[f64], scratch: &mut [f64]) -> (Mode, Mixing) {
        self.product(z, true, scratch);
        let drag = self.drag(z);
        let all = dot(z, scratch);
        let turned = (dot(scratch, scratch) - all * all).max(0.0).sqrt();
        // Without damped springs both terms are equal up to rounding.
        let damping = all - drag;
        let mode = Mode {
            stiffness,
            drag,
            damping: if damping > 1e-9 * drag { damping } else { 0.0 },
            reads_velocity: kick_reads_velocity(self.mechanics),
        };
        let mixing = if turned > MIN_STRONG_MIXING * stiffness.abs().sqrt()
            && turned > MIN_MIXING * all.abs()
        {
            Mixing::Strong
        } else if turned > MIN_MIXING * all.abs() {
            Mixing::Weak
        } else {
            Mixing::None
        };
        (mode, mixing)
    }

    /// Returns a random shape of length 1, which has a component along every mode.
    pub fn any_shape(&self) -> Vec<f64> {
        let mut random = SplitMix(1);
        let free = self.mechanics.inverse_masses();
        let mut z: Vec<_> = (0..self.x.len())
            .map(|k| {
                let z = random.between(-1.0, 1.0);
                if free[k % free.len()] == 0.0 { 0.0 } else { z }
            })
            .collect();
        normalise(&mut z);
        z
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Scales z to length 1 and returns its former length.
pub(super) fn normalise(z: &mut [f64]) -> f64 {
    let length = dot(z, z).sqrt();
    if length > 0.0 {
        for z in z {
            *z /= length;
        }
    }
    length
}

/// Limit of the step, found by runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Longest step that held (s).
    pub held: f64,
    /// Shortest step that failed (s); infinite if none did. If it is shorter than the longest that
    /// held, some steps between them hold and some fail.
    pub failed: f64,
    /// Number of runs that the search took.
    pub runs: u32,
}

/// Largest ratio of the shortest step that failed to the longest that held, for a sharp limit.
const MAX_SHARP_RATIO: f64 = 1.1;

impl Observation {
    /// Returns whether no run failed: even the longest trial step held.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.failed.is_infinite()
    }

    /// Returns whether all shorter trial steps held and all longer ones failed.
    #[must_use]
    pub fn is_sharp(&self) -> bool {
        (1.0..MAX_SHARP_RATIO).contains(&(self.failed / self.held))
    }

    /// Returns the step below which all trials held, and the step above which all failed (s).
    #[must_use]
    pub fn interval(&self) -> [f64; 2] {
        [self.held.min(self.failed), self.held.max(self.failed)]
    }
}
