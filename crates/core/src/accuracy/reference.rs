//! Reference solution of a scene, and its uncertainty.
//!
//! The reference is a run of DOP853 at a tight tolerance. It is compared with a run of DOP853 at a
//! tolerance ten times as large, and with a method of another family at the steps h, h/2, h/4, ...,
//! extrapolated to zero step (Richardson; Hairer, Norsett, Wanner, *Solving Ordinary Differential
//! Equations I*, 1993, II.9). That method is PEFRL, or the classical Runge-Kutta method where
//! forces depend on the velocity. Fixed steps are too long for the onset of friction, where
//! particles rest and slide on obstacles, and for the events of plain numbers, such as two stars
//! that pass each other closely: there it is Verner's pair at smaller and smaller tolerances. Its
//! disagreement with the reference is the uncertainty: two tolerances of one method may share an
//! error, two families do not. For a stiff system, the reference is a run of Radau IIA, and the
//! other method is BDF at smaller and smaller tolerances.

use std::borrow::Cow;

use super::frames::{Frames, GoOn};
use super::run::{EnclosingStep, FrameState, run};
use super::snapshot::{Errors, Metric, Scope, Snapshot};
use super::trajectory::Trajectory;
use crate::control::Control;
use crate::error::Error;
use crate::integrators::{Method, Work, find};
use crate::scene::{Model, Scene};
use crate::simulation::{Simulation, may_rest};
use crate::stability::{LargestMode, Mode, accurate, is_stiff, largest_step, spectrum};
use crate::system::Mechanics;

/// Largest and smallest tolerance of the reference. Below the smallest, rounding errors outweigh
/// the gain.
const TOLERANCES: (f64, f64) = (1e-6, 1e-12);
/// Ratio of the tolerance of the run that is compared with the reference to its own.
const RATIO: f64 = 10.0;
/// Longest step of the other method over its largest stable step.
const MAX_STEP_SHARE: f64 = 0.25;
/// If both methods differ by less than this fraction of the difference between tolerances, the
/// reference is trusted: nearly all of that difference is the error of the looser tolerance.
const TRUSTED_SHARE: f64 = 0.3;
/// The same fraction, if tighter tolerances no longer agree better: where friction, a limit of
/// strain or the collision safeguard acts after each step, the reference is not more certain.
const STUCK_TRUSTED_SHARE: f64 = 2.0;
/// Largest number of times that the step is halved.
const MAX_REFINEMENTS: usize = 12;
/// Uncertainty, over the largest of all frames, below which positions count as precisely known.
const CLEAR_SHARE: f64 = 1e-4;
/// Ratio of disagreements before and after two refinements, above which they no longer fall.
const STUCK_RATIO: f64 = 0.5;

/// Reference solution of a scene at each frame.
///
/// Explicit Euler on a decay y' = -y, whose error halves with its step:
///
/// ```
/// # use std::sync::Arc;
/// use a3_core::accuracy::{Frames, Reference, measure};
/// # use a3_core::{Control, Model, ParticleSystem, Scene, integrators};
/// # struct Decay;
/// # impl ParticleSystem for Decay {
/// #     fn dim(&self) -> usize { 1 }
/// #     fn eval_f(&self, _t: f64, y: &[f64], dydt: &mut [f64]) { dydt[0] = -y[0]; }
/// # }
/// # let scene = Scene::new("decay", Model::FirstOrder(Arc::new(Decay)), vec![1.0]);
///
/// let go_on = || true;
/// let reference = Reference::finest(&scene, Frames::new(1.0), &go_on)?.unwrap();
/// assert!(reference.floor.state < 1e-12);
///
/// let euler = integrators::find("euler").unwrap();
/// let error = |step: f64| -> Result<f64, a3_core::Error> {
///     let outcome = measure(&scene, euler, Control::Step(step), &reference, &go_on)?;
///     Ok(outcome.unwrap().errors.state)
/// };
/// let ratio = error(0.001)? / error(0.0005)?;
/// assert!((ratio - 2.0).abs() < 0.001);
/// # Ok::<(), a3_core::Error>(())
/// ```
pub struct Reference {
    /// Times of the reference.
    pub frames: Frames,
    /// Uncertainty of the reference: the largest disagreement over the frames with a method of
    /// another family.
    pub floor: Errors,
    /// Errors of a run in which nothing moves: larger errors are meaningless.
    pub still: Errors,
    /// Work of all runs that make the reference.
    pub work: Work,
    /// Largest work of a run to a tolerance, or by a solver of another library (evaluations),
    /// beyond which it is given up; infinite unless it is set.
    pub max_work: f64,
    /// Whether the system is stiff, so that implicit methods make the reference.
    pub is_stiff: bool,
    /// State from which all runs start.
    pub(super) start: Snapshot,
    pub(super) scope: Scope,
    pub(super) trajectory: Trajectory,
    /// Uncertainty at each frame, of the positions (m) or of the state.
    uncertain: Vec<f64>,
}

impl Reference {
    /// Creates the most precise reference of a scene from its start, for errors of all particles at
    /// all frames. `None` if `go_on` returned false.
    ///
    /// # Errors
    /// The scene cannot be run, or the run of the reference blows up.
    pub fn finest(scene: &Scene, frames: Frames, go_on: GoOn) -> Result<Option<Self>, Error> {
        let precision = Precision { metric: Metric::of_motion(&scene.model), ..Precision::FINEST };
        Self::new(scene, frames, Scope::default(), precision, go_on)
    }

    /// Creates a reference of a scene from its start, for errors in a scope, with the required
    /// precision or the highest possible. `None` if `go_on` returned false.
    ///
    /// # Errors
    /// The scene cannot be run, the run of the reference blows up, or the metric or the scope's
    /// particle is none of the scene's.
    pub fn new(
        scene: &Scene,
        frames: Frames,
        scope: Scope,
        precision: Precision,
        go_on: GoOn,
    ) -> Result<Option<Self>, Error> {
        precision.metric.check(&scene.model)?;
        let scope = scope.checked(&scene.model)?;
        let needed = precision.tolerance();
        let Some((is_stiff, work)) = is_stiff(scene, frames.until, needed, go_on)? else {
            return Ok(None);
        };
        let mut making = Making {
            scene,
            precision,
            go_on,
            work,
            reference: Self {
                frames,
                floor: Errors::default(),
                still: Errors::default(),
                work: Work::default(),
                max_work: f64::INFINITY,
                is_stiff,
                start: Snapshot::of(&scene.model, 0.0, &scene.state),
                scope,
                trajectory: Trajectory::new(vec![], f64::INFINITY, scope),
                uncertain: vec![f64::INFINITY; frames.count as usize],
            },
        };
        let Some((own, trusted)) = making.by_tolerances()? else {
            return Ok(None);
        };
        let Some(others) = making.by_another(trusted * making.precision.metric.of(&own))? else {
            return Ok(None);
        };
        let mut reference = making.reference;
        reference.floor = others;
        reference.work = making.work;
        let still = (1..=frames.count).filter(|k| reference.counts(*k));
        let still = still.map(|k| reference.errors(k, &reference.start.still(frames.time(k))));
        reference.still = still.fold(Errors::default(), Errors::max);
        Ok(Some(reference))
    }

    /// Returns the errors of a state at frame k, counted from 1.
    pub(super) fn errors(&self, k: u64, found: &Snapshot) -> Errors {
        self.trajectory.errors(k, found, self.scope)
    }

    /// Returns the errors at the nearest end of a step that encloses frame k, counted from 1.
    pub(super) fn errors_between(&self, model: &Model, k: u64, step: &EnclosingStep) -> Errors {
        let start = (&self.start, self.frames);
        self.trajectory.errors_between(start, (model, k, step), self.scope)
    }

    /// Returns the positions (m) of a model at time t (s), at or near frame k, counted from 1.
    pub(super) fn positions(&self, model: &Model, k: u64, t: f64) -> Cow<'_, [f64]> {
        if t == self.frames.time(k) {
            return Cow::Borrowed(self.trajectory.snapshots[k as usize - 1].positions());
        }
        let start = (&self.start, self.frames);
        Cow::Owned(self.trajectory.at(start, model, t).positions().to_vec())
    }

    /// Returns the coordinates of a model (m) and their rates of change (m/s) at a time (s) up to
    /// the last frame. They are known at frames, and interpolated between them.
    #[must_use]
    pub fn motion(&self, model: &Model, t: f64) -> [Vec<f64>; 2] {
        let start = (&self.start, self.frames);
        self.trajectory.motion(start, model, t)
    }

    /// Returns the time (s) until which positions, or a state without particles, are known to less
    /// than a ten-thousandth of the [`floor`](Self::floor), and their uncertainty (m) until then: a
    /// later event is less certain. `None` if none are known so precisely.
    #[must_use]
    pub fn clear_until(&self) -> Option<(f64, f64)> {
        let most = CLEAR_SHARE * self.floor.of_coordinates();
        let count = self.uncertain.iter().take_while(|u| **u < most).count();
        let worst = self.uncertain[..count].iter().copied().fold(0.0, f64::max);
        (count > 0).then(|| (self.frames.time(count as u64), worst))
    }

    /// Returns whether errors at frame k, counted from 1, count.
    #[must_use]
    pub fn counts(&self, k: u64) -> bool {
        !self.scope.at_end || k == self.frames.count
    }

    /// Updates the uncertainty at each frame by another trajectory.
    fn note_uncertainty(&mut self, others: &[Snapshot]) {
        for (k, (uncertain, other)) in (1..).zip(self.uncertain.iter_mut().zip(others)) {
            let errors = self.trajectory.errors(k, other, self.scope);
            *uncertain = uncertain.min(errors.of_coordinates());
        }
    }

    /// Returns the largest errors of a trajectory over the frames that count.
    fn disagreement(&self, others: &[Snapshot]) -> Errors {
        let frames = (1..=self.frames.count).filter(|k| self.counts(*k));
        let errors = frames.map(|k| self.trajectory.errors(k, &others[k as usize - 1], self.scope));
        errors.fold(Errors::default(), Errors::max)
    }
}

/// A reference in the making.
struct Making<'a> {
    scene: &'a Scene,
    precision: Precision,
    go_on: GoOn<'a>,
    work: Work,
    reference: Reference,
}

/// States at each frame, and the work of their run.
type Run = (Vec<Snapshot>, f64);

impl Making<'_> {
    /// Runs a method. `None` if `go_on` returned false.
    fn run(&mut self, method: &'static Method, control: Control) -> Result<Option<Run>, Error> {
        let mut scene = self.scene.clone();
        scene.limits.absolute = None;
        let mut simulation = Simulation::new(scene, method, control)?;
        simulation.locate_events();
        let frames = self.reference.frames;
        let start = &self.reference.start;
        let mut snapshots: Vec<Snapshot> = Vec::with_capacity(frames.count as usize);
        let mut visit = |seen: &FrameState| {
            let last = snapshots.last().unwrap_or(start);
            let next = last.next(seen.run.model(), frames.time(seen.frame), seen.state);
            snapshots.push(next);
        };
        let end = run(&mut simulation, &frames, self.go_on, Some(&mut visit))?;
        self.work += simulation.work();
        match end {
            None => Ok(None),
            Some(Some(lost)) => Err(Error::BlowUp(lost)),
            Some(None) => Ok(Some((snapshots, simulation.work().total()))),
        }
    }

    /// Returns whether errors are small enough.
    fn is_enough(&self, errors: &Errors) -> bool {
        self.precision.metric.of(errors) <= self.precision.uncertainty
    }

    /// Finds the reference by DOP853, or by Radau if the system is stiff, at smaller and smaller
    /// tolerances. Returns the disagreement of the last two, and the share of it below which that
    /// with the other method is meaningless.
    fn by_tolerances(&mut self) -> Result<Option<(Errors, f64)>, Error> {
        let method = accurate(self.reference.is_stiff)?;
        let (loosest, tightest) = TOLERANCES;
        let mut tolerance =
            if self.precision.max_work.is_finite() { loosest } else { self.precision.tolerance() };
        tolerance *= RATIO;
        let is_own = self.scene.model.network().is_none();
        let mut looser: Option<Run> = None;
        let mut history = vec![];
        loop {
            match self.run(method, Control::Tolerance(tolerance)) {
                // Errors that a tolerance allows may lead to another solution of a system.
                Err(Error::BlowUp(_)) if is_own && tolerance > tightest => looser = None,
                Err(error) => return Err(error),
                Ok(None) => return Ok(None),
                Ok(Some((best, next))) => {
                    let scope = self.reference.scope;
                    self.reference.trajectory = Trajectory::new(best, tolerance, scope);
                    match looser.take() {
                        None if tolerance <= tightest => {
                            return Ok(Some((Errors::default(), TRUSTED_SHARE)));
                        }
                        None => {}
                        Some((looser, work)) => {
                            let found = self.reference.disagreement(&looser);
                            history.push(self.told(&found));
                            let predicted = next * next / work;
                            if is_stuck(&history) {
                                return Ok(Some((found, STUCK_TRUSTED_SHARE)));
                            }
                            if self.is_enough(&found)
                                || tolerance <= tightest
                                || predicted > self.precision.max_work
                            {
                                return Ok(Some((found, TRUSTED_SHARE)));
                            }
                        }
                    }
                    let best = std::mem::take(&mut self.reference.trajectory.snapshots);
                    looser = Some((best, next));
                }
            }
            tolerance = (tolerance / RATIO).max(tightest);
        }
    }

    /// Returns an error in the metric; infinite if it is as large as the plain numbers themselves,
    /// so that it says nothing.
    fn told(&self, errors: &Errors) -> f64 {
        let error = self.precision.metric.of(errors);
        let is_all = self.precision.metric == Metric::State && error >= 1.0;
        if is_all { f64::INFINITY } else { error }
    }

    /// Returns the fastest mode at each frame, if surfaces touch: contact may be much stiffer than
    /// all forces at the start. Steps beyond its limit would measure the collision safeguard.
    fn contact_modes(&self) -> Vec<Mode> {
        let network = self.scene.model.network();
        let Some(network) = network.filter(|network| network.contact_layer().is_some()) else {
            return vec![];
        };
        let frames = self.reference.trajectory.snapshots.iter().zip(1..);
        let fastest = frames.filter_map(|(snapshot, k)| {
            let time = self.reference.frames.time(k);
            // Other contacts have other shapes, so each estimate starts from scratch.
            LargestMode::default().estimate(network, time, snapshot.positions())
        });
        fastest.collect()
    }

    /// Returns the other method and its first setting. PEFRL takes four evaluations for each kick
    /// of forces that depend on the velocity, and does not support first-order systems.
    fn other(&self) -> Result<(&'static Method, Control), Error> {
        let model = &self.scene.model;
        if self.reference.is_stiff {
            let method = find("bdf").ok_or_else(missing)?;
            return Ok((method, Control::Tolerance(TOLERANCES.0)));
        }
        let mechanics = model.system().mechanics();
        let is_plain = mechanics.is_none() && matches!(model, Model::FirstOrder(_));
        if is_plain || model.network().is_some_and(may_rest) {
            let method = find("verner65").ok_or_else(missing)?;
            return Ok((method, Control::Tolerance(TOLERANCES.0)));
        }
        let splitting = mechanics.and_then(Mechanics::splitting);
        let smooth = splitting.is_some_and(|splitting| !splitting.kick_reads_velocity());
        let method = find(if smooth { "pefrl" } else { "rk4" }).ok_or_else(missing)?;
        let longest = |modes: &[Mode]| -> Result<f64, Error> {
            Ok(largest_step(method, modes)?.map_or(f64::INFINITY, |limit| limit.step))
        };
        let limit = MAX_STEP_SHARE * longest(&spectrum(model.system(), 0.0, &self.scene.state))?;
        let limit = limit.min(longest(&self.contact_modes())?);
        let spacing = self.reference.frames.spacing();
        let step = spacing / (spacing / limit).ceil().max(1.0);
        Ok((method, Control::Step(step)))
    }

    /// Returns the disagreement of the reference with the other method, whose step or tolerance is
    /// reduced until it is sufficient, or at most `own`, the reference's own uncertainty, or stuck.
    fn by_another(&mut self, own: f64) -> Result<Option<Errors>, Error> {
        let (method, mut control) = self.other()?;
        let metric = self.precision.metric;
        let mut least = Errors::with_all(f64::INFINITY);
        let (mut history, mut sum) = (vec![], 0.0);
        let mut row: Vec<Vec<Snapshot>> = vec![];
        loop {
            match self.run(method, control) {
                Ok(None) => return Ok(None),
                Err(Error::BlowUp(lost)) => {
                    if history.len() == MAX_REFINEMENTS {
                        return Err(Error::BlowUp(lost));
                    }
                    row.clear();
                    history.push(f64::INFINITY);
                }
                Err(error) => return Err(error),
                Ok(Some((snapshots, work))) => {
                    row = match control {
                        Control::Step(_) => extrapolate(row, snapshots),
                        Control::Tolerance(_) => vec![snapshots],
                    };
                    for column in &row {
                        least = least.min(self.reference.disagreement(column));
                        self.reference.note_uncertainty(column);
                    }
                    history.push(self.told(&least));
                    sum += work;
                    if self.is_enough(&least)
                        || metric.of(&least) <= own
                        || is_stuck(&history)
                        || sum + 2.0 * work > self.precision.max_work
                        || history.len() > MAX_REFINEMENTS
                        || control == Control::Tolerance(TOLERANCES.1)
                    {
                        return Ok(Some(least));
                    }
                }
            }
            control = match control {
                Control::Step(step) => Control::Step(0.5 * step),
                Control::Tolerance(loose) => Control::Tolerance(TOLERANCES.1.max(loose / RATIO)),
            };
        }
    }
}

/// Returns whether disagreements no longer fall.
fn is_stuck(history: &[f64]) -> bool {
    match history {
        [.., before, _, last] => before.is_finite() && *last > STUCK_RATIO * before,
        _ => false,
    }
}

/// Returns the error for a method of the reference that is not in the table of methods.
fn missing() -> Error {
    Error::Invalid("the methods that make a reference are not in the table".into())
}

/// Precision required of a reference; it is made no more precise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    /// Quantity that the precision is of.
    pub metric: Metric,
    /// Sufficient uncertainty, in the unit of the metric.
    pub uncertainty: f64,
    /// Largest work, in evaluations: of each run at a tolerance, as predicted by those before it,
    /// and of all runs at steps together. Infinite if the uncertainty must be reached at any cost.
    pub max_work: f64,
}

impl Precision {
    /// The highest precision of positions that double precision allows.
    pub const FINEST: Self =
        Self { metric: Metric::Position, uncertainty: 0.0, max_work: f64::INFINITY };

    /// Returns the tolerance that is expected to reach it.
    fn tolerance(&self) -> f64 {
        let (loosest, tightest) = TOLERANCES;
        self.uncertainty.clamp(tightest, loosest)
    }
}

/// Order of the methods that are extrapolated.
const ORDER: i32 = 4;
/// Largest number of powers of the step that are extrapolated away.
const MAX_POWERS: usize = 3;

/// Returns the next row of the extrapolation: the run with half of the step, and its combinations
/// with the row before. Each combination removes one more power of the step from the error.
pub(super) fn extrapolate(row: Vec<Vec<Snapshot>>, halved: Vec<Snapshot>) -> Vec<Vec<Snapshot>> {
    let mut next = vec![halved];
    for (power, coarse) in row.into_iter().take(MAX_POWERS).enumerate() {
        let share = 1.0 / (f64::powi(2.0, ORDER + power as i32) - 1.0);
        let pairs = coarse.iter().zip(&next[power]);
        let column = pairs.map(|(coarse, fine)| Snapshot::extrapolate(coarse, fine, share));
        next.push(column.collect());
    }
    next
}
