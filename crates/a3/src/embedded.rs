//! Scenes, runs and pictures for other programs, such as the Python module.

use std::sync::Arc;

use a3_core::{Control, Method, Scene, Simulation, StepLimits, integrators};
use a3_scenes::{Defaults, Presentation, Setup};

use a3_files::failure::Failure;
use a3_files::monitor::Monitor;
#[cfg(feature = "window")]
use a3_files::output;
use a3_files::scene_file::Source;
use a3_files::setup::{self, Request};
use a3_files::{progress, verdict};
use a3_lab::chart::describe;
use a3_lab::choose::command;
use a3_lab::simplify::{Simplified, SimplifyOptions, measure};
#[cfg(feature = "window")]
use a3_media::{
    painter::Painter,
    show::{Arrows, Manner, Quantity, Show, check_drawing, style},
};

pub use a3_files::setup::SceneOptions;

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
    #[must_use]
    pub fn of(scene: Scene, options: SceneOptions) -> Self {
        Self {
            made: Made::Built(Box::new(scene)),
            options,
        }
    }

    /// Returns whether a program has built the scene.
    #[must_use]
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

    /// Returns the command line that runs the scene with a method at a step or a tolerance; `None`
    /// for a scene or a method that the program does not know.
    #[must_use]
    pub fn command(&self, method: &Method, control: Control) -> Option<String> {
        match &self.made {
            Made::Read(source) if source.is_named() && !method.is_own() => {
                let request = Request {
                    source: source.clone(),
                    options: self.options,
                };
                Some(command(&request, method, control))
            }
            _ => None,
        }
    }

    /// Returns the method that is given, or else that of the scene. Otherwise this is the explicit
    /// trapezoid for a scene that was read, and for one that was built, an accurate one: Dormand
    /// and Prince's of order 8.
    #[must_use]
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

/// Finds what a scene can do without for an error, as `a3 simplify` does.
///
/// # Errors
/// A program has built the scene, an option is out of range or makes no sense on the scene, nothing
/// moves, no run is accurate enough, or the monitor stopped the work before anything was measured.
pub fn simplify(
    scene: &OpenScene,
    options: &SimplifyOptions,
    monitor: &dyn Monitor,
) -> Result<Simplified, Failure> {
    let Made::Read(source) = &scene.made else {
        return Err(Failure::usage(
            "this scene was not read, so it has no parts that could be left out",
        ));
    };
    let given = Request {
        source: source.clone(),
        options: scene.options,
    };
    let title = describe(scene.options.on, &given.scene()?);
    measure(&given.described(), &title, options, monitor)
}

/// Advances a run to a time (s) as the program does, and calls `go_on` about sixty times a
/// simulated second: the run stops if that returns false. Returns whether the run got to the end.
///
/// # Errors
/// The run blew up.
pub fn advance(
    run: &mut Simulation,
    until: f64,
    go_on: &mut dyn FnMut(&Simulation) -> bool,
) -> Result<bool, a3_core::Error> {
    progress::march(run, until, go_on)
}

/// Returns the message of the program about a run that failed on its way to a time (s): with a step
/// that would have held, if the step was the cause. It is sought for some seconds.
#[must_use]
pub fn message(run: &Simulation, error: &a3_core::Error, until: f64) -> String {
    verdict::lost(run, error, "", until).to_string()
}

/// Look of a picture.
#[cfg(feature = "window")]
#[derive(Clone, Copy, Debug, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each is an option")]
pub struct Look<'a> {
    /// Name of the quantity that colours the particles.
    pub colour: Option<&'a str>,
    /// Name of the vectors that are drawn as arrows.
    pub arrows: Option<&'a str>,
    /// Whether the wireframe is drawn instead of the surface.
    pub wireframe: bool,
    /// Whether all springs are drawn instead of the surface.
    pub springs: bool,
    /// Whether the projection is parallel.
    pub orthographic: bool,
    /// Whether the background is dark.
    pub dark: bool,
    /// Whether floor and background are left out.
    pub transparent: bool,
}

/// Draws a picture of a run as it is, of this size (px), and returns it as a PNG file.
///
/// # Errors
/// There is no such quantity, or the run lacks it; there is no adapter to draw with, or it does not
/// support pictures of this size.
#[cfg(feature = "window")]
pub fn picture(
    run: &Simulation,
    presentation: &Arc<Presentation>,
    look: Look,
    size: (u32, u32),
) -> Result<Vec<u8>, Failure> {
    let manner = Manner {
        style: style(look.wireframe, look.springs),
        springs_of: None,
        orthographic: look.orthographic,
        dark: look.dark,
        colour: named(look.colour, "colour", &Quantity::ALL, Quantity::name)?,
        arrows: named(look.arrows, "arrows", &Arrows::ALL, Arrows::name)?,
    };
    check_drawing(run, manner, false)?;
    let mut show = Show::new(presentation.clone(), manner);
    show.transparent = look.transparent;
    let caption = a3_studio::caption(&show, size);
    let mut painter = Painter::new(&show, run, size, caption)?;
    let pixels = painter.draw(&mut show, run)?;
    output::png(&pixels, size)
}

/// Finds the choice of this name.
#[cfg(feature = "window")]
fn named<T: Copy>(
    name: Option<&str>,
    option: &str,
    all: &[T],
    name_of: impl Fn(T) -> &'static str,
) -> Result<Option<T>, Failure> {
    let Some(name) = name else {
        return Ok(None);
    };
    let found = all.iter().copied().find(|choice| name_of(*choice) == name);
    found.map(Some).ok_or_else(|| {
        let names: Vec<_> = all.iter().map(|choice| name_of(*choice)).collect();
        Failure::usage(format!(
            "{option} `{name}`: the choices are {}",
            names.join(", ")
        ))
    })
}
