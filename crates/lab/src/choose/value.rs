//! A choice as a value: the methods that serve best, each with its step or tolerance.

use a3_core::accuracy::{
    Candidate, Demand, Frames, Metric, Precision, Reference, Scope, SetBy, choose_among, ladder,
    measure, shown,
};
use a3_core::stability::spectrum;
use a3_core::{Control, Method, Scene};
use a3_files::bounds::{BUDGETS, ERRORS};
use a3_files::failure::Failure;
use a3_files::monitor::Monitor;

use crate::chart::measure::{precision, reference, time};
use crate::chart::{
    check_contact, check_methods, check_metric, check_motion, check_scene, check_until, look_ahead,
    unit,
};
use crate::motion::words;

/// Smallest error that may be asked for, over the uncertainty of the reference.
const MIN_MARGIN: f64 = 3.0;
/// Error over the uncertainty of the reference at which the reference is precise enough.
pub const ENOUGH_MARGIN: f64 = 100.0;
/// Number of candidates that are shown.
const SHOWN: usize = 3;
/// Largest number of steps of a run.
const MAX_STEPS: f64 = 1e6;
/// Simulated time of a frame (s).
const FRAME_TIME: f64 = 1.0 / 60.0;

/// Demand on the method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// The cheapest method whose error is at most this, in the unit of the metric.
    Error(f64),
    /// The most accurate method whose computing time for a frame of 1/60 s is at most this (ms).
    Budget(f64),
}

/// Options of a [choice](choose()).
#[derive(Clone, Debug, PartialEq)]
pub struct ChooseOptions {
    /// Demand on the method.
    pub goal: Goal,
    /// Error that counts; by default that of the positions or, without particles, of the state.
    pub metric: Option<Metric>,
    /// End of the runs (s), from 0.01 to 1000, or from 1e-15 to 1e15 on a system of one's own; by
    /// default as long as errors mean something on the scene.
    pub until: Option<f64>,
    /// The only particle whose position and phase count, or the only number of a system without
    /// particles; by default all.
    pub particle: Option<usize>,
    /// Whether the error at the end counts, instead of the largest one.
    pub at_end: bool,
    /// Whether computing times decide which method is the cheapest, instead of evaluations.
    pub timed: bool,
}

impl ChooseOptions {
    /// Creates options with this goal, and otherwise the defaults, by evaluations.
    #[must_use]
    pub fn new(goal: Goal) -> Self {
        Self { goal, metric: None, until: None, particle: None, at_end: false, timed: false }
    }
}

/// Method with the step or the tolerance that serves best.
#[derive(Clone, Copy, Debug)]
pub struct Chosen {
    /// Method.
    pub method: &'static Method,
    /// Step or tolerance.
    pub control: Control,
    /// Error of its run, in the unit of the metric.
    pub error: f64,
    /// Work of its whole run (evaluations), with linear algebra.
    pub work: f64,
    /// Computing time of a frame of 1/60 s (ms).
    pub milliseconds: f64,
    /// Reason why the step or the tolerance is not larger.
    pub set_by: SetBy,
}

/// The methods that serve best on a scene.
#[derive(Clone, Debug)]
pub struct Choice {
    /// At most three methods, the best first; at least one.
    pub found: Vec<Chosen>,
    /// Error that counts.
    pub metric: Metric,
    /// End of the runs (s).
    pub until: f64,
    /// Uncertainty of the reference, in the unit of the metric.
    pub floor: f64,
    /// Largest error of the best run at the ends of its steps, if they are fixed, and the largest
    /// one of the states that it shows at any time, as films and data do, in the same unit.
    pub shown: [f64; 2],
}

impl Choice {
    /// Returns the best method.
    #[must_use]
    pub fn best(&self) -> &Chosen {
        &self.found[0]
    }
}

/// Chooses among these methods for a scene, as `a3 choose` does; among all methods of the table
/// that support the scene, if there are none.
///
/// # Errors
/// A method does not support the scene, two have the same name, an option is out of range or makes
/// no sense on the scene, nothing moves, no method meets the goal, a callback fails, or the monitor
/// stopped the search.
pub fn choose(
    scene: &Scene,
    methods: &[&'static Method],
    options: &ChooseOptions,
    monitor: &dyn Monitor,
) -> Result<Choice, Failure> {
    check_scene(scene)?;
    let methods = check_methods(scene, methods)?;
    if let Some(method) = methods.iter().find(|method| method.is_foreign()) {
        return Err(Failure::usage(format!(
            "{}: a chart measures it, but a choice is among solvers that a3 steps with",
            method.name
        )));
    }
    let search = ChoiceSearch::new(scene, options, monitor)?;
    let stopped = || Failure::Interrupted("interrupted: nothing was chosen".into());
    Failure::unless_stopped(search.choose(&methods))?.ok_or_else(stopped)
}

/// Search for a choice: options that are checked against the scene.
struct ChoiceSearch<'a> {
    scene: &'a Scene,
    options: &'a ChooseOptions,
    monitor: &'a dyn Monitor,
    metric: Metric,
    scope: Scope,
}

impl<'a> ChoiceSearch<'a> {
    fn new(
        scene: &'a Scene,
        options: &'a ChooseOptions,
        monitor: &'a dyn Monitor,
    ) -> Result<Self, Failure> {
        let metric = options.metric.unwrap_or(Metric::of_motion(&scene.model));
        check_metric(metric, scene)?;
        let asked = Scope { particle: options.particle, at_end: options.at_end };
        check_until(scene, options.until)?;
        match options.goal {
            Goal::Budget(budget) => BUDGETS.check(budget)?,
            // Plain numbers may be of any size.
            Goal::Error(error) if metric == Metric::State && error > 0.0 => error,
            Goal::Error(error) => ERRORS.check(error)?,
        };
        Ok(Self {
            scene,
            options,
            monitor,
            metric,
            scope: asked.checked(&scene.model).map_err(Failure::usage)?,
        })
    }

    fn choose(&self, methods: &[&'static Method]) -> Result<Choice, Failure> {
        let (metric, go_on) = (self.metric, &|| self.monitor.go_on());
        let reference = self.reference()?;
        self.monitor.expect(methods.len() as f64);
        let found = match self.options.goal {
            Goal::Error(error) => self.cheapest(methods, &reference, error)?,
            Goal::Budget(budget) => self.within(methods, &reference, budget)?,
        };
        let Some(best) = found.first() else {
            return Err(self.none(&reference));
        };
        let shown = shown(self.scene, best.method, best.control, &reference, go_on);
        let shown = shown.map_err(Failure::run)?.ok_or_else(Failure::stopped)?;
        Ok(Choice {
            found,
            metric,
            until: reference.frames.until,
            floor: metric.of(&reference.floor),
            shown: [shown.at_ends, shown.anywhere].map(|errors| metric.of(&errors)),
        })
    }

    /// Computes the reference, up to the end of the runs and as precisely as the goal needs.
    fn reference(&self) -> Result<Reference, Failure> {
        let (scene, monitor) = (self.scene, self.monitor);
        monitor.stage("looking ahead");
        let horizon =
            look_ahead(scene, self.options.until, 1.0, monitor)?.ok_or_else(Failure::stopped)?;
        check_motion(scene, &horizon)?;
        let frames = Frames::of(&scene.model, horizon.until);
        monitor.stage("reference");
        let precision = match self.options.goal {
            Goal::Error(error) => Precision {
                metric: self.metric,
                uncertainty: error / ENOUGH_MARGIN,
                max_work: f64::INFINITY,
            },
            Goal::Budget(_) => precision(scene, horizon.motion),
        };
        let reference = reference(&|| monitor.go_on(), scene, frames, self.scope, precision)?;
        check_contact(self.metric, self.metric.of(&reference.still), frames.until)?;
        Ok(reference)
    }

    /// Finds the cheapest methods for an error.
    ///
    /// # Errors
    /// The error is too small for the reference, or a run fails.
    fn cheapest(
        &self,
        methods: &[&'static Method],
        reference: &Reference,
        error: f64,
    ) -> Result<Vec<Chosen>, Failure> {
        let (scene, metric, monitor) = (self.scene, self.metric, self.monitor);
        let (floor, still) = (metric.of(&reference.floor), metric.of(&reference.still));
        let (unit, until) = (unit(metric), reference.frames.until);
        if error < MIN_MARGIN * floor {
            let least = MIN_MARGIN * floor;
            return Err(Failure::usage(format!(
                "the reference of this scene over {until} s is itself known to {floor:.0e} {unit} only: ask for an error \
                 of at least {least:.0e}"
            )));
        }
        if matches!(metric, Metric::Position | Metric::State) && error > still {
            monitor.warn(&format!(
                "warning: nothing moves further than {still:.0e} {unit} in {until} s: an error of {error:e} {unit} says nothing"
            ));
        }
        monitor.start();
        let mut begun = 0;
        let begin = |method: &'static Method| {
            monitor.stage(method.name);
            monitor.advance(f64::from(u8::from(begun > 0)));
            begun += 1;
        };
        let go_on = &|| monitor.go_on();
        let demand = Demand { metric, error, timed: self.options.timed };
        let found = choose_among(methods, scene, reference, demand, go_on, begin);
        monitor.clear();
        let mut found = found.map_err(Failure::run)?.ok_or_else(Failure::stopped)?;
        if !self.options.timed {
            found.truncate(SHOWN);
        }
        let measured = found.iter().map(|it| self.timed(it, reference));
        let mut measured = measured.collect::<Result<Vec<_>, Failure>>()?;
        if self.options.timed {
            measured.sort_by(|a, b| a.milliseconds.total_cmp(&b.milliseconds));
            measured.truncate(SHOWN);
        }
        Ok(measured)
    }

    /// Measures the computing time of a frame, averaged over the whole run.
    fn timed(&self, candidate: &Candidate, reference: &Reference) -> Result<Chosen, Failure> {
        let (method, control, frames) = (candidate.method, candidate.control, &reference.frames);
        let go_on = &|| self.monitor.go_on();
        let time = time(go_on, self.scene, method, control, frames, None)?;
        Ok(Chosen {
            method,
            control,
            error: self.metric.of(&candidate.outcome.errors),
            work: candidate.outcome.work.total(),
            milliseconds: 1e3 * time.as_secs_f64() * FRAME_TIME / frames.until,
            set_by: candidate.set_by,
        })
    }

    /// Finds the three most accurate methods, each at its most accurate step or tolerance whose
    /// frames take no longer than the budget (ms).
    fn within(
        &self,
        methods: &[&'static Method],
        reference: &Reference,
        budget: f64,
    ) -> Result<Vec<Chosen>, Failure> {
        let (scene, metric, monitor) = (self.scene, self.metric, self.monitor);
        let mut found: Vec<Chosen> = vec![];
        let modes = spectrum(scene.model.system(), 0.0, &scene.state);
        let conserved = matches!(metric, Metric::Energy | Metric::Momentum | Metric::Phase);
        let still = Some(metric.of(&reference.still)).filter(|_| !conserved);
        let max_error = still.unwrap_or(f64::INFINITY);
        let enough = ENOUGH_MARGIN * metric.of(&reference.floor);
        monitor.start();
        for &method in methods {
            monitor.stage(method.name);
            let mut best: Option<Chosen> = None;
            let most = MAX_STEPS.min(reference.max_work) as u64;
            for control in ladder(&modes, method, &reference.frames, most).map_err(Failure::run)? {
                let outcome = measure(scene, method, control, reference, &|| monitor.go_on());
                let outcome = outcome.map_err(Failure::run)?.ok_or_else(Failure::stopped)?;
                if outcome.is_too_costly() {
                    break;
                }
                let candidate = Candidate {
                    method,
                    control,
                    work: outcome.work.total(),
                    outcome,
                    set_by: SetBy::Accuracy,
                };
                let chosen = self.timed(&candidate, reference)?;
                if chosen.milliseconds > budget {
                    break;
                }
                // An error larger than the motion says nothing.
                let most = best.map_or(max_error, |best| best.error.min(max_error));
                if outcome.lost.is_none() && chosen.error < most {
                    best = Some(chosen);
                }
                if chosen.error < enough {
                    break;
                }
            }
            found.extend(best);
            monitor.advance(1.0);
        }
        monitor.clear();
        found.sort_by(|a, b| a.error.total_cmp(&b.error));
        found.truncate(SHOWN);
        Ok(found)
    }

    /// Creates the failure of a search that found nothing.
    fn none(&self, reference: &Reference) -> Failure {
        let (scene, goal) = (self.scene, self.options.goal);
        let wanted = describe_goal(goal, self.metric, &words(self.scope, &scene.model));
        let name = &scene.name;
        // On a system of one's own, runs may have been given up.
        let or = if reference.max_work.is_finite() {
            ", or name solvers for stiff systems, such as radau and bdf"
        } else {
            ""
        };
        Failure::run(match goal {
            Goal::Error(_) => {
                format!("no solver meets {wanted} on {name}: ask for a larger error{or}")
            }
            Goal::Budget(_) => format!(
                "within {wanted}, no solver's error on {name} is smaller than the motion: ask for a larger budget{or}"
            ),
        })
    }
}

/// Describes the goal in words.
pub fn describe_goal(goal: Goal, metric: Metric, scope: &str) -> String {
    match goal {
        Goal::Error(error) => format!("an error of {error:e} {} ({scope})", unit(metric)),
        Goal::Budget(budget) => format!("{budget} ms per frame"),
    }
}
