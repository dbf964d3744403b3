//! Scenes that were read, or that a program has built.

use std::sync::Arc;

use a3_core::{Control, Method, Scene, Simulation, StepLimits, integrators};
use a3_scenes::{Defaults, Setup};

use a3_files::failure::Failure;
use a3_files::scene_file::Source;
use a3_files::setup::{self, Request, SceneOptions};
use a3_lab::choose::command;

/// Origin of a scene.
#[derive(Clone, Copy, Debug)]
pub enum Origin<'a> {
    /// Name of a built-in scene, or path of a file.
    Named(&'a str),
    /// Text in TOML.
    Toml(&'a str),
    /// Table of the keys of a scene file, as JSON.
    Table(&'a str),
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
    /// Reads a scene.
    ///
    /// # Errors
    /// There is no such scene, or it has a fault.
    pub fn read(origin: Origin, options: SceneOptions) -> Result<Self, Failure> {
        let source = match origin {
            Origin::Named(name) => setup::find(name, "scene")?,
            Origin::Toml(text) => Source::written(text)?,
            Origin::Table(json) => Source::tabulated(json)?,
        };
        let made = Made::Read(source);
        Ok(Self { made, options })
    }

    /// Takes a scene that was built.
    pub fn of(scene: Scene, options: SceneOptions) -> Self {
        Self {
            made: Made::Built(Box::new(scene)),
            options,
        }
    }

    /// Returns whether a program has built the scene.
    pub fn is_built(&self) -> bool {
        matches!(self.made, Made::Built(_))
    }

    /// Returns the table of the scene's keys, as JSON.
    ///
    /// # Errors
    /// The scene is not one with such keys.
    pub fn table(&self) -> Result<String, Failure> {
        match &self.made {
            Made::Read(source) => source.table().map_err(Failure::Input),
            Made::Built(_) => Err(Failure::usage("this scene was not read, so it has no keys")),
        }
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

    /// Returns the command line that runs the scene with a method at a step or a tolerance until a
    /// time (s); `None` for a scene or a method that the program does not know.
    pub fn command(&self, method: &Method, control: Control, until: f64) -> Option<String> {
        match &self.made {
            Made::Read(source) if source.is_named() && !method.is_own() => {
                let request = self.request(source);
                Some(command(&request, method, control, until))
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
        Request {
            source: source.clone(),
            options: self.options,
        }
    }

    /// Returns the method that is given, or else that of the scene. Otherwise this is the explicit
    /// trapezoid for a scene that was read, and for one that was built, an accurate one: Dormand
    /// and Prince's of order 8.
    pub fn method_or(&self, method: Option<&'static Method>) -> &'static Method {
        match &self.made {
            Made::Read(source) => source.solver_or(method),
            Made::Built(_) => method
                .or_else(|| integrators::find("dop853"))
                .unwrap_or(&integrators::METHODS[0]),
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
