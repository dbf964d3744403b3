//! a3: mass-spring systems in a window and without one. The window, pictures and films are the
//! feature `window`.

#![forbid(unsafe_code)]
// Parts of modules that serve both are for the window alone; a build with it finds what is dead.
#![cfg_attr(not(feature = "window"), allow(dead_code, unused_imports))]

#[cfg(feature = "window")]
mod app;
#[cfg(feature = "window")]
mod begin;
mod bounds;
#[cfg(feature = "window")]
mod caught;
mod chart;
mod checkpoint;
mod choose;
mod cli;
#[cfg(feature = "window")]
mod command_line;
#[cfg(feature = "window")]
mod compare;
mod export;
mod failure;
#[cfg(feature = "window")]
mod film;
mod frames;
#[cfg(feature = "window")]
mod headless;
mod holding;
#[cfg(test)]
mod hostile;
#[cfg(feature = "window")]
mod hud;
mod interrupt;
#[cfg(feature = "window")]
mod keep;
mod lessons;
mod list;
mod manual;
mod output;
#[cfg(feature = "window")]
mod painter;
mod progress;
#[cfg(feature = "window")]
mod recorder;
#[cfg(feature = "window")]
mod render;
mod rounding;
mod scene_file;
#[cfg(feature = "window")]
mod session;
#[cfg(feature = "window")]
mod settings;
mod setup;
#[cfg(feature = "window")]
mod show;
mod simulate;
mod stability;
mod summary;
mod surfaces;
mod verdict;
#[cfg(feature = "window")]
mod window;

use std::process::ExitCode;

use clap::Parser;
use cli::{Cli, Command};
use failure::Failure;

/// Does what the command line asks for, and returns the exit code of the program.
#[must_use]
pub fn main() -> ExitCode {
    interrupt::start();
    let result = match Cli::try_parse() {
        Ok(cli) => match cli.command {
            #[cfg(feature = "window")]
            None => window::run(&cli.window),
            #[cfg(not(feature = "window"))]
            None => Err(Failure::usage(
                "this a3 was built without its window: give a command; --help lists them",
            )),
            #[cfg(feature = "window")]
            Some(Command::Compare(options)) if options.output.is_none() => {
                window::compare(&options)
            }
            #[cfg(feature = "window")]
            Some(Command::Compare(options)) => compare::run(&options),
            Some(Command::Simulate(options)) => simulate::run(&options),
            #[cfg(feature = "window")]
            Some(Command::Render(options)) => render::run(&options),
            Some(Command::Chart(options)) => chart::run(&options),
            Some(Command::Stability(options)) => stability::run(&options),
            Some(Command::Choose(options)) => choose::run(&options),
            Some(Command::Scenes(options)) => list::scenes(&options),
            Some(Command::Solvers) => list::solvers(),
            Some(Command::Lessons { lesson }) => lessons::print(lesson),
            Some(Command::Completions { shell }) => manual::completions(shell),
            Some(Command::Man { output }) => manual::run(output.as_deref()),
        },
        Err(error) => cli::explain(&error),
    };
    let (why, code) = match result {
        Ok(()) => return ExitCode::SUCCESS,
        Err(Failure::Usage(why)) => (why, 2),
        Err(Failure::Run(why)) => (why, 1),
        Err(Failure::Interrupted(why)) => {
            output::warn(&why);
            return ExitCode::from(interrupt::exit_code());
        }
    };
    output::warn(&format!("error: {why}"));
    ExitCode::from(code)
}
