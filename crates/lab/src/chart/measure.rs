//! Measurement of the runs of a chart: each method at smaller and smaller steps or tolerances,
//! until the reference cannot tell its errors from 0 or a run takes too much work. Runs are taken
//! one at a time, so that their computing times are comparable. A run has errors against a
//! reference, and a computing time.

use std::time::{Duration, Instant};

use a3_core::accuracy::{
    Frames, GoOn, Metric, Outcome, Precision, Reference, Scope, coarser, ladder,
};
use a3_core::stability::{Mode, largest_step, spectrum};
use a3_core::{Control, Method, Model, Scene, Simulation, accuracy};
use a3_files::failure::Failure;
use a3_files::monitor::Monitor;

use super::asked::{Label, check_contact};
use super::record::{Data, Record, VERSION};
use crate::motion::words;

/// Largest work of a run, in evaluations. A run that blows up may take more.
const MAX_EVALUATIONS: f64 = 20_000.0;
/// Largest work of a run of a system of one's own, in evaluations, unless all runs that make its
/// reference take more: its equations may be stiff, and the time of its runs of any length.
const MAX_OWN_EVALUATIONS: f64 = 50_000.0;
/// Smallest ratio of the longest step of a method to its shortest, even if the runs take long.
const MIN_STEP_RATIO: f64 = 6.0;
/// Estimated work of a step of an implicit method, in evaluations, right within a factor of three.
const IMPLICIT_WORK: f64 = 25.0;
/// Neighbouring tolerances over a tolerance, at which `--spread` measures how much errors vary.
const NEIGHBOURS: [f64; 3] = [0.96, 0.98, 1.02];

/// Scene at one stiffness, with all that its runs share.
pub struct Study {
    pub scene: Scene,
    pub frames: Frames,
    modes: Vec<Mode>,
    scope: Scope,
    /// Largest distance of the particles from where they start, root mean square over them (m).
    pub motion: f64,
    /// Record of the scene, whose other fields are filled in for each run.
    blank: Record,
    pub reference: Option<Reference>,
    /// Methods that were given up, because a run takes too many evaluations.
    pub too_costly: Vec<&'static Method>,
    methods: Vec<&'static Method>,
    metric: Metric,
    /// Measurements besides errors and work.
    measured: Measured,
}

/// Runs of methods on a scene at smaller and smaller steps or tolerances, with their errors against
/// a reference, and their costs.
pub struct Chart {
    pub(crate) studies: Vec<Study>,
    pub(crate) data: Data,
    pub(crate) methods: Vec<&'static Method>,
    pub(crate) metric: Metric,
    pub(crate) timed: bool,
    pub(crate) title: String,
    pub(crate) complete: bool,
}

/// Measurements of runs besides their errors and their work.
#[derive(Clone, Copy)]
pub struct Measured {
    /// Whether computing times are measured.
    pub timed: bool,
    /// Whether errors at neighbouring tolerances are measured.
    pub spread: bool,
}

impl Study {
    /// Creates a study of a scene until `until` (s). Its label describes it in the records; errors
    /// are of a metric in a scope, and `motion` is the largest distance of the particles from where
    /// they start (m).
    pub fn new(
        scene: Scene,
        label: &Label,
        stiffness: f64,
        until: f64,
        methods: &[&'static Method],
        (metric, scope, motion): (Metric, Scope, f64),
        measured: Measured,
    ) -> Self {
        let grid = scene.grid();
        let blank = Record {
            version: VERSION.into(),
            scene: label.name.clone(),
            rows: grid.map_or(0, |grid| grid.rows()),
            cols: grid.map_or(0, |grid| grid.cols()),
            wind: label.on.wind,
            swing: label.on.swing,
            self_collision: label.on.contact,
            stiffness,
            until,
            scope: words(scope, &scene.model),
            ..Record::default()
        };
        Self {
            frames: Frames::of(&scene.model, until),
            modes: spectrum(scene.model.system(), 0.0, &scene.state),
            scope,
            motion,
            scene,
            blank,
            reference: None,
            too_costly: vec![],
            methods: methods.to_vec(),
            metric,
            measured,
        }
    }

    /// Returns the stiffness of the springs, over that of the scene itself.
    pub fn stiffness(&self) -> f64 {
        self.blank.stiffness
    }

    /// Returns the particles and times at which errors are taken.
    pub fn scope(&self) -> Scope {
        self.scope
    }

    /// Returns the runs of this study, without those at neighbouring tolerances.
    pub fn records<'d>(&'d self, data: &'d Data) -> impl Iterator<Item = &'d Record> {
        self.all(data).filter(|r| r.beside.is_none())
    }

    /// Returns the runs at neighbouring tolerances, if they were asked for.
    pub fn beside<'d>(&'d self, data: &'d Data) -> impl Iterator<Item = &'d Record> {
        self.all(data).filter(|r| self.measured.spread && r.beside.is_some())
    }

    /// Returns all runs of this study's scene.
    fn all<'d>(&'d self, data: &'d Data) -> impl Iterator<Item = &'d Record> {
        data.runs.all().iter().filter(|r| r.same_scene(&self.blank))
    }

    /// Returns the steps or tolerances at which a method is run, the coarsest first.
    fn rungs(&self, method: &'static Method) -> Result<Vec<Control>, Failure> {
        let max_steps = self.max_work(method)? / each(method);
        ladder(&self.modes, method, &self.frames, max_steps as u64).map_err(Failure::run)
    }

    /// Returns the largest work of a run of a method, in evaluations.
    fn max_work(&self, method: &'static Method) -> Result<f64, Failure> {
        let limit = largest_step(method, &self.modes).map_err(Failure::run)?;
        let limit = limit.filter(|limit| limit.step > 0.0);
        let steps = limit.map_or(0.0, |limit| MIN_STEP_RATIO * self.frames.until / limit.step);
        let most = MAX_EVALUATIONS.max(steps * each(method));
        Ok(match self.scene.model.network() {
            Some(_) => most,
            None => most.min(MAX_OWN_EVALUATIONS),
        })
    }

    /// Estimates the work of all runs, in evaluations.
    pub fn expected(&self) -> Result<f64, Failure> {
        let mut sum = 0.0;
        for &method in &self.methods {
            sum += self
                .rungs(method)?
                .iter()
                .map(|control| self.expected_of(method, *control))
                .sum::<f64>();
        }
        Ok(sum)
    }

    /// Estimates the work of a run, in evaluations.
    fn expected_of(&self, method: &Method, control: Control) -> f64 {
        let steps = match control {
            Control::Step(step) => self.frames.until / step,
            // On most scenes this is right within a factor of three.
            Control::Tolerance(tolerance) => {
                20.0 * self.frames.until * tolerance.powf(-0.9 / f64::from(method.order))
            }
        };
        steps * each(method) + 100.0
    }

    /// Measures the runs that the data do not have yet.
    ///
    /// # Errors
    /// A run fails, or the monitor stopped it: [`Failure::Interrupted`].
    pub fn run(&mut self, data: &mut Data, monitor: &dyn Monitor) -> Result<(), Failure> {
        for method in self.methods.clone() {
            let (rungs, max_work) = (self.rungs(method)?, self.max_work(method)?);
            if rungs.is_empty() {
                self.too_costly.push(method);
            }
            let mut coarser_run: Option<Record> = None;
            for (i, &control) in rungs.iter().enumerate() {
                let like = self.like(method, control);
                let record = self.record(method, like, coarser_run.as_ref(), data, monitor)?;
                if record.given_up {
                    self.too_costly.push(method);
                    break;
                }
                self.look_beside(method, control, &record, data, monitor)?;
                coarser_run = Some(record.clone());
                // The ladder begins just beyond the stability limit at the start of the motion.
                // Later, longer steps may be stable too.
                let mut longest = (control, record.clone());
                while i == 0
                    && longest.1.lost_at.is_none()
                    && longest.1.error(self.metric) < longest.1.still(self.metric)
                    && let Some(longer) = coarser(longest.0, &self.frames)
                {
                    let like = self.like(method, longer);
                    longest = (longer, self.record(method, like, None, data, monitor)?);
                }
                monitor.advance(self.expected_of(method, control));
                // Errors that the reference cannot tell from 0 end the ladder, and so does too much
                // work: that of linear algebra is known only after a run.
                let enough = record.resolved(self.metric).max(1e-12);
                let next = rungs.get(i + 1);
                let next = next.map_or(1.0, |next| control.value() / next.value());
                let is_expensive = control.step().is_some() && record.work * next > max_work;
                let is_enough = is_expensive || record.error(self.metric) < enough;
                if record.lost_at.is_none() && is_enough {
                    let rest = rungs[i + 1..].iter();
                    monitor.advance(rest.map(|s| self.expected_of(method, *s)).sum());
                    break;
                }
            }
            data.runs.save()?;
        }
        Ok(())
    }

    /// Measures the runs at the neighbours of a tolerance, if they were asked for.
    fn look_beside(
        &mut self,
        method: &'static Method,
        control: Control,
        record: &Record,
        data: &mut Data,
        monitor: &dyn Monitor,
    ) -> Result<(), Failure> {
        let is_wanted = self.measured.spread && record.lost_at.is_none();
        let Some(tolerance) = control.tolerance().filter(|_| is_wanted) else {
            return Ok(());
        };
        for factor in NEIGHBOURS {
            let like = Record {
                beside: Some(tolerance),
                ..self.like(method, Control::Tolerance(factor * tolerance))
            };
            self.record(method, like, None, data, monitor)?;
        }
        Ok(())
    }

    /// Creates the record of a run that is not measured yet: its scene, method and setting.
    fn like(&self, method: &Method, control: Control) -> Record {
        Record { solver: method.name.into(), setting: control.value(), ..self.blank.clone() }
    }

    /// Returns the run of a method with the setting of `like`. A run that the data do not have yet
    /// is measured and added, with the order between it and a coarser run.
    fn record(
        &mut self,
        method: &'static Method,
        like: Record,
        coarser_run: Option<&Record>,
        data: &mut Data,
        monitor: &dyn Monitor,
    ) -> Result<Record, Failure> {
        monitor.stage(method.name);
        let timed = self.measured.timed && like.beside.is_none();
        let known = data.find(&like, timed).filter(|_| data.each.is_none());
        let (known, is_new) = (known.cloned(), known.is_none());
        let record = match known {
            Some(known) => known,
            None => self.measure(method, like, data, monitor)?,
        };
        let order = |run| record.order_from(run, method.is_adaptive());
        let order = if is_new { coarser_run.and_then(order) } else { record.order };
        let record = Record { order, ..record };
        check_contact(self.metric, record.still(self.metric), record.until)?;
        if is_new && !record.given_up {
            data.runs.add(record.clone());
        }
        Ok(record)
    }

    /// Measures one run, and the reference before the first.
    fn measure(
        &mut self,
        method: &'static Method,
        like: Record,
        data: &mut Data,
        monitor: &dyn Monitor,
    ) -> Result<Record, Failure> {
        let (go_on, scene) = (&|| monitor.go_on(), &self.scene);
        if self.reference.is_none() {
            monitor.stage("reference");
            let precision = precision(scene, self.motion);
            let made = reference(go_on, scene, self.frames, self.scope, precision);
            self.reference = Some(made?);
            monitor.start();
            monitor.stage(method.name);
        }
        let reference = self.reference.as_mut().ok_or_else(Failure::stopped)?;
        let most = reference.max_work;
        if !(method.is_implicit() || method.is_own()) && reference.is_stiff {
            // Runs of explicit methods take alike to any tolerance.
            reference.max_work = MAX_EVALUATIONS.min(most);
        }
        let timed = self.measured.timed && like.beside.is_none();
        let mut coordinates = match (&data.each, like.beside) {
            (Some(_), None) => vec![0.0; 3 * scene.model.particles()],
            _ => vec![],
        };
        let found = compared(like, scene, method, reference, &mut coordinates, go_on);
        reference.max_work = most;
        let (record, once) = found?;
        if let Some(each) = data.each.as_mut().filter(|_| record.lost_at.is_none()) {
            each.add(&record, &coordinates)?;
        }
        let control = method.control(record.setting);
        let seconds = match record.lost_at {
            _ if !timed => None,
            _ if method.is_foreign() => Some(once),
            Some(_) => None,
            None => Some(time(go_on, scene, method, control, &self.frames, Some(once))?),
        };
        let seconds = seconds.map(|seconds| seconds.as_secs_f64());
        Ok(Record { seconds, ..record })
    }
}

/// Estimates the work of a step, in evaluations.
fn each(method: &Method) -> f64 {
    if method.solves_linear_systems() {
        IMPLICIT_WORK
    } else {
        f64::from(method.damped_evaluations.max(method.evaluations))
    }
}

/// Returns the scene with the stiffness of its springs multiplied by a factor, and their damping by
/// its square root, which keeps the damping ratios.
///
/// # Errors
/// The scene has no springs, unless the factor is 1; or the stiffness is out of range.
pub fn stiffened(scene: &Scene, factor: f64) -> Result<Scene, Failure> {
    let mut scene = scene.clone();
    match &mut scene.model {
        Model::Network(network) => {
            network.scale_springs(factor, factor.sqrt()).map_err(Failure::usage)?;
        }
        Model::FirstOrder(_) | Model::Points(_) if factor == 1.0 => {}
        Model::FirstOrder(_) | Model::Points(_) => {
            return Err(Failure::usage(format!(
                "the scene {} has no springs: leave out --stiffness",
                scene.name
            )));
        }
    }
    Ok(scene)
}

/// Largest work of a reference, in evaluations. Small scenes may take more, see
/// [`MAX_REFERENCE_NUMBERS`].
const MAX_REFERENCE_EVALUATIONS: f64 = 80_000.0;
/// Largest work of the reference of a small scene, in evaluations times the length of the state.
const MAX_REFERENCE_NUMBERS: f64 = 1.5e8;
/// Uncertainty of a reference, over the motion of the scene, that suffices for any run.
const UNCERTAINTY: f64 = 1e-10;
/// Largest number of times that a run is timed, including the run whose errors are measured. The
/// shortest time counts.
const MAX_TIMINGS: u32 = 3;
/// Total computing time of two or more runs after which no other is timed.
const MAX_TOTAL: Duration = Duration::from_millis(20);
/// Computing time of a single run after which no other is timed.
const MAX_SINGLE: Duration = Duration::from_millis(50);

/// Runs a method with the setting of `like`, and compares the run with the reference of its scene.
/// Returns its record and its computing time. `coordinates` receives the largest error of each
/// coordinate (m), n x 3, unless it is empty.
///
/// # Errors
/// The run fails, or `go_on` returned false.
pub fn compared(
    like: Record,
    scene: &Scene,
    method: &'static Method,
    reference: &Reference,
    coordinates: &mut [f64],
    go_on: GoOn,
) -> Result<(Record, Duration), Failure> {
    let (control, begun) = (method.control(like.setting), Instant::now());
    let clock = || begun.elapsed();
    let outcome =
        accuracy::measure_by(&clock, scene, method, control, reference, coordinates, go_on);
    let outcome = outcome.map_err(Failure::run)?.ok_or_else(Failure::stopped)?;
    let Outcome { errors, work, guarded, lost, time } = outcome;
    let (floor, still) = (reference.floor, reference.still);
    let of = |error: f64| Some(error).filter(|_| lost.is_none());
    let record = Record {
        error_position: of(errors.position),
        error_energy: of(errors.energy),
        error_strain: of(errors.strain),
        error_momentum: of(errors.momentum),
        error_phase: of(errors.phase),
        error_penetration: of(errors.penetration),
        error_impact: of(errors.impact),
        error_state: of(errors.state),
        floor_position: floor.position,
        floor_energy: floor.energy,
        floor_strain: floor.strain,
        floor_momentum: floor.momentum,
        floor_phase: floor.phase,
        floor_penetration: floor.penetration,
        floor_impact: floor.impact,
        floor_state: floor.state,
        still_position: still.position,
        still_strain: still.strain,
        still_penetration: still.penetration,
        still_impact: still.impact,
        still_state: still.state,
        lost_at: lost.map(|lost| lost.time),
        given_up: outcome.is_too_costly(),
        guard_impulses: guarded.impulses,
        guard_cuts: guarded.cuts,
        guard_lost: guarded.lost,
        work: work.total(),
        evaluations: work.evaluations,
        solves: work.solves,
        iterations: work.iterations,
        factorizations: work.factorizations,
        rejections: work.rejections,
        ..like
    };
    Ok((record, time))
}

/// Returns the precision of a reference for all errors that a chart may show. `motion` is the
/// largest distance of the particles from where they start (m).
pub fn precision(scene: &Scene, motion: f64) -> Precision {
    let of_numbers = MAX_REFERENCE_NUMBERS / scene.state.len() as f64;
    let (metric, is_own) = (Metric::of_motion(&scene.model), scene.model.network().is_none());
    Precision {
        metric,
        // Errors of plain numbers are relative to their size.
        uncertainty: match metric {
            Metric::State => UNCERTAINTY,
            _ => UNCERTAINTY * motion,
        },
        max_work: if is_own {
            MAX_REFERENCE_EVALUATIONS
        } else {
            MAX_REFERENCE_EVALUATIONS.max(of_numbers)
        },
    }
}

/// Computes the reference of a scene from its start.
///
/// # Errors
/// It blows up, or `go_on` returned false.
pub fn reference(
    go_on: GoOn,
    scene: &Scene,
    frames: Frames,
    scope: Scope,
    precision: Precision,
) -> Result<Reference, Failure> {
    let made = Reference::new(scene, frames, scope, precision, go_on);
    let failed = |e| Failure::run(format!("the reference could not be computed: {e}"));
    let mut reference = made.map_err(failed)?.ok_or_else(Failure::stopped)?;
    if scene.model.network().is_none() {
        reference.max_work = MAX_OWN_EVALUATIONS.max(reference.work.total());
    }
    Ok(reference)
}

/// Measures the computing time of a run: the shortest of several, including `before` if it is
/// given.
///
/// # Errors
/// The run fails, or `go_on` returned false.
pub fn time(
    go_on: GoOn,
    scene: &Scene,
    method: &'static Method,
    control: Control,
    frames: &Frames,
    before: Option<Duration>,
) -> Result<Duration, Failure> {
    let (mut best, mut sum) = (before.unwrap_or(Duration::MAX), before.unwrap_or_default());
    for runs in u32::from(before.is_some())..MAX_TIMINGS {
        if runs > 0 && sum > if runs == 1 { MAX_SINGLE } else { MAX_TOTAL } {
            break;
        }
        let mut run = Simulation::new(scene.clone(), method, control).map_err(Failure::run)?;
        let begun = Instant::now();
        let end = accuracy::run(&mut run, frames, go_on, None);
        let elapsed = begun.elapsed();
        end.map_err(Failure::run)?.ok_or_else(Failure::stopped)?;
        best = best.min(elapsed);
        sum += elapsed;
    }
    Ok(best)
}
