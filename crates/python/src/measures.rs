//! Charts, choices, limits, comparisons, judgements, and what scenes can do without.

use std::path::PathBuf;

use a3_core::accuracy::{Metric, SetBy};
use a3_core::stability::Mode;
use a3_core::{Control, Method};
use a3_files::failure::Failure;
use a3_files::quantity::Quantity;
use a3_lab::chart::ChartOptions;
use a3_lab::choose::{ChooseOptions, Goal};
use a3_lab::judge::{JudgeOptions, StatesOf};
use a3_lab::simplify::SimplifyOptions;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use super::errors::{of_failure, told, wrong};
use super::function::Raised;
use super::monitor::Monitor;
use super::scene::{Given, Opened};
use super::tables::{control, methods_named};

/// Finds one of the things of a kind by its name.
fn named<T: Copy>(
    py: Python<'_>,
    name: &str,
    (kind, kinds): (&str, &str),
    all: impl IntoIterator<Item = T> + Clone,
    name_of: fn(T) -> &'static str,
) -> PyResult<T> {
    let mut known = all.clone().into_iter();
    let found = known.find(|it| name_of(*it) == name);
    found.ok_or_else(|| {
        let names = all.into_iter().map(name_of).collect::<Vec<_>>().join(", ");
        let why = format!("there is no {kind} `{name}`: the {kinds} are {names}");
        wrong(py, why)
    })
}

/// Finds a metric by its name, if one is given.
fn metric(py: Python<'_>, name: Option<&str>) -> PyResult<Option<Metric>> {
    let all = Metric::OF_PARTICLES.into_iter().chain([Metric::State]);
    let find = |name| named(py, name, ("error", "errors"), all, Metric::name);
    name.map(find).transpose()
}

/// Runs work without the global lock, watched by a monitor. If it failed because a function raised
/// an exception, that is raised.
fn work<T: Send>(
    py: Python<'_>,
    monitor: &Monitor,
    raised: &[Raised],
    work: impl Send + FnOnce() -> Result<T, Failure>,
) -> PyResult<T> {
    monitor.watch(raised);
    py.detach(work).map_err(|failure| {
        let raised = raised.iter().find_map(Raised::take);
        raised.unwrap_or_else(|| of_failure(py, &failure))
    })
}

/// A picture that can be drawn.
type Draw<'a> = dyn Fn(u32, u32) -> Result<a3_plot::Figure, Failure> + Sync + 'a;
/// A picture's file.
type Drawn<'py> = PyResult<Bound<'py, PyBytes>>;

/// Draws a picture of this kind: "svg", "pdf" or "png".
fn drawn<'py>(py: Python<'py>, kind: &str, size: (u32, u32), draw: &Draw) -> Drawn<'py> {
    let bytes = py.detach(|| {
        let figure = draw(size.0, size.1)?;
        match kind {
            "svg" => Ok(figure.svg().into_bytes()),
            "pdf" => Ok(figure.pdf()),
            _ => figure.png(1.0).map_err(Failure::run),
        }
    });
    Ok(PyBytes::new(py, &told(py, bytes)?))
}

/// A measured chart.
#[pyclass(frozen, module = "a3_simulator._a3")]
pub struct Chart(a3_lab::chart::Chart);

#[pymethods]
impl Chart {
    /// Returns the runs, as JSON.
    fn json(&self, py: Python<'_>) -> PyResult<String> {
        told(py, self.0.json())
    }

    /// Returns the tables, as text.
    fn table(&self) -> String {
        self.0.table()
    }

    /// Returns the errors that say something, and the place among the runs of the cheapest that
    /// keeps each.
    fn winners(&self) -> Vec<(f64, usize)> {
        let place = |best| self.0.runs().position(|run| std::ptr::eq(run, best));
        let winners = self.0.winners();
        winners.filter_map(|(error, best)| Some((error, place(best)?))).collect()
    }

    /// Returns the names of the methods whose runs take too many evaluations.
    fn too_costly(&self) -> Vec<&'static str> {
        let methods = self.0.too_costly().iter();
        methods.map(|method| method.name).collect()
    }

    /// Returns the name of the error that counts, the end of the runs (s), and whether all were
    /// measured.
    fn about(&self) -> (&'static str, f64, bool) {
        (self.0.metric().name(), self.0.until(), self.0.is_complete())
    }

    /// Draws a picture of a kind and a size (px).
    fn drawn<'py>(&self, py: Python<'py>, kind: &str, size: (u32, u32)) -> Drawn<'py> {
        drawn(py, kind, size, &|width, height| self.0.figure(width, height))
    }
}

/// Measures a chart.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "each is an option")]
pub fn chart(
    py: Python<'_>,
    given: Given,
    methods: Vec<String>,
    monitor: &Monitor,
    until: Option<f64>,
    error: Option<&str>,
    particle: Option<usize>,
    at_end: bool,
    timed: bool,
    spread: bool,
    stiffness: Vec<f64>,
) -> PyResult<Chart> {
    let opened = Opened::new(py, &given)?;
    let (scene, methods) = (opened.scene(py)?, methods_named(py, &methods)?);
    let options = ChartOptions {
        until,
        error: metric(py, error)?,
        particle,
        at_end,
        timed,
        spread,
        stiffness,
    };
    let raised = opened.raised(methods.iter().copied());
    work(py, monitor, &raised, || a3_lab::chart::chart(&scene, &methods, &options, monitor))
        .map(Chart)
}

/// Method, step or tolerance, error, work, computing time of a frame (ms), the reason why the
/// setting is not larger, and a command.
type Chosen = (&'static str, f64, f64, f64, f64, &'static str, Option<String>);

/// Methods, the end of the runs (s), the uncertainty of the reference, the errors of the best run
/// at the ends of its steps and anywhere, and words if the latter is larger than was asked.
type Choices = (Vec<Chosen>, f64, f64, [f64; 2], String);

/// Chooses methods.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "each is an option")]
pub fn choose(
    py: Python<'_>,
    given: Given,
    methods: Vec<String>,
    monitor: &Monitor,
    error: Option<f64>,
    budget: Option<f64>,
    of: Option<&str>,
    until: Option<f64>,
    particle: Option<usize>,
    at_end: bool,
    timed: bool,
) -> PyResult<Choices> {
    let goal = match (error, budget) {
        (Some(error), None) => Goal::Error(error),
        (None, Some(budget)) => Goal::Budget(budget),
        _ => {
            let why = "choose takes either error (in m) or budget (in ms per frame)";
            return Err(wrong(py, why));
        }
    };
    let opened = Opened::new(py, &given)?;
    let (scene, methods) = (opened.scene(py)?, methods_named(py, &methods)?);
    let options = ChooseOptions {
        metric: metric(py, of)?,
        until,
        particle,
        at_end,
        timed,
        ..ChooseOptions::new(goal)
    };
    let raised = opened.raised(methods.iter().copied());
    let choice =
        work(py, monitor, &raised, || a3_lab::choose::choose(&scene, &methods, &options, monitor))?;
    let chosen = |chosen: &a3_lab::choose::Chosen| {
        let why = match chosen.set_by {
            SetBy::Accuracy => "accuracy",
            SetBy::Stability => "stability",
            SetBy::Nothing => "nothing",
        };
        let command = opened.scene.command(chosen.method, chosen.control);
        (
            chosen.method.name,
            chosen.control.value(),
            chosen.error,
            chosen.work,
            chosen.milliseconds,
            why,
            command,
        )
    };
    let found = choice.found.iter().map(chosen).collect();
    let words = a3_lab::choose::holds(goal, &choice);
    Ok((found, choice.until, choice.floor, choice.shown, words))
}

/// Measured limits.
#[pyclass(frozen, module = "a3_simulator._a3")]
pub struct Stability(a3_lab::stability::Stability);

#[pymethods]
impl Stability {
    /// Returns the limits (s), as JSON.
    fn json(&self, py: Python<'_>) -> PyResult<String> {
        told(py, self.0.json())
    }

    /// Returns the table, as text.
    fn table(&self) -> String {
        self.0.table()
    }

    /// Returns whether all was measured.
    fn complete(&self) -> bool {
        self.0.complete
    }

    /// Returns frequencies (rad/s) and damping ratios of the fastest motions at the start and at
    /// rest.
    fn fastest(&self) -> [Option<(f64, f64)>; 2] {
        let told = |mode: Mode| (mode.frequency(), mode.damping_ratio());
        self.0.fastest_motions().map(|mode| mode.map(told))
    }

    /// Returns the rate (1/s) at which errors of constraints decay, and the time (s) up to which
    /// the motion can be predicted.
    fn about(&self) -> (Option<f64>, f64) {
        (self.0.feedback, self.0.predictable)
    }

    /// Draws a picture of a kind and a size (px), for a step (s).
    fn drawn<'py>(
        &self,
        py: Python<'py>,
        kind: &str,
        size: (u32, u32),
        step: Option<f64>,
    ) -> Drawn<'py> {
        drawn(py, kind, size, &|width, height| self.0.figure(step, width, height))
    }
}

/// Measures the largest steps.
#[pyfunction]
pub fn stability(
    py: Python<'_>,
    given: Given,
    methods: Vec<String>,
    monitor: &Monitor,
) -> PyResult<Stability> {
    let opened = Opened::new(py, &given)?;
    let (scene, methods) = (opened.scene(py)?, methods_named(py, &methods)?);
    let raised = opened.raised(methods.iter().copied());
    work(py, monitor, &raised, || a3_lab::stability::stability(&scene, &methods, monitor))
        .map(Stability)
}

/// A run of a comparison: method, setting, states one after the other, energies (J), work, and the
/// message of a blow-up with its time (s).
type Compared<'py> = (
    &'static str,
    f64,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    f64,
    Option<String>,
    Option<f64>,
);

/// Times (s), the runs, the number of particles, and the length of the state.
type AllCompared<'py> = (Bound<'py, PyArray1<f64>>, Vec<Compared<'py>>, usize, usize);

/// Runs a scene by several methods, each with its step or tolerance.
#[pyfunction]
pub fn compare<'py>(
    py: Python<'py>,
    given: Given,
    runs: Vec<(String, Option<f64>)>,
    monitor: &Monitor,
    until: f64,
    frames: usize,
) -> PyResult<AllCompared<'py>> {
    let opened = Opened::new(py, &given)?;
    let scene = opened.scene(py)?;
    let asked = runs.iter().map(|(name, value)| {
        let method = super::tables::method(py, name)?;
        Ok((method, control(&opened.setup, method, *value)))
    });
    let asked = asked.collect::<PyResult<Vec<(&'static Method, Control)>>>()?;
    let raised = opened.raised(asked.iter().map(|(method, _)| *method));
    let compared = work(py, monitor, &raised, || {
        a3_lab::compare::compare(&scene, &asked, until, frames, monitor)
    })?;
    let runs = compared.runs.iter().map(|run| {
        (
            run.method.name,
            run.control.value(),
            PyArray1::from_vec(py, run.states.concat()),
            PyArray1::from_slice(py, &run.energies),
            run.work,
            run.blow_up.map(|blow_up| blow_up.to_string()),
            run.blow_up.map(|blow_up| blow_up.time),
        )
    });
    let times = PyArray1::from_slice(py, &compared.times);
    let (particles, length) = (scene.model.particles(), scene.state.len());
    Ok((times, runs.collect(), particles, length))
}

/// Judges states: a file, or an archive of arrays with its name. Returns the judgement in words and
/// as JSON.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "each is an option")]
pub fn judge(
    py: Python<'_>,
    given: Given,
    monitor: &Monitor,
    file: Option<PathBuf>,
    archive: Option<(String, Vec<u8>)>,
    until: Option<f64>,
    step: Option<f64>,
    within: Option<f64>,
) -> PyResult<(String, String)> {
    let opened = Opened::new(py, &given)?;
    let scene = opened.scene(py)?;
    let states = match (&file, &archive) {
        (Some(file), _) => StatesOf::File(file),
        (None, Some((name, bytes))) => StatesOf::Npz(name, bytes),
        (None, None) => return Err(wrong(py, "there are no states to judge")),
    };
    let options = JudgeOptions { until, step, within };
    let raised = opened.raised([]);
    let verdict = work(py, monitor, &raised, || {
        a3_lab::judge::judge_states(&scene, states, &options, monitor)
    })?;
    Ok((verdict.text, verdict.json))
}

/// What a scene can do without.
#[pyclass(frozen, module = "a3_simulator._a3")]
pub struct Simplified(a3_lab::simplify::Simplified);

#[pymethods]
impl Simplified {
    /// Returns whether the chart of models was measured.
    fn has_chart(&self) -> bool {
        self.0.has_chart()
    }

    /// Returns all of it in words.
    fn text(&self) -> String {
        self.0.text()
    }

    /// Returns all of it as JSON.
    fn json(&self, py: Python<'_>) -> PyResult<String> {
        told(py, self.0.json())
    }

    /// Draws a picture of the chart of models, of a kind and a size (px).
    fn drawn<'py>(&self, py: Python<'py>, kind: &str, size: (u32, u32)) -> Drawn<'py> {
        drawn(py, kind, size, &|width, height| {
            self.0.figure(width, height)?.ok_or_else(|| {
                Failure::usage(
                    "there is no chart: it needs chart=True, and a scene with grids that differ by less than the motion",
                )
            })
        })
    }
}

/// Finds what a scene can do without for an error.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "each is an option")]
pub fn simplify(
    py: Python<'_>,
    given: Given,
    monitor: &Monitor,
    error: f64,
    of: &str,
    until: Option<f64>,
    particle: Option<usize>,
    at_end: bool,
    data: Option<PathBuf>,
    chart: bool,
) -> PyResult<Simplified> {
    let opened = Opened::new(py, &given)?;
    if opened.calls {
        let why = "what a scene can do without is found for scenes without functions of Python";
        return Err(wrong(py, why));
    }
    let kind = ("quantity", "quantities");
    let options = SimplifyOptions {
        of: named(py, of, kind, Quantity::ALL, Quantity::name)?,
        until,
        particle,
        at_end,
        data,
        chart,
        ..SimplifyOptions::new(error)
    };
    let scene = &opened.scene;
    work(py, monitor, &[], || a3_lab::simplify::simplify(&scene.described()?, &options, monitor))
        .map(Simplified)
}
