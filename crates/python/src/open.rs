//! Scenes as Python gives them: by a kind and a text, or as a `System`; with options and forces.

use a3_core::{Disturbances, Grid, Method, Scene};
use a3_files::setup::SceneOptions;
use a3_scenes::Setup;
use pyo3::prelude::*;

use super::errors::{of_failure, wrong};
use super::function::Raised;
use super::own_method::raised_by;
use super::own_system::{self, add_forces};
use super::scene::OpenScene;
use super::tables::origin;

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
        let failed = |failure| of_failure(py, &failure);
        let raised = Raised::default();
        let scene = match given.source.extract::<(String, String)>() {
            Ok((kind, text)) => {
                OpenScene::read(origin(py, &kind, &text)?, options).map_err(failed)?
            }
            Err(_) => OpenScene::of(own_system::scene(&given.source, &raised)?, options),
        };
        let mut setup = py.detach(|| scene.build()).map_err(failed)?;
        add_forces(&mut setup.scene, &given.forces, &raised)?;
        Ok(Self {
            calls: scene.is_built() || !given.forces.is_empty(),
            scene,
            setup,
            raised,
        })
    }

    /// Returns the scene with what its options turn on.
    pub fn scene(&self, py: Python<'_>) -> PyResult<Scene> {
        let scene = py.detach(|| self.scene.scene(&self.setup));
        if let Some(raised) = self.raised.take() {
            return Err(raised);
        }
        scene.map_err(|failure| of_failure(py, &failure))
    }

    /// Returns where the exceptions of the functions of this scene and of these methods are kept.
    /// They are empty then.
    pub fn raised<'m>(&self, methods: impl IntoIterator<Item = &'m Method>) -> Vec<Raised> {
        let of_methods = methods.into_iter().filter_map(raised_by);
        let all: Vec<_> = [self.raised.clone()]
            .into_iter()
            .chain(of_methods)
            .collect();
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
