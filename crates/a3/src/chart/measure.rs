//! Measurement of the runs of a chart: every method at every step or tolerance that tells
//! something, one run at a time, so that computing times are comparable.

use std::time::{Duration, Instant};

use a3_core::accuracy::{
    self, Errors, Frames, Metric, Outcome, Precision, Reference, Scope, coarser, ladder,
};
use a3_core::stability::{Mode, largest_step, spectrum};
use a3_core::{Control, Method, Model, Scene, Simulation};

use super::check_contact;
use super::data::{Data, VERSION};
use super::record::Record;
use crate::cli::What;
use crate::failure::Failure;
use crate::interrupt;
use crate::progress::Bar;

/// Most work of a run, in evaluations. A run that fails may take more.
const MOST_EVALUATIONS: f64 = 20_000.0;
/// Work of the runs of the reference at which it is no longer refined: in evaluations, and in those
/// times the length of the state, whichever is more work.
const MOST_OF_REFERENCE: (f64, f64) = (80_000.0, 1.5e8);
/// Least ratio of the longest step of a method to its shortest, however much work that is.
const RANGE: f64 = 6.0;
/// Work of a step of an implicit method, in evaluations, within a factor of three.
const IMPLICIT: f64 = 25.0;
/// Uncertainty of the reference over the motion of the scene, below which it is fine enough for any
/// run.
const FINE: f64 = 1e-10;
/// Most times that a run is timed, with the run that is compared. The shortest time counts.
const RUNS: u32 = 3;
/// Total computing time after which a run is timed no more, if it was timed twice.
const TOGETHER: Duration = Duration::from_millis(20);
/// Computing time of a single run after which it is timed no more.
const ALONE: Duration = Duration::from_millis(50);

/// A scene at one stiffness, and how it is measured.
pub struct Study<'a> {
    pub scene: Scene,
    pub frames: Frames,
    modes: Vec<Mode>,
    scope: Scope,
    /// Largest distance of the particles from their start, on average (m).
    pub motion: f64,
    /// A record of the scene, whose other fields are filled in for each run.
    blank: Record,
    pub reference: Option<Reference>,
    methods: &'a [&'static Method],
    metric: Metric,
    timed: bool,
}

impl<'a> Study<'a> {
    /// A study of the scene. `name` and the flags of `what` describe it in the records; errors are
    /// of a metric in a scope, on a scene whose particles move so far (m); `timed` says whether
    /// computing times are measured.
    pub fn new(
        scene: Scene,
        (name, what): (&str, &What),
        stiffness: f64,
        until: f64,
        methods: &'a [&'static Method],
        (metric, scope, motion): (Metric, Scope, f64),
        timed: bool,
    ) -> Self {
        let grid = scene.grid();
        let blank = Record {
            version: VERSION.into(),
            scene: name.into(),
            rows: grid.map_or(0, |grid| grid.rows()),
            cols: grid.map_or(0, |grid| grid.cols()),
            wind: what.wind,
            swing: what.swing,
            self_collision: what.self_collision,
            stiffness,
            until,
            scope: words(scope),
            ..Record::default()
        };
        Self {
            frames: Frames::new(until),
            modes: spectrum(scene.model.system(), 0.0, &scene.state),
            scope,
            motion,
            scene,
            blank,
            reference: None,
            methods,
            metric,
            timed,
        }
    }

    /// Stiffness of the springs, as a factor of the scene's own.
    pub fn stiffness(&self) -> f64 {
        self.blank.stiffness
    }

    /// Where errors are taken.
    pub fn scope(&self) -> Scope {
        self.scope
    }

    /// The runs of this study.
    pub fn records<'d>(&'d self, data: &'d Data) -> impl Iterator<Item = &'d Record> {
        data.records.iter().filter(|r| r.same_scene(&self.blank))
    }

    /// The steps or tolerances at which a method is run, from the coarsest on.
    fn rungs(&self, method: &'static Method) -> Result<Vec<Control>, Failure> {
        let most = self.most(method)? / each(method);
        ladder(&self.modes, method, &self.frames, most as u64).map_err(Failure::run)
    }

    /// Most work of a run of a method, in evaluations.
    fn most(&self, method: &'static Method) -> Result<f64, Failure> {
        let limit = largest_step(method, &self.modes).map_err(Failure::run)?;
        let steps = limit.map_or(0.0, |limit| RANGE * self.frames.until / limit.step);
        Ok(MOST_EVALUATIONS.max(steps * each(method)))
    }

    /// Expected work of all runs, in evaluations.
    pub fn expected(&self) -> Result<f64, Failure> {
        let mut sum = 0.0;
        for method in self.methods {
            sum += self
                .rungs(method)?
                .iter()
                .map(|control| self.expected_of(method, *control))
                .sum::<f64>();
        }
        Ok(sum)
    }

    /// Expected work of a run, in evaluations.
    fn expected_of(&self, method: &Method, control: Control) -> f64 {
        let steps = match control {
            Control::Step(step) => self.frames.until / step,
            // An estimate that holds on most scenes within a factor of three.
            Control::Tolerance(tolerance) => {
                20.0 * self.frames.until * tolerance.powf(-0.9 / f64::from(method.order))
            }
        };
        steps * each(method) + 100.0
    }

    /// Measures the runs that the data do not have yet. `false` if it was interrupted.
    pub fn run(&mut self, data: &mut Data, bar: &Bar) -> Result<bool, Failure> {
        for &method in self.methods {
            let (rungs, most) = (self.rungs(method)?, self.most(method)?);
            for (i, &control) in rungs.iter().enumerate() {
                let Some(record) = self.record(method, control, data, bar)? else {
                    return Ok(false);
                };
                // The limit of stability is that of the start, and may be longer in motion.
                let mut longest = (control, record.clone());
                while i == 0
                    && longest.1.lost_at.is_none()
                    && longest.1.error(self.metric) < longest.1.still(self.metric)
                    && let Some(longer) = coarser(longest.0, &self.frames)
                {
                    let Some(record) = self.record(method, longer, data, bar)? else {
                        return Ok(false);
                    };
                    longest = (longer, record);
                }
                bar.advance(self.expected_of(method, control));
                // Errors below that of the reference tell nothing. The work of linear algebra is
                // known only after a run.
                let enough = record.resolved(self.metric).max(1e-12);
                let next = rungs
                    .get(i + 1)
                    .map_or(1.0, |next| control.value() / next.value());
                let dear = control.step().is_some() && record.work * next > most;
                if record.lost_at.is_none() && (record.error(self.metric) < enough || dear) {
                    let rest = rungs[i + 1..].iter();
                    bar.advance(rest.map(|s| self.expected_of(method, *s)).sum());
                    break;
                }
            }
            data.save()?;
        }
        Ok(true)
    }

    /// The run of a method, measured now if the data do not have it yet. `None` if it was
    /// interrupted.
    fn record(
        &mut self,
        method: &'static Method,
        control: Control,
        data: &mut Data,
        bar: &Bar,
    ) -> Result<Option<Record>, Failure> {
        let like = Record {
            solver: method.name.into(),
            setting: control.value(),
            ..self.blank.clone()
        };
        bar.say(format!("{:<10} ", method.name));
        let known = data.find(&like, self.timed).cloned();
        let is_new = known.is_none();
        let record = match known {
            Some(known) => Some(known),
            None => self.measure(method, like, bar)?,
        };
        if let Some(record) = &record {
            check_contact(self.metric, record.still(self.metric), record.until)?;
            if is_new {
                data.add(record.clone());
            }
        }
        Ok(record)
    }

    /// Measures one run. `None` if it was interrupted.
    fn measure(
        &mut self,
        method: &'static Method,
        like: Record,
        bar: &Bar,
    ) -> Result<Option<Record>, Failure> {
        if self.reference.is_none() {
            bar.say("reference  ".into());
            let precision = precision(&self.scene, self.motion);
            self.reference = reference(&self.scene, self.frames, self.scope, precision)?;
            bar.start();
            bar.say(format!("{:<10} ", method.name));
        }
        let Some(reference) = &self.reference else {
            return Ok(None);
        };
        let Some((record, once)) = compared(like, &self.scene, method, reference)? else {
            return Ok(None);
        };
        let seconds = if self.timed && record.lost_at.is_none() {
            let control = method.control(record.setting);
            let Some(time) = time(&self.scene, method, control, &self.frames, Some(once))? else {
                return Ok(None);
            };
            Some(time.as_secs_f64())
        } else {
            None
        };
        Ok(Some(Record { seconds, ..record }))
    }
}

/// The record of a run by a method with the setting of `like`, compared with the reference of its
/// scene, and the computing time of that run. `None` if it was interrupted.
pub fn compared(
    like: Record,
    scene: &Scene,
    method: &'static Method,
    reference: &Reference,
) -> Result<Option<(Record, Duration)>, Failure> {
    let (control, begun) = (method.control(like.setting), Instant::now());
    let clock = || begun.elapsed();
    let go_on = &interrupt::go_on;
    let outcome = accuracy::measure_by(&clock, scene, method, control, reference, go_on)
        .map_err(Failure::run)?;
    let Some(Outcome {
        errors,
        work,
        guarded,
        lost,
        time,
    }) = outcome
    else {
        return Ok(None);
    };
    let Errors {
        position,
        energy,
        strain,
        momentum,
        phase,
        penetration,
        impact,
    } = errors;
    let (floor, still) = (reference.floor, reference.still);
    let of = |error: f64| Some(error).filter(|_| lost.is_none());
    let record = Record {
        error_position: of(position),
        error_energy: of(energy),
        error_strain: of(strain),
        error_momentum: of(momentum),
        error_phase: of(phase),
        error_penetration: of(penetration),
        error_impact: of(impact),
        floor_position: floor.position,
        floor_energy: floor.energy,
        floor_strain: floor.strain,
        floor_momentum: floor.momentum,
        floor_phase: floor.phase,
        floor_penetration: floor.penetration,
        floor_impact: floor.impact,
        still_position: still.position,
        still_strain: still.strain,
        still_penetration: still.penetration,
        still_impact: still.impact,
        lost_at: lost.map(|lost| lost.time),
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
    Ok(Some((record, time)))
}

/// Precision of a reference for all errors that a chart may show, of a scene whose particles move
/// so far (m).
pub fn precision(scene: &Scene, motion: f64) -> Precision {
    let (evaluations, numbers) = MOST_OF_REFERENCE;
    Precision {
        metric: Metric::Position,
        uncertainty: FINE * motion,
        most: evaluations.max(numbers / scene.state.len() as f64),
    }
}

/// Reference of a scene from its start. `None` if it was interrupted.
pub fn reference(
    scene: &Scene,
    frames: Frames,
    scope: Scope,
    precision: Precision,
) -> Result<Option<Reference>, Failure> {
    Reference::new(scene, frames, scope, precision, &interrupt::go_on)
        .map_err(|e| Failure::run(format!("the reference could not be computed: {e}")))
}

/// A scope in words.
pub fn words(scope: Scope) -> String {
    let when = if scope.at_end { " at the end" } else { "" };
    match scope.particle {
        Some(i) => format!("particle {i}{when}"),
        None => format!("all particles{when}"),
    }
}

/// Expected work of a step, in evaluations.
fn each(method: &Method) -> f64 {
    if method.implicit && !method.needs_springs {
        IMPLICIT
    } else {
        f64::from(method.damped_evaluations.max(method.evaluations))
    }
}

/// Computing time of a whole run, the shortest of several, of which one may have been made before.
/// `None` if it was interrupted.
pub fn time(
    scene: &Scene,
    method: &'static Method,
    control: Control,
    frames: &Frames,
    before: Option<Duration>,
) -> Result<Option<Duration>, Failure> {
    let (mut best, mut sum) = (before.unwrap_or(Duration::MAX), before.unwrap_or_default());
    for runs in u32::from(before.is_some())..RUNS {
        if runs > 0 && sum > if runs == 1 { ALONE } else { TOGETHER } {
            break;
        }
        let mut run = Simulation::new(scene.clone(), method, control).map_err(Failure::run)?;
        let begun = Instant::now();
        let end = accuracy::run(&mut run, frames, &interrupt::go_on, None);
        let elapsed = begun.elapsed();
        if end.map_err(Failure::run)?.is_none() {
            return Ok(None);
        }
        best = best.min(elapsed);
        sum += elapsed;
    }
    Ok(Some(best))
}

/// The scene with the stiffness of its springs multiplied by a factor.
pub fn stiffened(scene: &Scene, factor: f64) -> Result<Scene, Failure> {
    let mut scene = scene.clone();
    match &mut scene.model {
        Model::Network(network) => network.scale_stiffness(factor).map_err(Failure::usage)?,
        Model::FirstOrder(_) if factor == 1.0 => {}
        Model::FirstOrder(_) => {
            return Err(Failure::usage(format!(
                "the scene {} has no springs: leave out --stiffness",
                scene.name
            )));
        }
    }
    Ok(scene)
}
