//! The options of windows, comparisons, pictures and films, and of the look of a picture.

use std::path::PathBuf;

use a3_core::Method;
use a3_files::arguments::{particle, step};
use a3_files::failure::Failure;
use a3_files::setup::check_count;
use a3_media::show::{Arrows, Manner, Quantity, style};
use a3_studio::session::Opening;
use clap::Args;
use clap::builder::TypedValueParser;

use super::run::{RunOptions, SceneArgs, StepOptions, limit_threads};
use super::values::{SOLVER_AND_STEP, SOLVER_OR_COMMAND, beginning, choice, rate, size, until};

#[derive(Args)]
pub struct WindowOptions {
    /// Solver by letter or name, as `a3 solvers` lists them; by default the scene's own, or else t
    #[arg(value_parser = SOLVER_OR_COMMAND, hide_possible_values = true)]
    pub solver: Option<&'static Method>,
    /// Step in seconds, or relative tolerance of an adaptive solver; by default the scene's own, or
    /// else the solver's
    #[arg(value_parser = step, allow_negative_numbers = true)]
    pub step: Option<f64>,
    #[command(flatten)]
    pub limits: StepOptions,
    #[command(flatten)]
    pub what: SceneArgs,
    /// Show and list the springs attached to particle I
    #[arg(long, value_name = "I", value_parser = particle, allow_negative_numbers = true)]
    pub springs_of: Option<usize>,
    #[command(flatten)]
    pub look: Look,
    /// Load the scene's file again whenever it is saved
    #[arg(long)]
    pub watch: bool,
    /// Continue a run of this scene from a checkpoint, with the solver and the step of that run
    #[arg(long, value_name = "FILE.checkpoint", conflicts_with = "solver")]
    pub resume: Option<PathBuf>,
}

impl WindowOptions {
    /// Returns what the window is to open with.
    pub fn opening(&self) -> Opening {
        limit_threads(self.what.threads);
        Opening {
            methods: vec![(self.solver, self.step)],
            manner: self.look.manner.of(self.springs_of),
            watch: self.watch,
            resume: self.resume.clone(),
            ..self.look.opening(&self.what, &self.limits)
        }
    }
}

/// Options for the start of a window.
#[derive(Args)]
#[expect(clippy::struct_excessive_bools, reason = "each is an option")]
pub struct Look {
    #[command(flatten)]
    pub manner: Drawing,
    /// Neither read nor write the settings that the window remembers
    #[arg(long)]
    pub no_config: bool,
    /// Let surfaces pass through one another and themselves
    #[arg(long, conflicts_with = "self_collision")]
    pub no_self_collision: bool,
    /// Begin paused
    #[arg(long)]
    pub paused: bool,
    /// Write what is on the screen as lines of text to stderr
    #[arg(long, hide = true)]
    pub status: bool,
}

impl Look {
    /// Returns what a window of this scene is to open with, without its runs.
    fn opening(&self, what: &SceneArgs, limits: &StepOptions) -> Opening {
        Opening {
            scene: what.scene.clone(),
            options: what.options(),
            methods: vec![],
            limits: limits.given(),
            no_contact: self.no_self_collision,
            manner: self.manner.of(None),
            light: self.manner.light,
            paused: self.paused,
            no_settings: self.no_config,
            watch: false,
            resume: None,
            status: self.status,
        }
    }
}

#[derive(Args)]
#[command(after_help = "Outputs:\n  FILE.png       the picture at the time --until\n  \
    FILE.gif       a film that loops, 25 frames per second by default\n  \
    FILE.mp4       a film as H.264, 30 frames per second by default; needs ffmpeg\n  \
    FILE-####.png  a film as pictures, 30 per second by default, numbered with as many digits as there are #\n\n\
    Frames are at exactly T + k / N, from --from to --until; no step is shortened for them. A\n\
    film that blows up or is interrupted keeps the frames until then.")]
pub struct Render {
    #[command(flatten)]
    pub run: RunOptions,
    /// File to write, whose ending chooses the format
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
    /// Frames per second of a film
    #[arg(long, value_name = "N", value_parser = rate, allow_negative_numbers = true)]
    pub fps: Option<f64>,
    /// Simulated seconds before a film begins
    #[arg(long, value_name = "T", value_parser = beginning, allow_negative_numbers = true)]
    pub from: Option<f64>,
    /// Leave out floor, background and legend: a PNG gets opacity, a GIF transparent pixels
    #[arg(long)]
    pub transparent: bool,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size, allow_hyphen_values = true)]
    pub size: (u32, u32),
    #[command(flatten)]
    pub manner: Drawing,
    /// Show the springs attached to particle I
    #[arg(long, value_name = "I", value_parser = particle, allow_negative_numbers = true)]
    pub springs_of: Option<usize>,
}

#[derive(Args)]
pub struct Compare {
    /// Two to four solvers by letter or name, each with its step in seconds or its tolerance after
    /// a colon, as in e:0.05 r:0.05; by default the solver's own
    #[arg(value_name = "SOLVER[:STEP]", value_parser = SOLVER_AND_STEP, hide_possible_values = true)]
    pub methods: Vec<(&'static Method, Option<f64>)>,
    #[command(flatten)]
    pub limits: StepOptions,
    #[command(flatten)]
    pub what: SceneArgs,
    #[command(flatten)]
    pub look: Look,
    /// Picture to write instead of opening a window, ending in .png
    #[arg(long, short, value_name = "FILE.png", requires = "until")]
    pub output: Option<PathBuf>,
    /// Simulated seconds until the picture
    #[arg(long, value_name = "T", value_parser = until, allow_negative_numbers = true, requires = "output")]
    pub until: Option<f64>,
    /// Width and height of the picture in pixels
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true, requires = "output")]
    pub size: Option<(u32, u32)>,
}

impl Compare {
    /// Returns what the window is to open with.
    ///
    /// # Errors
    /// There are fewer than two or more than four solvers.
    pub fn opening(&self) -> Result<Opening, Failure> {
        check_count(self.methods.len())?;
        limit_threads(self.what.threads);
        let methods = self.methods.iter();
        Ok(Opening {
            methods: methods.map(|(method, step)| (Some(*method), *step)).collect(),
            ..self.look.opening(&self.what, &self.limits)
        })
    }
}

/// Creates a parser of the quantity of colours.
fn quantity() -> impl TypedValueParser<Value = Quantity> {
    choice(&Quantity::ALL, |quantity| {
        let help = match quantity {
            Quantity::Speed => "Speed (m/s)",
            Quantity::Strain => "Largest strain of the springs at a particle, or of its tetrahedra",
            Quantity::Force => "Sum of the forces on a particle that is free (N)",
            Quantity::Contact => "Force by which obstacles and surfaces touch a particle (N)",
            Quantity::Error => "Distance from the reference of a comparison (m)",
        };
        (quantity.name(), help)
    })
}

/// Creates a parser of the vector of arrows.
fn arrows() -> impl TypedValueParser<Value = Arrows> {
    choice(&Arrows::ALL, |arrows| {
        let help = match arrows {
            Arrows::Velocity => "Velocity (m/s)",
            Arrows::Force => "Sum of the forces on a particle (N)",
        };
        (arrows.name(), help)
    })
}

/// Options for the look of a picture.
#[expect(clippy::struct_excessive_bools, reason = "each is an option")]
#[derive(Args, Clone, Copy)]
pub struct Drawing {
    /// Draw the wireframe instead of the surface
    #[arg(long, conflicts_with = "springs")]
    pub wireframe: bool,
    /// Draw all springs instead of the surface: structural, shear and bend springs, each in its
    /// own colour and width
    #[arg(long)]
    pub springs: bool,
    /// Draw in parallel projection instead of perspective
    #[arg(long)]
    pub orthographic: bool,
    /// Draw light objects on a dark background, for this run only
    #[arg(long, overrides_with = "light")]
    pub dark: bool,
    /// Draw on a light background, even if the panel of an earlier window chose the dark one
    #[arg(long, overrides_with = "dark")]
    pub light: bool,
    /// Colour each particle by a quantity
    #[arg(long, value_name = "QUANTITY", value_parser = quantity(), alias = "color")]
    pub colour: Option<Quantity>,
    /// Draw an arrow on each particle
    #[arg(long, value_name = "VECTOR", value_parser = arrows())]
    pub arrows: Option<Arrows>,
}

impl Drawing {
    /// Returns the look of a picture, with the springs of a particle highlighted, if one is given.
    pub fn of(self, springs_of: Option<usize>) -> Manner {
        Manner {
            style: style(self.wireframe, self.springs),
            springs_of,
            orthographic: self.orthographic,
            dark: self.dark,
            colour: self.colour,
            arrows: self.arrows,
        }
    }
}
