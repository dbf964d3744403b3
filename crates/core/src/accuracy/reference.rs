//! Reference solution of a scene, and its uncertainty.
//!
//! The reference is a run of DOP853 at a tight tolerance. It is compared with a run of DOP853 at a
//! tolerance ten times as large, and with a method of another family at the steps h, h/2, h/4, ...,
//! extrapolated to zero step (Richardson; Hairer, Norsett, Wanner, *Solving Ordinary Differential
//! Equations I*, 1993, II.9). That method is PEFRL, or the classical Runge-Kutta method where
//! forces depend on the velocity. Where particles rest and slide on obstacles, it is Verner's pair
//! at smaller and smaller tolerances: fixed steps are too long for friction that begins. Its
//! disagreement with the reference is the uncertainty: two tolerances of one method may share an
//! error, two families do not.

use std::borrow::Cow;

use super::errors::{Errors, Metric, Scope};
use super::extrapolation::extrapolate;
use super::frames::{Frames, GoOn};
use super::precision::Precision;
use super::run::{Between, Look, run};
use super::snapshot::Snapshot;
use super::trajectory::Trajectory;
use crate::control::Control;
use crate::error::Error;
use crate::integrators::{Method, Work, find};
use crate::scene::{Model, Scene};
use crate::simulation::{Simulation, may_rest};
use crate::stability::{LargestMode, Mode, largest_step, spectrum};
use crate::system::Mechanics;

/// Largest and smallest tolerance of the reference. A tighter one loses more to rounding than it
/// gains.
const TOLERANCES: (f64, f64) = (1e-6, 1e-12);
/// Tolerance of the run that is compared with the reference, over that of the reference.
const LOOSER: f64 = 10.0;
/// Longest step of the other method over its largest stable step.
const SHARE: f64 = 0.25;
/// If both methods differ by less than this fraction of the difference between tolerances, the
/// reference is trusted: the looser tolerance makes nearly all of that.
const SURE: f64 = 0.3;
/// The same, where tighter tolerances no longer agree better: where friction of surfaces, a limit
/// of strain or the guard acts after each step, the reference itself is known no better.
const BLURRED: f64 = 2.0;
/// Most times that the step is halved.
const REFINEMENTS: usize = 12;
/// Uncertainty of a reference until something happens, over that afterwards.
const CLEAR: f64 = 1e-4;
/// Disagreement after two refinements over that before them, above which it no longer falls.
const FALLS: f64 = 0.5;

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
    /// Errors of a run in which nothing moves: larger errors say nothing.
    pub still: Errors,
    /// Work of all runs that make the reference.
    pub work: Work,
    /// State from which all runs start.
    pub(super) start: Snapshot,
    scope: Scope,
    trajectory: Trajectory,
    /// Uncertainty at each frame, of the positions (m) or of the state.
    uncertain: Vec<f64>,
}

impl Reference {
    /// Finest reference of a scene from its start, for errors of all particles at all frames.
    /// `None` if `go_on` returned false.
    ///
    /// # Errors
    /// The scene cannot be run, or the run of the reference blows up.
    pub fn finest(scene: &Scene, frames: Frames, go_on: GoOn) -> Result<Option<Self>, Error> {
        let precision = Precision {
            metric: Metric::of_motion(&scene.model),
            ..Precision::FINEST
        };
        Self::new(scene, frames, Scope::default(), precision, go_on)
    }

    /// Reference of a scene from its start, for errors in a scope, as precise as asked for or as
    /// possible. `None` if `go_on` returned false.
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
        scope.check(scene.model.particles())?;
        let mut making = Making {
            scene,
            precision,
            go_on,
            work: Work::default(),
            reference: Self {
                frames,
                floor: Errors::default(),
                still: Errors::default(),
                work: Work::default(),
                start: Snapshot::of(&scene.model, 0.0, &scene.state),
                scope,
                trajectory: Trajectory::new(vec![], scope),
                uncertain: vec![f64::INFINITY; frames.count as usize],
            },
        };
        let Some((own, sure)) = making.by_tolerances()? else {
            return Ok(None);
        };
        let Some(others) = making.by_another(sure * making.precision.metric.of(&own))? else {
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

    /// Errors of a state at frame k, counted from 1.
    pub(super) fn errors(&self, k: u64, found: &Snapshot) -> Errors {
        self.trajectory.errors(k, found, self.scope)
    }

    /// Errors at the nearest end of a step of a model that frame k, counted from 1, is within.
    pub(super) fn errors_between(&self, model: &Model, k: u64, step: &Between) -> Errors {
        let start = (&self.start, self.frames);
        self.trajectory
            .errors_between(start, (model, k, step), self.scope)
    }

    /// Positions (m) of a model at frame k, counted from 1, or at another time t (s) near it.
    pub(super) fn positions(&self, model: &Model, k: u64, t: f64) -> Cow<'_, [f64]> {
        if t == self.frames.time(k) {
            return Cow::Borrowed(self.trajectory.snapshots[k as usize - 1].positions());
        }
        let start = (&self.start, self.frames);
        Cow::Owned(self.trajectory.at(start, model, t).positions().to_vec())
    }

    /// Time (s) until which positions, or a state without particles, are known to less than a
    /// ten-thousandth of the [`floor`](Self::floor), and their uncertainty (m) until then:
    /// something happens afterwards that is known less well. `None` if that is so from the
    /// beginning.
    #[must_use]
    pub fn clear_until(&self) -> Option<(f64, f64)> {
        let most = CLEAR * self.floor.of_coordinates();
        let count = self.uncertain.iter().take_while(|u| **u < most).count();
        let worst = self.uncertain[..count].iter().copied().fold(0.0, f64::max);
        (count > 0).then(|| (self.frames.time(count as u64), worst))
    }

    /// Whether errors at frame k, counted from 1, count.
    #[must_use]
    pub fn counts(&self, k: u64) -> bool {
        !self.scope.at_end || k == self.frames.count
    }

    /// Notes the uncertainty at each frame by another trajectory.
    fn note_uncertainty(&mut self, others: &[Snapshot]) {
        for (k, (uncertain, other)) in (1..).zip(self.uncertain.iter_mut().zip(others)) {
            let errors = self.trajectory.errors(k, other, self.scope);
            *uncertain = uncertain.min(errors.of_coordinates());
        }
    }

    /// Largest errors of a trajectory over the frames that count.
    fn disagreement(&self, others: &[Snapshot]) -> Errors {
        let frames = (1..=self.frames.count).filter(|k| self.counts(*k));
        let errors = frames.map(|k| {
            self.trajectory
                .errors(k, &others[k as usize - 1], self.scope)
        });
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
    /// Run of a method. `None` if `go_on` returned false.
    fn run(&mut self, method: &'static Method, control: Control) -> Result<Option<Run>, Error> {
        let mut scene = self.scene.clone();
        scene.limits.absolute = None;
        let mut simulation = Simulation::new(scene, method, control)?;
        simulation.locate_events();
        let frames = self.reference.frames;
        let start = &self.reference.start;
        let mut snapshots: Vec<Snapshot> = Vec::with_capacity(frames.count as usize);
        let mut visit = |look: &Look| {
            let last = snapshots.last().unwrap_or(start);
            let next = last.next(look.run.model(), frames.time(look.frame), look.state);
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

    /// Whether errors are small enough.
    fn is_enough(&self, errors: &Errors) -> bool {
        self.precision.metric.of(errors) <= self.precision.uncertainty
    }

    /// Finds the reference by DOP853 at smaller and smaller tolerances. Returns the disagreement of
    /// the last two, and the share of it below which that with the other method tells no more.
    fn by_tolerances(&mut self) -> Result<Option<(Errors, f64)>, Error> {
        let method = find("dop853").ok_or_else(missing)?;
        let (loosest, tightest) = TOLERANCES;
        let mut tolerance = if self.precision.most.is_finite() {
            loosest
        } else {
            self.precision.uncertainty.clamp(tightest, loosest)
        };
        let Some((mut looser, mut work)) =
            self.run(method, Control::Tolerance(LOOSER * tolerance))?
        else {
            return Ok(None);
        };
        let mut history = vec![];
        loop {
            let Some((best, next)) = self.run(method, Control::Tolerance(tolerance))? else {
                return Ok(None);
            };
            let scope = self.reference.scope;
            self.reference.trajectory = Trajectory::new(best, scope);
            let found = self.reference.disagreement(&looser);
            history.push(self.precision.metric.of(&found));
            let predicted = next * next / work;
            if is_stuck(&history) {
                return Ok(Some((found, BLURRED)));
            }
            if self.is_enough(&found) || tolerance <= tightest || predicted > self.precision.most {
                return Ok(Some((found, SURE)));
            }
            work = next;
            looser = std::mem::take(&mut self.reference.trajectory.snapshots);
            tolerance = (tolerance / LOOSER).max(tightest);
        }
    }

    /// Fastest mode at each frame, where surfaces touch: contact may be much stiffer than all that
    /// is there at the start. Longer steps than its limit would show what the guard does.
    fn contact_modes(&self) -> Vec<Mode> {
        let network = self.scene.model.network();
        let Some(network) = network.filter(|network| network.contact_layer().is_some()) else {
            return vec![];
        };
        let frames = self.reference.trajectory.snapshots.iter().zip(1..);
        let fastest = frames.filter_map(|(snapshot, k)| {
            let time = self.reference.frames.time(k);
            // Another contact is another shape, so each estimate begins anew.
            LargestMode::default().estimate(network, time, snapshot.positions())
        });
        fastest.collect()
    }

    /// The other method, and the setting that it begins with: PEFRL takes four evaluations for each
    /// kick of forces that depend on the velocity, and serves no first-order system.
    fn other(&self) -> Result<(&'static Method, Control), Error> {
        let model = &self.scene.model;
        if model.network().is_some_and(may_rest) {
            let method = find("verner65").ok_or_else(missing)?;
            return Ok((method, Control::Tolerance(TOLERANCES.0)));
        }
        let splitting = model.system().mechanics().and_then(Mechanics::splitting);
        let smooth = splitting.is_some_and(|splitting| !splitting.kick_reads_velocity());
        let method = find(if smooth { "pefrl" } else { "rk4" }).ok_or_else(missing)?;
        let longest = |modes: &[Mode]| -> Result<f64, Error> {
            Ok(largest_step(method, modes)?.map_or(f64::INFINITY, |limit| limit.step))
        };
        let limit = SHARE * longest(&spectrum(model.system(), 0.0, &self.scene.state))?;
        let limit = limit.min(longest(&self.contact_modes())?);
        let spacing = self.reference.frames.spacing();
        let step = spacing / (spacing / limit).ceil().max(1.0);
        Ok((method, Control::Step(step)))
    }

    /// Disagreement of the reference with the other method, whose step or tolerance is made
    /// smaller until that is as small as asked for, or as `own`, which the reference leaves in
    /// doubt itself, or no longer falls.
    fn by_another(&mut self, own: f64) -> Result<Option<Errors>, Error> {
        let (method, mut control) = self.other()?;
        let metric = self.precision.metric;
        let mut least = Errors::with_all(f64::INFINITY);
        let (mut history, mut sum) = (vec![], 0.0);
        let mut row: Vec<Vec<Snapshot>> = vec![];
        loop {
            match self.run(method, control) {
                Ok(None) => return Ok(None),
                // Steps that are too long to stay in shape.
                Err(Error::BlowUp(lost)) => {
                    if history.len() == REFINEMENTS {
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
                    history.push(metric.of(&least));
                    sum += work;
                    if self.is_enough(&least)
                        || metric.of(&least) <= own
                        || is_stuck(&history)
                        || sum + 2.0 * work > self.precision.most
                        || history.len() > REFINEMENTS
                        || control == Control::Tolerance(TOLERANCES.1)
                    {
                        return Ok(Some(least));
                    }
                }
            }
            control = match control {
                Control::Step(step) => Control::Step(0.5 * step),
                Control::Tolerance(loose) => Control::Tolerance(TOLERANCES.1.max(loose / LOOSER)),
            };
        }
    }
}

/// Whether disagreements no longer fall.
fn is_stuck(history: &[f64]) -> bool {
    match history {
        [.., before, _, last] => before.is_finite() && *last > FALLS * before,
        _ => false,
    }
}

/// Error for a method of the reference that is not in the table of methods.
fn missing() -> Error {
    Error::Invalid("the methods that make a reference are not in the table".into())
}
