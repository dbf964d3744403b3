//! Scenes as Python gives them, by a kind and a text, or as a `System`, with options and forces.

use std::sync::Arc;

use a3_core::{Control, Disturbances, Grid, Method, Scene, Simulation, StepLimits, integrators};
use a3_files::failure::Failure;
use a3_files::scene_file::Source;
use a3_files::setup::{self, Request, SceneOptions};
use a3_files::terminal;
use a3_lab::choose::command;
use a3_scenes::{Defaults, Setup};
use pyo3::prelude::*;

use super::errors::{told, wrong};
use super::function::Raised;
use super::own_method::raised_by;
use super::own_system::{self, add_forces};

/// Reads a scene. `kind` is one of "named" (a built-in scene by its name, or a file by its path),
/// "toml" (its text), and "table" (the keys of a scene file, as JSON).
///
/// # Errors
/// There is no such scene, or it has a fault.
pub fn source(kind: &str, text: &str) -> Result<Source, Failure> {
    match kind {
        "named" => Ok(setup::find(text, "scene")?),
        "toml" => Ok(Source::written(text)?),
        "table" => Ok(Source::tabulated(text)?),
        _ => Err(Failure::usage(format!("there is no kind of scene `{kind}`"))),
    }
}

/// Scene that was read, or that a program has built.
pub struct OpenScene {
    made: Made,
    options: SceneOptions,
}

enum Made {
    Read(Source),
    Built(Box<Scene>),
}

impl OpenScene {
    /// Returns whether a program has built the scene.
    pub fn is_built(&self) -> bool {
        matches!(self.made, Made::Built(_))
    }

    /// Builds the scene.
    ///
    /// # Errors
    /// The scene has a fault, or a file that it names cannot be read.
    pub fn build(&self) -> Result<Setup, Failure> {
        match &self.made {
            Made::Read(source) => Ok(source.build(self.options.grid)?),
            Made::Built(_) if self.options.grid.is_some() => {
                Err(Failure::usage("this scene has no grid: leave out grid"))
            }
            Made::Built(scene) => Ok(Setup {
                scene: (**scene).clone(),
                presentation: Arc::default(),
                defaults: Defaults::default(),
            }),
        }
    }

    /// Returns the scene as it was built, with what its options turn on.
    ///
    /// # Errors
    /// The scene lacks what they turn on.
    pub fn scene(&self, setup: &Setup) -> Result<Scene, Failure> {
        setup::disturbed(setup.scene.clone(), self.options.on)
    }

    /// Returns the command line that runs the scene with a method at a step or a tolerance; `None`
    /// for a scene or a method that the program does not know.
    pub fn command(&self, method: &Method, control: Control) -> Option<String> {
        match &self.made {
            Made::Read(source) if source.is_named() && !method.is_own() => {
                Some(command(&self.request(source), method, control))
            }
            _ => None,
        }
    }

    /// Returns the scene's description and its options.
    ///
    /// # Errors
    /// A program has built the scene.
    pub fn described(&self) -> Result<Request, Failure> {
        match &self.made {
            Made::Read(source) => Ok(self.request(source)),
            Made::Built(_) => Err(Failure::usage(
                "this scene was not read, so it has no parts that could be left out",
            )),
        }
    }

    fn request(&self, source: &Source) -> Request {
        Request { source: source.clone(), options: self.options }
    }

    /// Returns the method that is given, or else that of the scene. Otherwise this is the explicit
    /// trapezoid for a scene that was read, and for one that was built, an accurate one: Dormand
    /// and Prince's of order 8.
    pub fn method_or(&self, method: Option<&'static Method>) -> &'static Method {
        match &self.made {
            Made::Read(source) => source.solver_or(method),
            Made::Built(_) => {
                method.or_else(|| integrators::find("dop853")).unwrap_or(&integrators::METHODS[0])
            }
        }
    }

    /// Creates a run of the scene with this step (s) or relative tolerance, or else with that of
    /// the scene or of the method.
    ///
    /// # Errors
    /// The method does not support the scene, or the value is out of its range; the scene lacks
    /// what the options turn on.
    pub fn run(
        &self,
        setup: &mut Setup,
        method: &'static Method,
        value: Option<f64>,
        limits: StepLimits,
    ) -> Result<Simulation, Failure> {
        setup.scene.limits = limits.or(setup.scene.limits);
        setup::simulate(self.options.on, setup, method, value)
    }
}

/// Arguments of Python that give a scene.
#[derive(FromPyObject)]
pub struct Given<'py> {
    /// The kind and the text, or a `System`.
    source: Bound<'py, PyAny>,
    grid: Option<(usize, usize)>,
    wind: bool,
    swing: bool,
    self_collision: bool,
    forces: Vec<Bound<'py, PyAny>>,
}

/// Scene that was opened, with the exceptions of its functions.
pub struct Opened {
    /// The scene.
    pub scene: OpenScene,
    /// What it was built to.
    pub setup: Setup,
    /// Whether the scene calls functions of Python.
    pub calls: bool,
    /// Whether its time is reversed.
    pub is_backward: bool,
    /// Their exceptions.
    pub raised: Raised,
}

impl Opened {
    /// Opens and builds a scene.
    pub fn new(py: Python<'_>, given: &Given) -> PyResult<Self> {
        let grid = given.grid.map(|(rows, cols)| Grid::new(rows, cols));
        let grid = grid.transpose().map_err(|why| wrong(py, why.to_string()))?;
        let options = SceneOptions {
            grid,
            on: Disturbances {
                wind: given.wind,
                swing: given.swing,
                contact: given.self_collision,
            },
        };
        let raised = Raised::default();
        let made = match given.source.extract::<(String, String)>() {
            Ok((kind, text)) => Made::Read(told(py, source(&kind, &text))?),
            Err(_) => Made::Built(Box::new(own_system::scene(&given.source, &raised)?)),
        };
        let is_backward =
            matches!(made, Made::Built(_)) && given.source.getattr("_backward")?.extract()?;
        let scene = OpenScene { made, options };
        let mut setup = told(py, py.detach(|| scene.build()))?;
        terminal::tell_notes();
        add_forces(&mut setup.scene, &given.forces, &raised)?;
        Ok(Self {
            calls: scene.is_built() || !given.forces.is_empty(),
            scene,
            setup,
            is_backward,
            raised,
        })
    }

    /// Returns the scene with what its options turn on.
    pub fn scene(&self, py: Python<'_>) -> PyResult<Scene> {
        let scene = py.detach(|| self.scene.scene(&self.setup));
        if let Some(raised) = self.raised.take() {
            return Err(raised);
        }
        told(py, scene)
    }

    /// Returns where the exceptions of the functions of this scene and of these methods are kept.
    /// They are empty then.
    pub fn raised<'m>(&self, methods: impl IntoIterator<Item = &'m Method>) -> Vec<Raised> {
        let of_methods = methods.into_iter().filter_map(raised_by);
        let all: Vec<_> = [self.raised.clone()].into_iter().chain(of_methods).collect();
        for raised in &all {
            raised.take();
        }
        all
    }
}

/// Returns the step (s) or the tolerance of a method, if one is given.
pub fn setting(
    py: Python<'_>,
    method: &Method,
    step: Option<f64>,
    tolerance: Option<f64>,
) -> PyResult<Option<f64>> {
    let why = match (method.is_adaptive(), step, tolerance) {
        (true, Some(_), _) => {
            "chooses its steps to a tolerance: give tolerance, such as 1e-4, not step"
        }
        (false, _, Some(_)) => "takes a step: give step in seconds, such as 0.01, not tolerance",
        (_, step, tolerance) => return Ok(step.or(tolerance)),
    };
    Err(wrong(py, format!("{} {why}", method.name)))
}
