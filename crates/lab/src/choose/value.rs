//! A choice as a value: the methods that serve best, each with its step or tolerance.

use a3_core::accuracy::{Candidate, Frames, Metric, Precision, Reference, Scope, SetBy, shown};
use a3_core::{Control, Method, Scene};
use a3_files::bounds::{BUDGETS, ERRORS};
use a3_files::failure::Failure;
use a3_files::monitor::Monitor;

use super::search::{ENOUGH_MARGIN, cheapest, within};
use crate::chart::measure::{precision, reference};
use crate::chart::{
    check_contact, check_methods, check_metric, check_motion, check_scene, check_until, look_ahead,
    unit,
};
use crate::motion::words;

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
        Self {
            goal,
            metric: None,
            until: None,
            particle: None,
            at_end: false,
            timed: false,
        }
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

impl Chosen {
    fn new(candidate: &Candidate, milliseconds: f64, metric: Metric) -> Self {
        Self {
            method: candidate.method,
            control: candidate.control,
            error: metric.of(&candidate.outcome.errors),
            work: candidate.outcome.work.total(),
            milliseconds,
            set_by: candidate.set_by,
        }
    }
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
    let search = Search::new(scene, options)?;
    let reference = search.reference(monitor)?;
    monitor.expect(methods.len() as f64);
    let found = search.run(&methods, &reference, monitor)?;
    let metric = search.metric;
    let (best, _) = &found[0];
    let go_on = &|| monitor.go_on();
    let shown = shown(scene, best.method, best.control, &reference, go_on);
    let shown = shown.map_err(Failure::run)?.ok_or_else(stopped)?;
    let chosen = |(candidate, cost): &(Candidate, f64)| Chosen::new(candidate, *cost, metric);
    Ok(Choice {
        found: found.iter().map(chosen).collect(),
        metric,
        until: reference.frames.until,
        floor: metric.of(&reference.floor),
        shown: [shown.at_ends, shown.anywhere].map(|errors| metric.of(&errors)),
    })
}

/// Search for a choice: options that are checked against the scene.
struct Search<'a> {
    scene: &'a Scene,
    options: &'a ChooseOptions,
    metric: Metric,
    scope: Scope,
}

impl<'a> Search<'a> {
    fn new(scene: &'a Scene, options: &'a ChooseOptions) -> Result<Self, Failure> {
        let metric = options.metric.unwrap_or(Metric::of_motion(&scene.model));
        check_metric(metric, scene)?;
        let asked = Scope {
            particle: options.particle,
            at_end: options.at_end,
        };
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
            metric,
            scope: asked.checked(&scene.model).map_err(Failure::usage)?,
        })
    }

    /// Computes the reference, up to the end of the runs and as precisely as the goal needs.
    fn reference(&self, monitor: &dyn Monitor) -> Result<Reference, Failure> {
        let scene = self.scene;
        monitor.stage("looking ahead");
        let until = self.options.until;
        let horizon = look_ahead(scene, until, 1.0, monitor)?.ok_or_else(stopped)?;
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
        let go_on = &|| monitor.go_on();
        let reference = reference(go_on, scene, frames, self.scope, precision)?;
        let reference = reference.ok_or_else(stopped)?;
        check_contact(self.metric, self.metric.of(&reference.still), frames.until)?;
        Ok(reference)
    }

    /// Finds the best candidates, with the computing times of their frames (ms).
    fn run(
        &self,
        methods: &[&'static Method],
        reference: &Reference,
        monitor: &dyn Monitor,
    ) -> Result<Vec<(Candidate, f64)>, Failure> {
        let (scene, metric, timed) = (self.scene, self.metric, self.options.timed);
        let found = match self.options.goal {
            Goal::Error(error) => {
                cheapest(methods, scene, reference, (metric, error), timed, monitor)?
            }
            Goal::Budget(budget) => within(methods, scene, reference, metric, budget, monitor)?,
        };
        let found = found.ok_or_else(stopped)?;
        if !found.is_empty() {
            return Ok(found);
        }
        let goal = describe_goal(self.options.goal, metric, &words(self.scope, &scene.model));
        let name = &scene.name;
        // On a system of one's own, runs may have been given up.
        let or = if reference.max_work.is_finite() {
            ", or name solvers for stiff systems, such as radau and bdf"
        } else {
            ""
        };
        Err(Failure::run(match self.options.goal {
            Goal::Error(_) => {
                format!("no solver meets {goal} on {name}: ask for a larger error{or}")
            }
            Goal::Budget(_) => format!(
                "within {goal}, no solver's error on {name} is smaller than the motion: ask for a larger budget{or}"
            ),
        }))
    }
}

/// Describes the goal in words.
pub fn describe_goal(goal: Goal, metric: Metric, scope: &str) -> String {
    match goal {
        Goal::Error(error) => format!("an error of {error:e} {} ({scope})", unit(metric)),
        Goal::Budget(budget) => format!("{budget} ms per frame"),
    }
}

/// Creates the failure of a search that was interrupted.
fn stopped() -> Failure {
    Failure::Interrupted("interrupted: nothing was chosen".into())
}
