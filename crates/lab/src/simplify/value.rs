//! The simplification of a scene as a value.

use std::path::PathBuf;

use a3_core::accuracy::{Frames, Scope};
use a3_files::bounds::{ERRORS, HORIZONS};
use a3_files::failure::Failure;
use a3_files::monitor::Monitor;
use a3_files::quantity::Quantity;
use a3_files::report::Report;
use a3_files::setup::Request;
use a3_files::visible::in_a_line;
use a3_plot::{Figure, WorkPrecision};
use serde::Serialize;

use super::chart::chart;
use super::lean::{Answer, LeanModel, MAX_TIME_RATIO, Solved, assemble, solve, time_in_turns};
use super::models::{Model, Models, measure_all};
use super::table;
use crate::chart::{check_motion, describe, look_ahead};
use crate::motion::{Compared, open};

/// Method that is often the cheapest, and is tried first.
const OFTEN_CHEAPEST: &str = "verlet";

/// Options of a simplification.
#[derive(Clone, Debug)]
pub struct SimplifyOptions {
    /// Largest allowed error of model and time steps together, in the unit of the quantity.
    pub error: f64,
    /// Quantity that is compared.
    pub of: Quantity,
    /// End of the runs (s), from 0.01 to 1000; by default as long as errors mean something.
    pub until: Option<f64>,
    /// The only particle whose position counts; by default all.
    pub particle: Option<usize>,
    /// Whether the error at the end counts, instead of the largest one.
    pub at_end: bool,
    /// File for the effects of models, in CSV or JSON. What it holds is not measured again.
    pub data: Option<PathBuf>,
    /// Whether the chart of models is measured, too.
    pub chart: bool,
}

impl SimplifyOptions {
    /// Creates options with this error of the positions (m), and otherwise the defaults.
    #[must_use]
    pub fn new(error: f64) -> Self {
        Self {
            error,
            of: Quantity::Position,
            until: None,
            particle: None,
            at_end: false,
            data: None,
            chart: false,
        }
    }
}

/// Effect of a model of the scene, compared with the whole scene.
#[derive(Clone, Debug, Serialize)]
pub struct ModelEffect {
    /// Name: a part that is left out, or another grid.
    pub model: String,
    /// Change of the quantity that is compared, in its unit; none if it was not measured.
    pub change: Option<f64>,
    /// Computing time over that of the whole scene.
    pub time: Option<f64>,
    /// Work over that of the whole scene, in evaluations of each.
    pub work: Option<f64>,
    /// Whether the leanest scene has this change.
    pub in_lean: bool,
    /// Verdict, or the reason why it was not measured, in words.
    pub verdict: String,
}

/// Solver of a scene, and its run.
#[derive(Clone, Debug, Serialize)]
pub struct SceneRun {
    /// Name of the solver.
    pub solver: &'static str,
    /// Step (s), or relative tolerance.
    pub setting: f64,
    /// Error of model and time steps together, in the unit of the quantity.
    pub error: f64,
    /// Computing time of a simulated second (s).
    pub seconds: f64,
}

impl SceneRun {
    fn new(solved: &Solved) -> Self {
        Self {
            solver: solved.method.name,
            setting: solved.control.value(),
            error: solved.error,
            seconds: solved.time,
        }
    }
}

/// Leanest scene that was found.
#[derive(Clone, Debug, Serialize)]
pub struct LeanScene {
    /// Scene file in TOML, with its solver and step.
    pub scene: String,
    /// Names of the parts that are left out.
    pub parts: Vec<String>,
    /// Factor by which the cells of its grids are shorter; below 1 for coarser grids.
    pub factor: f64,
    /// Error of the model alone, in the unit of the quantity.
    pub model_error: f64,
    /// Run of the lean scene.
    pub lean: SceneRun,
    /// Run of the whole scene.
    pub whole: SceneRun,
}

/// What a scene can do without.
#[derive(Clone, Debug, Serialize)]
pub struct Simplified {
    #[serde(skip)]
    pub report: Report,
    /// Name of the quantity that is compared.
    pub of: &'static str,
    /// Unit of the quantity.
    pub unit: &'static str,
    /// End of the runs (s).
    pub until: f64,
    /// Change of the quantity in the run of the whole scene.
    pub motion: f64,
    /// Error of the runs by which the models are compared.
    pub uncertainty: f64,
    /// Effects of the models.
    pub models: Vec<ModelEffect>,
    /// Estimated error of the scene's grid, and the observed order; none if it is not known.
    pub grid_error: Option<f64>,
    /// Observed order of the grid's error.
    pub grid_order: Option<f64>,
    /// Leanest scene; none if the monitor stopped the search.
    pub lean: Option<LeanScene>,
    #[serde(skip)]
    chart: Option<WorkPrecision>,
}

impl Simplified {
    /// Returns all of it in words.
    #[must_use]
    pub fn text(&self) -> String {
        self.report.text()
    }

    /// Returns whether there is a chart of models: it was asked for, and the scene has grids that
    /// differ by less than the motion.
    #[must_use]
    pub fn has_chart(&self) -> bool {
        self.chart.is_some()
    }

    /// Draws the chart of models in a size (px); `None` if there is none.
    ///
    /// # Errors
    /// The size is too small.
    pub fn figure(&self, width: u32, height: u32) -> Result<Option<Figure>, Failure> {
        let draw = |chart: &WorkPrecision| chart.draw(f64::from(width), f64::from(height));
        let figure = self.chart.as_ref().map(draw).transpose();
        figure.map_err(Failure::usage)
    }

    /// Writes all but the text and the chart as JSON.
    ///
    /// # Errors
    /// A number is not finite.
    pub fn json(&self) -> Result<String, Failure> {
        serde_json::to_string(self).map_err(Failure::run)
    }
}

/// Finds what a scene can do without for an error, as `a3 simplify` does.
///
/// # Errors
/// Those of [`measure()`], and the scene has a fault.
pub fn simplify(
    given: &Request,
    options: &SimplifyOptions,
    monitor: &dyn Monitor,
) -> Result<Simplified, Failure> {
    let title = describe(given.options.on, &given.scene()?);
    measure(&given.described(), &title, options, monitor)
}

/// Finds what a scene can do without, under a title.
///
/// # Errors
/// An option is out of range or makes no sense on the scene, nothing moves, no run is accurate
/// enough, or the monitor stopped the work before anything was measured.
pub fn measure(
    request: &Request,
    title: &str,
    options: &SimplifyOptions,
    monitor: &dyn Monitor,
) -> Result<Simplified, Failure> {
    let mut known = open(options.data.as_deref())?;
    let models = whole(options, request, monitor)?;
    let (mut all, why) = models.all();
    let answer = measure_all(&models, &mut all, &mut known);
    let answer =
        Failure::unless_stopped(answer.and_then(|()| leanest(&models, &all, options.error)))?;
    let of_models = match &answer {
        Some(answer) if options.chart => {
            Failure::unless_stopped(chart(&models, &answer.whole, format!("Models: {title}")))?
                .flatten()
        }
        _ => None,
    };
    let lean = answer.as_ref().map(|answer| &answer.model);
    let error = options.error;
    let effect = |model: &Model| {
        let effect = model.effect.as_ref().ok();
        ModelEffect {
            model: model.name.clone(),
            change: effect.map(|effect| effect.change),
            time: effect.map(|effect| effect.time),
            work: effect.map(|effect| effect.work),
            in_lean: lean.is_some_and(|lean| lean.has(model)),
            verdict: table::verdict(model, error, lean).into(),
        }
    };
    let description = &request.source.description;
    let of_grid = table::of_grid(&all, description);
    let of_grid = of_grid.filter(|_| options.of == Quantity::Position);
    let scene = |answer: &Answer| lean_scene(&models, answer);
    Ok(Simplified {
        report: table::report(title, error, &models, &all, why.as_deref(), answer.as_ref()),
        of: options.of.name(),
        unit: models.compared.unit(),
        until: models.compared.frames.until,
        motion: models.compared.way(&models.whole),
        uncertainty: models.uncertainty,
        models: all.iter().map(effect).collect(),
        grid_error: of_grid.as_ref().map(|grid| grid.error),
        grid_order: of_grid.and_then(|grid| grid.order()),
        lean: answer.as_ref().map(scene).transpose()?,
        chart: of_models,
    })
}

/// Integrates the whole scene accurately, up to the end of the runs. Returns its models, which are
/// not measured yet.
fn whole<'a>(
    options: &SimplifyOptions,
    request: &'a Request,
    monitor: &'a dyn Monitor,
) -> Result<Models<'a>, Failure> {
    let scene = request.scene()?;
    if scene.model.network().is_none() {
        return Err(Failure::usage(format!(
            "the scene {} is a single equation: there is nothing to leave out",
            scene.name
        )));
    }
    let (error, quantity) = (ERRORS.check(options.error)?, options.of);
    options.until.map(|until| HORIZONS.check(until)).transpose()?;
    let scope = Scope { particle: options.particle, at_end: options.at_end };
    let scope = scope.checked(&scene.model).map_err(Failure::usage)?;
    if scope.particle.is_some() && quantity != Quantity::Position {
        return Err(Failure::usage("--particle: only positions are those of a particle"));
    }
    monitor.stage("looking ahead");
    let horizon = look_ahead(&scene, options.until, 1.0, monitor)?.ok_or_else(Failure::stopped)?;
    check_motion(&scene, &horizon)?;
    monitor.stage("whole scene");
    let compared = Compared { quantity, frames: Frames::new(horizon.until), scope };
    let models = Models::new(request, scene, compared, error, monitor)?;
    let motion = compared.way(&models.whole);
    if error > motion {
        monitor.warn(&format!(
            "warning: {} by no more than {motion:.0e} {unit} in {} s: an error of {error:e} {unit} says nothing",
            table::changing(quantity),
            compared.frames.until,
            unit = compared.unit(),
        ));
    }
    Ok(models)
}

/// Assembles the leanest scene, and finds the cheapest solvers for it and for the whole scene.
fn leanest(models: &Models, all: &[Model], error: f64) -> Result<Answer, Failure> {
    let monitor = models.monitor;
    monitor.stage("cheapest solver");
    let whole = solve(models, &LeanModel::whole(models), error, OFTEN_CHEAPEST)?;
    let mut whole = whole.ok_or_else(|| {
        Failure::run(format!(
            "no solver meets an error of {error:e} {} on the whole scene",
            models.compared.unit()
        ))
    })?;
    monitor.stage("leanest scene");
    let model = assemble(models, all, error)?;
    let mut solved =
        if model.is_whole() { None } else { solve(models, &model, error, whole.method.name)? };
    if let Some(solved) = &mut solved {
        time_in_turns(models, &model, solved, &mut whole)?;
    }
    if !monitor.go_on() {
        return Err(Failure::stopped());
    }
    // The leanest scene has to save time, or to take no more work.
    let pays = |solved: &Solved| {
        solved.time <= MAX_TIME_RATIO * whole.time
            || model.factor == 1.0 && solved.work <= whole.work
    };
    let found = solved.filter(pays).map(|solved| (model, solved));
    let (model, solved) = found.unwrap_or_else(|| (LeanModel::whole(models), whole));
    Ok(Answer { model, solved, whole })
}

/// Writes the leanest scene as a scene file, with its solver and its step.
fn lean_scene(models: &Models, answer: &Answer) -> Result<LeanScene, Failure> {
    let (model, solved) = (&answer.model, &answer.solved);
    let mut description = model.description.clone();
    description.solver = Some(solved.method.name.into());
    description.step = Some(solved.control.value());
    description.duration.get_or_insert(models.compared.frames.until);
    let head = format!(
        "# The scene {} without parts that change its motion by less than {:.1e} {}, by a3 {}.\n\n",
        in_a_line(&models.scene.name),
        solved.error,
        models.compared.unit(),
        env!("CARGO_PKG_VERSION")
    );
    Ok(LeanScene {
        scene: head + &description.to_toml().map_err(Failure::run)?,
        parts: model.parts.iter().map(|part| part.name.clone()).collect(),
        factor: model.factor,
        model_error: model.error,
        lean: SceneRun::new(solved),
        whole: SceneRun::new(&answer.whole),
    })
}
