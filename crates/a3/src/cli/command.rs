//! The commands, their options, and the help of the program.

use std::path::PathBuf;

use a3_core::accuracy::Metric;
use a3_core::{Grid, Method};
use a3_files::arguments::{grid, step};
use a3_files::lessons::LESSONS;
use a3_files::quantity::Quantity;
use clap::builder::TypedValueParser;
use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;

use super::run::{ErrorScope, RunOptions, SceneArgs, WorkMeasure, metric};
use super::sweep::Sweep;
use super::values::{
    SCENE, SOLVER_OR_ALL, budget, choice, error, factor, horizon, pause, picture_size, rate,
    seconds,
};
#[cfg(feature = "window")]
use super::window::{Compare, Render, WindowOptions};

/// Reads the number of a lesson.
fn lesson(text: &str) -> Result<u8, String> {
    let number = text.parse().ok();
    let number = number.filter(|number| (1..=LESSONS).contains(number));
    number.ok_or_else(|| format!("lessons are numbered 1 to {LESSONS}"))
}

/// End of the help.
#[cfg(feature = "window")]
const EXAMPLES: &str = "Examples:
  a3 t 0.01                          the default cloth, explicit trapezoid, 10 ms
  a3 e 0.05 --scene simple           watch Euler's circle spiral outwards
  a3 simulate rk4 0.001 --until 2 --output state.json
  a3 render v 0.005 --until 3 --output cloth.png --size 1920x1080
  a3 render v 0.005 --until 3 --output cloth.gif --size 480x360
  a3 compare e:0.05 r:0.05 --scene simple
  a3 chart --scene mit --solvers r,v,a
  a3 choose --error 1e-3

In the window, h shows the keys.";
#[cfg(not(feature = "window"))]
const EXAMPLES: &str = "Examples:
  a3 simulate rk4 0.001 --until 2 --output state.json
  a3 chart --scene mit --solvers r,v,a
  a3 choose --error 1e-3

This a3 was built without its window and without the commands that draw scenes.";

/// Simulate cloth and other mass-spring systems, and measure how fast and how accurate each
/// solver is.
#[derive(Parser)]
#[command(name = "a3", version, max_term_width = 100)]
#[cfg_attr(feature = "window", command(args_conflicts_with_subcommands = true))]
#[command(after_help = EXAMPLES)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
    #[cfg(feature = "window")]
    #[command(flatten)]
    pub window: WindowOptions,
}

#[derive(Subcommand)]
pub enum Command {
    /// Simulate without a window and write the final state, or every frame: JSON, CSV, NPZ, OBJ,
    /// GLB, USD
    Simulate(Simulate),
    /// Simulate without a window and write a picture or a film: PNG, GIF, MP4
    #[cfg(feature = "window")]
    Render(Render),
    /// Chart speed against accuracy: every solver on your scene, its true error and its cost
    Chart(Chart),
    /// Show where each solver fails: its largest stable step on your scene, predicted and observed
    Stability(Stability),
    /// Choose the cheapest solver and step for an error, or the most accurate ones for a budget
    Choose(Choose),
    /// Find what a scene can do without: each part left out, its grids finer and coarser, and the
    /// leanest scene for an error
    Simplify(Simplify),
    /// Judge results of other programs: their errors, their order, the solver that they agree with,
    /// and the usual mistakes
    Judge(Judge),
    /// Run scenes with many solvers, steps and values of their keys, in shares on many machines
    Sweep(Sweep),
    /// Compare two to four solvers side by side, in a window or as a picture
    #[cfg(feature = "window")]
    Compare(Compare),
    /// List the scenes with their particles, springs, length of the state and forces
    Scenes(Scenes),
    /// List the solvers with their order, evaluations per step, and default step or tolerance; say
    /// which of them serve a scene
    Solvers(Solvers),
    /// Print a lesson on solvers, or the list of lessons; key F1 of the window goes through them
    Lessons {
        /// Number of the lesson
        #[arg(value_parser = lesson)]
        lesson: Option<u8>,
        /// Print the answer at once, instead of after a key
        #[arg(long, requires = "lesson")]
        answers: bool,
    },
    /// Print the completion script of a shell
    Completions {
        /// Shell that the script is for
        shell: Shell,
    },
    /// Print the manual as a man page, or write one page for each command
    Man {
        /// Folder for a3.1, a3-simulate.1, ...; by default, a single page goes to standard output
        #[arg(long, short, value_name = "FOLDER")]
        output: Option<PathBuf>,
    },
}

#[derive(Args)]
pub struct Chart {
    #[command(flatten)]
    pub what: SceneArgs,
    /// Solvers to measure and draw, such as t,r,v, or all; by default all that can run the scene
    /// are measured, and those that are cheapest for some error, and e, t, r and i, are drawn
    #[arg(long, value_name = "SOLVERS", value_delimiter = ',', value_parser = SOLVER_OR_ALL, hide_possible_values = true)]
    pub solvers: Vec<Option<&'static Method>>,
    /// Leave out the runs on finer and coarser grids that tell how much the grid itself errs
    #[arg(long)]
    pub no_model: bool,
    /// Simulated seconds; by default, as long as errors are meaningful on this scene
    #[arg(long, value_name = "T", value_parser = horizon, allow_negative_numbers = true)]
    pub until: Option<f64>,
    /// What counts as the error
    #[arg(long, default_value = "position", value_parser = metric())]
    pub error: Metric,
    #[command(flatten)]
    pub scope: ErrorScope,
    /// What counts as the cost
    #[arg(long, default_value = "time")]
    pub work: WorkMeasure,
    /// Factors by which the stiffness of the springs is multiplied, such as 1,10,100; the chart
    /// has a panel for each
    #[arg(long, value_name = "FACTORS", value_delimiter = ',', default_value = "1", value_parser = factor, allow_negative_numbers = true)]
    pub stiffness: Vec<f64>,
    /// Picture to write, ending in .svg, .pdf or .png; by default a3-chart-SCENE.svg
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Show the picture in the desktop's viewer
    #[arg(long)]
    pub open: bool,
    /// File for all runs, ending in .csv or .json; if it exists, the chart continues from it
    #[arg(long, value_name = "FILE")]
    pub data: Option<PathBuf>,
    /// File for the largest errors of each particle along x, y and z, ending in .csv; runs that
    /// --data has are measured again
    #[arg(long, value_name = "FILE")]
    pub each: Option<PathBuf>,
    /// Show as a light band how much errors of adaptive solvers vary: from each tolerance to three
    /// within 4 % of it
    #[arg(long)]
    pub spread: bool,
    /// Width and height of the picture in pixels, 96 to the inch, or `column`, 340x360, for a
    /// column of a paper
    #[arg(long, value_name = "WxH", default_value = "1200x800", value_parser = picture_size, allow_hyphen_values = true)]
    pub size: (u32, u32),
}

#[derive(Args)]
pub struct Choose {
    #[command(flatten)]
    pub what: SceneArgs,
    /// Largest error that is allowed, such as 1e-3; it is that of the positions, in m, unless --of
    /// names another
    #[arg(long, value_name = "E", value_parser = error, allow_negative_numbers = true, required_unless_present = "budget", conflicts_with = "budget")]
    pub error: Option<f64>,
    /// What counts as the error
    #[arg(long, value_name = "QUANTITY", default_value = "position", value_parser = metric())]
    pub of: Metric,
    #[command(flatten)]
    pub scope: ErrorScope,
    /// What counts as the cost
    #[arg(long, default_value = "time", conflicts_with = "budget")]
    pub work: WorkMeasure,
    /// Computing time in ms for each frame of 1/60 s: the most accurate solver within it is chosen
    #[arg(long, value_name = "MS_PER_FRAME", value_parser = budget, allow_negative_numbers = true)]
    pub budget: Option<f64>,
    /// Leave out the runs on finer and coarser grids that tell how much the grid itself errs
    #[arg(long)]
    pub no_model: bool,
    /// Simulated seconds; by default, as long as errors are meaningful on this scene
    #[arg(long, value_name = "T", value_parser = horizon, allow_negative_numbers = true)]
    pub until: Option<f64>,
}

/// Creates a parser of the quantity by which models of a scene are compared.
fn compared() -> impl TypedValueParser<Value = Quantity> {
    choice(&Quantity::ALL, |quantity| {
        let help = match quantity {
            Quantity::Position => "Positions of the particles, root mean square (m)",
            Quantity::Centre => "Path of the centre of mass (m)",
            Quantity::Energy => "Energy that the motion has gained or lost since the start (J)",
        };
        (quantity.name(), help)
    })
}

#[derive(Args)]
pub struct Simplify {
    #[command(flatten)]
    pub what: SceneArgs,
    /// Largest allowed error, in m (J for energy), such as 1e-2; it covers omitted parts, a coarser
    /// grid and the time steps together
    #[arg(long, value_name = "E", value_parser = error, allow_negative_numbers = true)]
    pub error: f64,
    #[command(flatten)]
    pub scope: ErrorScope,
    /// Quantity that is compared; where the motion is chaotic, the centre of mass and the energy
    /// are known for longer than the positions
    #[arg(long, value_name = "QUANTITY", default_value = "position", value_parser = compared())]
    pub of: Quantity,
    /// Simulated seconds; by default, as long as errors are meaningful on this scene
    #[arg(long, value_name = "T", value_parser = horizon, allow_negative_numbers = true)]
    pub until: Option<f64>,
    /// File for the leanest scene, ending in .toml, with its solver and step
    #[arg(long, short, value_name = "FILE.toml")]
    pub output: Option<PathBuf>,
    /// File for the effects of all models, ending in .csv or .json; if it exists, models in it are
    /// not measured again
    #[arg(long, value_name = "FILE")]
    pub data: Option<PathBuf>,
    /// Chart of the error against the cost, with the grid and the step both varied, ending in .svg,
    /// .pdf or .png
    #[arg(long, value_name = "FILE")]
    pub chart: Option<PathBuf>,
    /// Show the chart in the desktop's viewer; without --chart it is a3-simplify-SCENE.svg
    #[arg(long)]
    pub open: bool,
    /// Width and height of the chart in pixels, 96 to the inch, or `column`, 340x360, for a column
    /// of a paper
    #[arg(long, value_name = "WxH", default_value = "1200x800", value_parser = picture_size, allow_hyphen_values = true)]
    pub size: (u32, u32),
}

#[derive(Args)]
#[command(after_help = "Outputs, all in m and s, y up:\n  \
    FILE.json      the final state at full precision; with --fps, the states of all frames\n  \
    FILE.csv       all frames at full precision: frame,time,particle,x,y,z,vx,vy,vz\n  \
    FILE.npz       arrays of all frames for NumPy: time, positions, velocities and masses\n  \
    FILE.obj       the final surface with normals, or points and lines where there is no surface\n  \
    FILE-####.obj  one such file for each frame, numbered with as many digits as there are #\n  \
    FILE.glb       glTF 2.0 with a morph target for each frame, at most 600\n  \
    FILE.usda      Universal Scene Description: meshes, curves and points with time samples\n  \
    FILE.vtu       the final tetrahedra of solids with their stress, for ParaView; also FILE-####.vtu\n\n\
    Frames are at exactly k / N, from 0 to --until; no step is shortened for them. Particles keep\n\
    their order and numbers in all files. OBJ, GLB and USD are in single precision. A run that blows\n\
    up or is interrupted leaves no file, except for the finished files of a sequence.")]
pub struct Simulate {
    #[command(flatten)]
    pub run: RunOptions,
    /// File to write, whose ending chooses the format; - writes JSON to standard output
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
    /// Frames per second of outputs that have several; 30 by default
    #[arg(long, value_name = "N", value_parser = rate, allow_negative_numbers = true)]
    pub fps: Option<f64>,
    /// File for a summary in JSON: energy at the start and at the end, its largest drift, the
    /// largest stretch, steps, evaluations and real time; - is standard output
    #[arg(long, value_name = "FILE.json")]
    pub summary: Option<PathBuf>,
    /// Fail if surfaces pass through one another: every edge is checked against every triangle,
    /// exactly, sixty times a simulated second
    #[arg(long)]
    pub check: bool,
    /// File to which the whole run is saved from time to time, when it is interrupted, and at the
    /// end
    #[arg(long, value_name = "FILE.checkpoint")]
    pub checkpoint: Option<PathBuf>,
    /// Real time between two checkpoints, in seconds
    #[arg(long, value_name = "S", default_value = "60", value_parser = pause, requires = "checkpoint")]
    pub every: f64,
    /// Continue a run of this scene from a checkpoint, with the solver and the step of that run;
    /// the results are exactly those of a run that had never stopped
    #[arg(long, value_name = "FILE.checkpoint")]
    pub resume: Option<PathBuf>,
}

#[derive(Args)]
pub struct Solvers {
    /// Say which solvers serve this scene, and why the others do not: a name that `a3 scenes`
    /// lists, or a file of your own
    #[arg(long, value_name = "NAME|FILE", value_parser = SCENE, hide_possible_values = true)]
    pub scene: Option<String>,
    /// Print which kinds of scenes each solver serves, as a table in Markdown
    #[arg(long, conflicts_with = "scene")]
    pub kinds: bool,
}

#[derive(Args)]
pub struct Stability {
    #[command(flatten)]
    pub what: SceneArgs,
    /// Solvers to examine, such as t,r,v; by default all that can run the scene
    #[arg(long, value_name = "SOLVERS", value_delimiter = ',', value_parser = SOLVER_OR_ALL, hide_possible_values = true)]
    pub solvers: Vec<Option<&'static Method>>,
    /// Step in seconds by which the picture multiplies the eigenvalues; by default the time in
    /// which the fastest motion turns by one radian
    #[arg(long, value_name = "STEP", value_parser = step, allow_negative_numbers = true)]
    pub step: Option<f64>,
    /// Picture to write, ending in .svg, .pdf or .png; by default a3-stability-SCENE.svg
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Show the picture in the desktop's viewer
    #[arg(long)]
    pub open: bool,
    /// File for all limits in seconds, ending in .json
    #[arg(long, value_name = "FILE")]
    pub data: Option<PathBuf>,
    /// Width and height of the picture in pixels, 96 to the inch, or `column`, 340x360, for a
    /// column of a paper
    #[arg(long, value_name = "WxH", default_value = "1400x1000", value_parser = picture_size, allow_hyphen_values = true)]
    pub size: (u32, u32),
}

#[derive(Args)]
pub struct Scenes {
    /// Print the file of a scene, as a start for one of your own
    #[arg(long, value_name = "NAME", value_parser = SCENE, hide_possible_values = true)]
    pub print: Option<String>,
    /// Print the scene as JSON with its masses, springs, pins, gravity, drag, and the positions and
    /// velocities at the start, for programs that read no scene files; a3 reads this file too
    #[arg(long, requires = "print")]
    pub list: bool,
    /// Rows and columns of the cloth in the list, such as 10x10
    #[arg(long, value_name = "ROWSxCOLS", requires = "list", value_parser = grid, allow_hyphen_values = true)]
    pub grid: Option<Grid>,
    /// Print the JSON Schema of scene files, with which editors complete and check them
    #[arg(long, conflicts_with = "print")]
    pub schema: bool,
    /// List the materials that cloths, solids and bodies of scene files may name
    #[arg(long, conflicts_with_all = ["print", "schema"])]
    pub materials: bool,
}

#[derive(Args)]
#[command(
    after_help = "Files, with times in s from 0 on, positions in m, and velocities in m/s if the program has them:\n  \
    FILE.csv   t,x0,y0,z0,x1,... and perhaps vx0,vy0,vz0,...: a row for each time; or, as a3 simulate\n             \
               writes them, time,particle,x,y,z,vx,vy,vz: a row for each particle. The names in the first\n             \
               line decide: other columns are left out, and a column seconds is the computing time;\n             \
               FILE.txt and FILE.tsv too\n  \
    FILE.json  {\"t\": [0, ...], \"x\": [[[x, y, z], ...], ...], \"v\": ..., \"seconds\": 0.5}, or the JSON of a3\n             \
               simulate\n  \
    FILE.npz   np.savez(FILE, t=t, x=x, v=v), with x and v of the shape (times, particles, 3)\n\n\
    Particles are in the order of the scene, which a3 scenes --print NAME --list tells together with all\n\
    masses, springs and pins. Steps that the rows lie apart by, or whole parts of this time, are tried with\n\
    every solver, and with the usual mistakes."
)]
pub struct Judge {
    /// Files with the states of other programs, ending in .csv, .txt, .tsv, .json or .npz; give
    /// several runs of a program with different steps to see its order
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub what: SceneArgs,
    /// Fail, with exit code 1, if the positions of a file err by more than this at any time, in m
    #[arg(long, value_name = "E", value_parser = error, allow_negative_numbers = true)]
    pub within: Option<f64>,
    /// Step of the program in seconds; by default, the distance of the states and whole parts of it
    /// are tried
    #[arg(long, value_name = "H", value_parser = step, allow_negative_numbers = true)]
    pub step: Option<f64>,
    /// Judge the states up to this time, in seconds; by default, as long as errors are meaningful
    /// on this scene
    #[arg(long, value_name = "T", value_parser = horizon, allow_negative_numbers = true)]
    pub until: Option<f64>,
    /// Computing time of each file's run in seconds, in the order of the files, such as 0.8,1.6
    #[arg(long, value_name = "S", value_delimiter = ',', value_parser = seconds, allow_negative_numbers = true)]
    pub seconds: Vec<f64>,
    /// Chart of speed against accuracy of all solvers with the files in it, ending in .svg, .pdf or
    /// .png
    #[arg(long, value_name = "FILE")]
    pub chart: Option<PathBuf>,
    /// Width and height of the chart in pixels, 96 to the inch, or `column`, 340x360, for a column
    /// of a paper
    #[arg(long, value_name = "WxH", default_value = "1200x800", value_parser = picture_size, allow_hyphen_values = true)]
    pub size: (u32, u32),
    /// File for the judgements in JSON, with the errors at all times; - is standard output, in
    /// place of the text
    #[arg(long, value_name = "FILE.json")]
    pub summary: Option<PathBuf>,
}
