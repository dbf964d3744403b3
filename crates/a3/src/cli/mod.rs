//! The command line: its commands, arguments and help.

mod explain;
mod values;

use std::path::PathBuf;

use a3_core::{Grid, Method};
use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;

use crate::failure::Failure;
use crate::scene_file::Source;
use values::{
    beginning, budget, error, factor, grid, horizon, particle, picture_size, rate, size, solver,
    solver_and_step, step, until,
};

pub use explain::explain;

/// Physical simulation of mass-spring systems: pull at cloth, and see which integrator holds.
#[derive(Parser)]
#[command(version, args_conflicts_with_subcommands = true, max_term_width = 100)]
#[command(
    after_help = "Examples:\n  a3 t 0.01                          the default cloth, explicit trapezoid, 10 ms\n  \
    a3 e 0.05 --scene simple           watch Euler's circle spiral outwards\n  \
    a3 simulate rk4 0.001 --until 2 --output state.json\n  \
    a3 render v 0.005 --until 3 --output cloth.png --size 1920x1080\n  \
    a3 render v 0.005 --until 3 --output cloth.gif --size 480x360\n  \
    a3 compare e:0.05 r:0.05 --scene simple\n\nIn the window, h shows the keys."
)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
    #[command(flatten)]
    pub window: WindowOptions,
}

#[derive(Subcommand)]
pub enum Command {
    /// Simulate without a window and write the final state, or every frame: JSON, CSV, OBJ, PC2, GLB
    Simulate(Simulate),
    /// Simulate without a window and write a picture or a film: PNG, GIF, MP4
    Render(Render),
    /// Chart speed against accuracy: every solver on your scene, its true error and its cost
    Chart(Chart),
    /// Show where each solver fails: its largest stable step on your scene, predicted and observed
    Stability(Stability),
    /// Choose the cheapest solver and step for an error, or the most accurate for a budget
    Choose(Choose),
    /// Compare two to four methods side by side, in a window or as PNG
    Compare(Compare),
    /// List the scenes: particles, springs, length of the state, forces
    Scenes(Scenes),
    /// List the solvers: order, evaluations per step, default step or tolerance
    Solvers,
    /// Print what a shell needs to complete what is typed
    Completions {
        /// Which shell
        shell: Shell,
    },
    /// Print the manual as a man page, or write a page for each command
    Man {
        /// Folder for a3.1, a3-simulate.1, ...; without it, one page with everything to standard output
        #[arg(long, short, value_name = "FOLDER")]
        output: Option<PathBuf>,
    },
}

/// What is simulated.
#[derive(Args, Clone)]
pub struct What {
    /// Scene, one of those that `a3 scenes` lists, or a file of your own
    #[arg(long, value_name = "NAME|FILE", default_value = "cloth", value_parser = Source::find)]
    pub scene: Source,
    /// Rows and columns of a cloth, such as 30x40
    #[arg(long, value_name = "ROWSxCOLS", value_parser = grid, allow_hyphen_values = true)]
    pub grid: Option<Grid>,
    /// Let the wind blow
    #[arg(long)]
    pub wind: bool,
    /// Swing the pins
    #[arg(long)]
    pub swing: bool,
}

#[derive(Args)]
pub struct WindowOptions {
    /// Solver by letter or name: e, t, r, ... (`a3 solvers` lists them); without it, the scene's own, or t
    #[arg(value_parser = solver)]
    pub solver: Option<&'static Method>,
    /// Step in seconds, or relative tolerance of an adaptive solver; without it, the solver's own
    #[arg(value_parser = step, allow_negative_numbers = true)]
    pub step: Option<f64>,
    #[command(flatten)]
    pub what: What,
    /// Show the springs attached to particle I, and list them
    #[arg(long, value_name = "I", value_parser = particle, allow_negative_numbers = true)]
    pub springs_of: Option<usize>,
    #[command(flatten)]
    pub look: Look,
    /// Load the scene's file again whenever it is saved
    #[arg(long)]
    pub watch: bool,
}

/// How a window begins.
#[derive(Args)]
pub struct Look {
    /// Begin with the wireframe
    #[arg(long)]
    pub wireframe: bool,
    /// Begin paused
    #[arg(long)]
    pub paused: bool,
    /// Write what is on the screen as lines of text to stderr
    #[arg(long, hide = true)]
    pub status: bool,
}

#[derive(Args)]
pub struct Scenes {
    /// Print the file of a scene, as a start for one of your own
    #[arg(long, value_name = "NAME", value_parser = Source::find)]
    pub print: Option<Source>,
    /// Print the JSON Schema of scene files, by which editors complete and check them
    #[arg(long, conflicts_with = "print")]
    pub schema: bool,
}

#[derive(Args)]
#[command(after_help = "Outputs, all in m and s, y up:\n  \
    FILE.json      the final state at full precision; with --fps, that of all frames\n  \
    FILE.csv       frames at full precision: frame,time,particle,x,y,z,vx,vy,vz\n  \
    FILE.obj       the final surface with normals; without a surface points and lines\n  \
    FILE-####.obj  the same of each frame, as many digits as #\n  \
    FILE.pc2       a PointCache2, and beside it FILE.obj, the mesh that it moves\n  \
    FILE.glb       glTF 2.0 with a morph target a frame, 600 at most\n\n\
    Frames are at k / N exactly, from 0 to --until; steps that would pass one are shortened. Particles\n\
    keep their order and numbers in all files. OBJ, PC2 and GLB are in single precision. A run that blows\n\
    up or is interrupted writes nothing, but for the whole files of a sequence. In Blender a PC2 is for the\n\
    modifier Mesh Cache, its axes left as they are.")]
pub struct Simulate {
    #[command(flatten)]
    pub run: RunOptions,
    /// File to write: its ending says what; - is JSON to standard output
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
    /// Frames a second, of files that have several; 30 unless it is said
    #[arg(long, value_name = "N", value_parser = rate, allow_negative_numbers = true)]
    pub fps: Option<f64>,
    /// File for a summary as JSON, or - for standard output: energy at the beginning and the end and its largest
    /// drift, the largest stretch, steps, evaluations, real time
    #[arg(long, value_name = "FILE.json")]
    pub summary: Option<PathBuf>,
}

#[derive(Args)]
#[command(after_help = "Outputs:\n  FILE.png       the picture at the end\n  \
    FILE.gif       a film that loops, 25 frames a second unless --fps says otherwise\n  \
    FILE.mp4       a film as H.264, by an installed ffmpeg, 30 frames a second\n  \
    FILE-####.png  a film as numbered pictures, as many digits as #, 30 frames a second\n\n\
    Frames are at T + k / N exactly, from --from to --until; steps that would pass one are shortened. A film that\n\
    blows up or is interrupted keeps the frames until then.")]
pub struct Render {
    #[command(flatten)]
    pub run: RunOptions,
    /// File to write: its ending says what
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
    /// Frames a second of a film
    #[arg(long, value_name = "N", value_parser = rate, allow_negative_numbers = true)]
    pub fps: Option<f64>,
    /// Simulated seconds before a film begins
    #[arg(long, value_name = "T", value_parser = beginning, allow_negative_numbers = true)]
    pub from: Option<f64>,
    /// Leave out floor and background: PNG with opacity, GIF with transparent pixels
    #[arg(long)]
    pub transparent: bool,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size, allow_hyphen_values = true)]
    pub size: (u32, u32),
    /// Draw the wires instead of the surface
    #[arg(long)]
    pub wireframe: bool,
    /// Show the springs attached to particle I
    #[arg(long, value_name = "I", value_parser = particle, allow_negative_numbers = true)]
    pub springs_of: Option<usize>,
}

/// What counts as the error.
#[derive(Clone, Copy, ValueEnum, PartialEq)]
pub enum Error {
    /// Of positions, root mean square over the particles (m)
    Position,
    /// Of the total energy (J)
    Energy,
    /// Of the springs' lengths over their rest lengths, root mean square
    Strain,
}

/// What counts as the cost.
#[derive(Clone, Copy, ValueEnum, PartialEq)]
pub enum Work {
    /// Time on this machine
    Seconds,
    /// Evaluations of the forces: the same on every machine
    Evaluations,
}

#[derive(Args)]
pub struct Chart {
    #[command(flatten)]
    pub what: What,
    /// Solvers to compare, such as t,r,v; without it, all that serve the scene
    #[arg(long, value_name = "SOLVERS", value_delimiter = ',', value_parser = solver)]
    pub solvers: Vec<&'static Method>,
    /// Simulated seconds; without it, as long as errors mean something on this scene
    #[arg(long, value_name = "T", value_parser = horizon, allow_negative_numbers = true)]
    pub until: Option<f64>,
    /// What counts as the error
    #[arg(long, default_value = "position")]
    pub error: Error,
    /// What counts as the cost
    #[arg(long, default_value = "seconds")]
    pub work: Work,
    /// A panel for each factor of the springs' stiffness, such as 1,10,100
    #[arg(long, value_name = "FACTORS", value_delimiter = ',', default_value = "1", value_parser = factor, allow_negative_numbers = true)]
    pub stiffness: Vec<f64>,
    /// Picture to write, ending in .svg or .png; without it, a3-chart-SCENE.svg
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// File of all runs, ending in .csv or .json; if it is there, the chart goes on from it
    #[arg(long, value_name = "FILE")]
    pub data: Option<PathBuf>,
    /// Width and height of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "1200x800", value_parser = picture_size, allow_hyphen_values = true)]
    pub size: (u32, u32),
}

#[derive(Args)]
pub struct Stability {
    #[command(flatten)]
    pub what: What,
    /// Solvers to look at, such as t,r,v; without it, all that serve the scene
    #[arg(long, value_name = "SOLVERS", value_delimiter = ',', value_parser = solver)]
    pub solvers: Vec<&'static Method>,
    /// Step in seconds at which the picture shows the eigenvalues; without it, one radian of the fastest motion
    #[arg(long, value_name = "STEP", value_parser = step, allow_negative_numbers = true)]
    pub step: Option<f64>,
    /// Picture to write, ending in .svg or .png; without it, a3-stability-SCENE.svg
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Width and height of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "1400x1000", value_parser = picture_size, allow_hyphen_values = true)]
    pub size: (u32, u32),
}

#[derive(Args)]
pub struct Choose {
    #[command(flatten)]
    pub what: What,
    /// Largest RMS error of the positions in m, such as 1e-3
    #[arg(long, value_name = "E", value_parser = error, allow_negative_numbers = true, required_unless_present = "budget", conflicts_with = "budget")]
    pub error: Option<f64>,
    /// Computing time for each frame of 1/60 s in ms: chooses the most accurate within it
    #[arg(long, value_name = "MS_PER_FRAME", value_parser = budget, allow_negative_numbers = true)]
    pub budget: Option<f64>,
    /// Simulated seconds; without it, as long as errors mean something on this scene
    #[arg(long, value_name = "T", value_parser = horizon, allow_negative_numbers = true)]
    pub until: Option<f64>,
}

#[derive(Args)]
pub struct Compare {
    /// Two to four solvers by letter or name, each with its step in seconds (or tolerance): e:0.05 r:0.05; without it, the solver's own
    #[arg(value_name = "SOLVER[:STEP]", value_parser = solver_and_step)]
    pub methods: Vec<(&'static Method, Option<f64>)>,
    #[command(flatten)]
    pub what: What,
    #[command(flatten)]
    pub look: Look,
    /// File to write instead of opening a window, ending in .png
    #[arg(long, short, value_name = "FILE.png", requires = "until")]
    pub output: Option<PathBuf>,
    /// Simulated seconds up to the picture; the last step is shortened to end exactly there
    #[arg(long, value_name = "T", value_parser = until, allow_negative_numbers = true, requires = "output")]
    pub until: Option<f64>,
    /// Width and height of the picture in pixels
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true, requires = "output")]
    pub size: Option<(u32, u32)>,
}

/// A run without a window.
#[derive(Args)]
pub struct RunOptions {
    /// Solver by letter or name; without it, the scene's own, or t
    #[arg(value_parser = solver)]
    pub solver: Option<&'static Method>,
    /// Step in seconds, or relative tolerance of an adaptive solver (a, x, f); without it, the solver's own
    #[arg(value_parser = step, allow_negative_numbers = true)]
    pub step: Option<f64>,
    /// Simulated seconds, or the scene's own; the last step is shortened to end exactly there
    #[arg(long, value_name = "T", value_parser = until, allow_negative_numbers = true)]
    pub until: Option<f64>,
    #[command(flatten)]
    pub what: What,
}

impl RunOptions {
    /// The end of the run (s).
    pub fn end(&self) -> Result<f64, Failure> {
        let own = self.what.scene.description.duration;
        self.until.or(own).ok_or_else(|| {
            Failure::usage("how long? give --until T in seconds, such as --until 10")
        })
    }
}
