//! Adaptive steps, as long as a method's error estimate stays within the tolerance (Hairer,
//! Norsett, Wanner, *Solving Ordinary Differential Equations I*, 1993, II.4).

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::error_norm::{BLOCK, ErrorNorm, Tolerance};
use super::integrator::check_dim;
use super::sweep::scaled_sum;
use super::trial::{LastStep, Trial};
use crate::error::{Error, at_least};
use crate::measure::Measure;
use crate::sums::{OnBlock, add_up};
use crate::system::{ParticleSystem, rigid_of, without_derivative};
use crate::threads::{Columns, copy, threads};
use crate::work::Work;

/// Shortest step, as a share of the time at which it begins or of the first trial step. If an
/// equation needs a shorter one, it has no solution, or the tolerance is too small for double
/// precision.
const MIN_STEP_SHARE: f64 = 1e-12;
/// Longest first step (s), and first step of a motion that starts from rest (s). Plain numbers that
/// change have a time of their own instead.
const FIRST_STEPS: (f64, f64) = (1e-2, 1e-6);
/// Least and greatest ratio of a step to the previous one.
const STEP_RATIOS: (f64, f64) = (0.2, 8.0);

/// Rounding error of an equation, over its largest number.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A step that an adaptive method took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Taken {
    /// Time at its beginning (s).
    pub t: f64,
    /// Length (s).
    pub h: f64,
    /// Cost, rejected attempts included.
    pub work: Work,
}

/// Memory of an adaptive method between steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AdaptiveState {
    /// Length to try next (s); 0 before the first step.
    next: f64,
    last: Taken,
    /// The largest size of each number so far, if any is plain.
    sizes: Vec<f64>,
    /// The last step, if the next one can start from its end.
    step: Option<LastStep>,
}

impl AdaptiveState {
    /// Checks that the lengths of its steps are possible.
    fn check(&self) -> Result<(), Error> {
        let Taken { t, h, .. } = self.last;
        let within = self.step.as_ref().map_or(0.0, |step| step.h);
        let is_length = |h: &&f64| **h == 0.0 || h.is_normal() && **h > 0.0;
        if let Some(h) = [self.next, h, within].iter().find(|h| !is_length(h)) {
            return Err(Error::Invalid(format!(
                "a step must be 0 or a positive number of seconds, not {h:e}"
            )));
        }
        for size in &self.sizes {
            at_least(0.0, "the size of a number so far", *size)?;
        }
        at_least(f64::MIN, "the beginning of the last step", t)
    }
}

/// An adaptive method, which estimates its error, with its tolerance.
///
/// Besides scratch it remembers the length of its last step, as the first guess for the next, and
/// the derivative at its end, which [`restart`](Self::restart) forgets.
///
/// A decay y' = -y to t = 1 and, by the polynomial of the last step, at a time within it:
///
/// ```
/// use a3_core::integrators::{self, Tolerance};
/// # use a3_core::ParticleSystem;
/// # struct Decay;
/// # impl ParticleSystem for Decay {
/// #     fn dim(&self) -> usize { 1 }
/// #     fn eval_f(&self, _t: f64, y: &[f64], dydt: &mut [f64]) { dydt[0] = -y[0]; }
/// # }
///
/// let dopri5 = integrators::find("dopri5").unwrap();
/// let mut adaptive = dopri5.adaptive(&Decay, Tolerance::new(1e-8)?).unwrap();
/// let (mut t, mut y) = (0.0, [1.0]);
/// while t < 1.0 {
///     t += adaptive.advance(&Decay, t, 1.0 - t, &mut y)?.h;
/// }
/// assert!((y[0] - f64::exp(-1.0)).abs() < 1e-8);
/// adaptive.interpolate(&Decay, 0.95, &mut y);
/// assert!((y[0] - f64::exp(-0.95)).abs() < 1e-8);
/// # Ok::<(), a3_core::Error>(())
/// ```
pub struct Adaptive {
    trial: Box<dyn Trial>,
    tolerance: Tolerance,
    /// The length to try next (s); 0 before the first step.
    next: f64,
    last: Taken,
    /// The largest size of each number so far; empty if none is plain.
    sizes: Vec<f64>,
    /// Whether the next step can start from the end of the last one.
    can_continue: bool,
    /// Scratch of the first step: f, a state, and f there.
    first: [Vec<f64>; 3],
}

/// Returns whether two states are equal, except for particles on rigid bodies, which follow from
/// the rest.
fn is_same(system: &dyn ParticleSystem, a: &[f64], b: &[f64]) -> bool {
    match rigid_of(system) {
        None => {
            let bands = threads(a.len() / 6);
            add_up(bands, 0..a.len(), BLOCK, [], &Different(a, b)) == [0.0]
        }
        Some(rigid) => (0..a.len()).all(|k| a[k] == b[k] || rigid.is_carried(k)),
    }
}

/// Counts the numbers that differ.
struct Different<'a>(&'a [f64], &'a [f64]);

impl OnBlock<0, 1> for Different<'_> {
    #[expect(
        clippy::inline_always,
        reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found"
    )]
    #[inline(always)]
    fn run(&self, numbers: Range<usize>, []: Columns<0>) -> [f64; 1] {
        let pairs = self.0[numbers.clone()].iter().zip(&self.1[numbers]);
        [pairs.filter(|(a, b)| a != b).count() as f64]
    }
}

impl Adaptive {
    pub(super) fn new(trial: Box<dyn Trial>, tolerance: Tolerance) -> Self {
        let first = [(); 3].map(|()| vec![0.0; trial.dim()]);
        Self {
            trial,
            tolerance,
            next: 0.0,
            last: Taken::default(),
            sizes: vec![],
            can_continue: false,
            first,
        }
    }

    /// Returns the last step.
    #[must_use]
    pub fn last(&self) -> Taken {
        self.last
    }

    /// Returns the memory of the method: all of it, or without the `stages` of the last step; then
    /// it [restarts](Self::restart).
    #[must_use]
    pub fn state(&self, stages: bool) -> AdaptiveState {
        AdaptiveState {
            next: self.next,
            last: self.last,
            sizes: self.sizes.clone(),
            step: (stages && self.can_continue).then(|| self.trial.last()),
        }
    }

    /// Continues with a saved memory of the same method.
    ///
    /// # Errors
    /// The state is of another method or of another system, or the length of its step is
    /// impossible; nothing changes then.
    pub fn resume(&mut self, state: &AdaptiveState) -> Result<(), Error> {
        state.check()?;
        if ![0, self.trial.dim()].contains(&state.sizes.len()) {
            return Err(Error::Invalid("the sizes are of another system".into()));
        }
        if let Some(step) = &state.step {
            self.trial.resume(step)?;
        }
        (self.next, self.last) = (state.next, state.last);
        self.sizes.clone_from(&state.sizes);
        self.can_continue = state.step.is_some();
        Ok(())
    }

    /// Tries a step of h (s) next.
    pub fn try_first(&mut self, h: f64) {
        self.next = h;
    }

    /// Tries a step of at most h (s) next.
    pub fn try_at_most(&mut self, h: f64) {
        self.next = self.next.min(h);
    }

    /// Forgets everything that depends on the system and the state. To be called when either
    /// changes between steps.
    pub fn restart(&mut self) {
        self.can_continue = false;
    }

    /// Advances y from t by one step of at most `longest` (s).
    ///
    /// # Errors
    /// The state and the system differ in length; a force depends on the velocity, and the method
    /// does not support that; f is not finite at y, or the system reports a failure of its own; or
    /// no step that advances the time meets the tolerance. y then stays as it was.
    pub fn advance(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        longest: f64,
        y: &mut [f64],
    ) -> Result<Taken, Error> {
        check_dim(self.trial.dim(), y)?;
        self.trial.check(system)?;
        let mut work = Work::default();
        // Contact may have changed y after the last step: then f must be evaluated again.
        if !self.can_continue {
            work += self.trial.begin(system, t, y);
        } else if is_same(system, self.trial.end(), y) {
            self.trial.start_from_end();
        } else {
            work += self.trial.begin_again(system, t, y);
        }
        self.can_continue = false;
        self.see(system, y);
        let sizes = std::mem::take(&mut self.sizes);
        let taken = self.within(system, (t, longest), y, (&sizes, work));
        self.sizes = sizes;
        taken
    }

    /// Remembers the sizes of plain numbers in a state.
    fn see(&mut self, system: &dyn ParticleSystem, y: &[f64]) {
        let sizes = &mut self.sizes;
        system.measures(&mut |numbers, measure| {
            if measure == Measure::Plain {
                sizes.resize(y.len(), 0.0);
                for k in numbers {
                    sizes[k] = sizes[k].max(y[k].abs());
                }
            }
        });
        let largest = y.iter().fold(0.0_f64, |most, y| most.max(y.abs()));
        let least = ROUNDING / self.tolerance.relative * largest;
        for k in without_derivative(system) {
            sizes[k] = sizes[k].max(least);
        }
    }

    /// Advances y from t by one step of at most `longest` (s) that was begun, where numbers have
    /// had these sizes.
    fn within(
        &mut self,
        system: &dyn ParticleSystem,
        (t, longest): (f64, f64),
        y: &mut [f64],
        (sizes, mut work): (&[f64], Work),
    ) -> Result<Taken, Error> {
        let mut norm = ErrorNorm { system, tolerance: self.tolerance, sizes, h: self.next };
        if norm.h == 0.0 {
            norm.h = self.first_step(t, y, &norm);
            work += Work::of(1);
        }
        let shortest = MIN_STEP_SHARE * norm.h.max(t.abs());
        let wanted = norm.h;
        norm.h = wanted.min(longest);
        loop {
            // The shortest step is also tried.
            norm.h = norm.h.max(shortest.min(longest));
            let h = norm.h;
            let (cost, error) = self.trial.attempt(system, t, h, &norm);
            work += cost;
            let change = self.trial.change(error);
            if error <= 1.0 {
                copy(self.trial.end(), y);
                // After a rejection, the next step is not longer than this one.
                let most = if work.rejections > 0 { 1.0 } else { STEP_RATIOS.1 };
                self.next = h * change.clamp(STEP_RATIOS.0, most);
                if h == longest {
                    // It was shortened by `longest`, not because of its error.
                    self.next = self.next.max(wanted);
                }
                self.last = Taken { t, h, work };
                self.can_continue = true;
                return Ok(self.last);
            }
            work.rejections += 1;
            if let Some(failure) = system.take_failure() {
                self.next = 0.0;
                return Err(failure);
            }
            self.trial.check(system)?;
            if h <= shortest.min(longest) || !error.is_finite() {
                let f = &mut self.first[0];
                self.trial.derivative(system, f);
                let undefined = f.iter().position(|f| !f.is_finite());
                let failure = match undefined {
                    Some(component) => Some(Error::NotFinite { time: t, component }),
                    None => (h <= shortest.min(longest))
                        .then_some(Error::StepTooSmall { time: t, step: h }),
                };
                if let Some(failure) = failure {
                    // Makes the next attempt guess the first step again.
                    self.next = 0.0;
                    return Err(failure);
                }
            }
            // NaN counts as the worst error.
            norm.h *= if change >= STEP_RATIOS.0 { change } else { STEP_RATIOS.0 };
        }
    }

    /// Writes the state at a time (s) within the last step to `out`. Returns the work, which is 0
    /// from the second call within a step on.
    pub fn interpolate(&mut self, system: &dyn ParticleSystem, time: f64, out: &mut [f64]) -> Work {
        let Taken { t, h, .. } = self.last;
        self.trial.interpolate(system, t, (time - t) / h, out)
    }

    /// Guesses the first step (s), from the times in which f and, estimated by a step of Euler's
    /// method, its derivative change the state.
    fn first_step(&mut self, t: f64, y: &[f64], norm: &ErrorNorm) -> f64 {
        let (system, [f0, y1, f1]) = (norm.system, &mut self.first);
        self.trial.derivative(system, f0);
        let slope = norm.time_scale(y, f0, 1);
        if slope.is_nan() {
            return FIRST_STEPS.0;
        }
        let longest =
            if slope.is_finite() && !norm.sizes.is_empty() { slope } else { FIRST_STEPS.0 };
        let h = (0.01 * slope).min(longest);
        if let Some(second) = self.trial.second_derivative() {
            f1.copy_from_slice(second);
        } else {
            scaled_sum(y1, y, h, f0);
            system.eval_f(t + h, y1, f1);
            for (f1, f0) in f1.iter_mut().zip(f0) {
                *f1 = (*f1 - *f0) / h;
            }
        }
        let bend = norm.time_scale(y, f1, 2);
        let time = slope.min(bend);
        if time == f64::INFINITY {
            return FIRST_STEPS.1;
        }
        let least = 0.01 * self.tolerance.relative;
        (time * libm::pow(least, 1.0 / self.trial.exponent())).min(longest)
    }
}
