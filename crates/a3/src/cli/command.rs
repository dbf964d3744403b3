//! The commands, and the help of the program.

#[cfg(not(target_arch = "wasm32"))]
use std::path::PathBuf;

use clap::{Parser, Subcommand};
#[cfg(not(target_arch = "wasm32"))]
use clap_complete::Shell;

use super::chart::Chart;
use super::choose::Choose;
#[cfg(not(target_arch = "wasm32"))]
use super::judge::Judge;
use super::scenes::Scenes;
use super::simplify::Simplify;
use super::simulate::Simulate;
use super::solvers::Solvers;
use super::stability::Stability;
#[cfg(not(target_arch = "wasm32"))]
use super::sweep::Sweep;
#[cfg(feature = "window")]
use super::window::{Compare, Render, WindowOptions};

/// Number of lessons.
pub const LESSONS: u8 = 8;

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
    /// PC2, GLB, USD
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
    #[cfg(not(target_arch = "wasm32"))]
    Judge(Judge),
    /// Run scenes with many solvers, steps and values of their keys, in shares on many machines
    #[cfg(not(target_arch = "wasm32"))]
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
    },
    /// Print the completion script of a shell
    #[cfg(not(target_arch = "wasm32"))]
    Completions {
        /// Shell that the script is for
        shell: Shell,
    },
    /// Print the manual as a man page, or write one page for each command
    #[cfg(not(target_arch = "wasm32"))]
    Man {
        /// Folder for a3.1, a3-simulate.1, ...; by default, a single page goes to standard output
        #[arg(long, short, value_name = "FOLDER")]
        output: Option<PathBuf>,
    },
}
