//! a3: mass-spring systems in a window and without one.

#![forbid(unsafe_code)]

mod app;
mod bounds;
mod caught;
mod chart;
mod checkpoint;
mod choose;
mod cli;
mod command_line;
mod compare;
mod export;
mod failure;
mod film;
mod frames;
mod headless;
#[cfg(test)]
mod hostile;
mod hud;
mod interrupt;
mod keep;
mod lessons;
mod list;
mod manual;
mod output;
mod painter;
mod progress;
mod recorder;
mod render;
mod rounding;
mod scene_file;
mod session;
mod settings;
mod setup;
mod show;
mod simulate;
mod stability;
mod summary;
mod verdict;
mod window;

use std::process::ExitCode;

use clap::Parser;
use cli::{Cli, Command};
use failure::Failure;

fn main() -> ExitCode {
    interrupt::start();
    let result = match Cli::try_parse() {
        Ok(cli) => match cli.command {
            None => window::run(&cli.window),
            Some(Command::Compare(options)) if options.output.is_none() => {
                window::compare(&options)
            }
            Some(Command::Compare(options)) => compare::run(&options),
            Some(Command::Simulate(options)) => simulate::run(&options),
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
