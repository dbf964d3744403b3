//! The program: reads the command line and runs the command.

use std::ffi::OsString;
use std::process::ExitCode;

use a3_files::failure::Failure;
use a3_files::lessons;
use a3_files::{interrupt, terminal};
#[cfg(feature = "window")]
use a3_studio as window;
use clap::Parser;

#[cfg(feature = "window")]
use crate::cli::Compare;
use crate::cli::{self, Cli, Command};
#[cfg(feature = "window")]
use crate::commands::{answer, render};
use crate::commands::{
    chart, choose, judge, list, manual, simplify, simulate, solvers, stability, sweep,
};

/// Runs the command of the command line, and returns the exit code of the program.
#[must_use]
pub fn main() -> ExitCode {
    let args: Vec<_> = std::env::args_os().collect();
    #[cfg(all(target_os = "linux", feature = "window"))]
    name_runtime_folder(&args);
    ExitCode::from(run(&args))
}

/// Replaces the program by itself with a name for the folder of the session's sockets, if it draws
/// and no session has named one: Mesa's layer of Vulkan complains about that on standard error,
/// although nothing is missing.
#[cfg(all(target_os = "linux", feature = "window"))]
fn name_runtime_folder(args: &[OsString]) {
    use std::os::unix::process::CommandExt;
    use std::process;
    const NAME: &str = "XDG_RUNTIME_DIR";
    let command = Cli::try_parse_from(args).map(|cli| cli.command);
    let draws = matches!(command, Ok(None | Some(Command::Compare(_) | Command::Render(_))));
    if draws
        && std::env::var_os(NAME).is_none_or(|folder| folder.is_empty())
        && let (Ok(own), [name, rest @ ..]) = (std::env::current_exe(), args)
    {
        // This returns only if it fails.
        let mut again = process::Command::new(own);
        let _ = again.arg0(name).args(rest).env(NAME, "/dev/null").exec();
    }
}

/// Runs the command of a command line, which begins with the name of the program, and returns the
/// exit code. The signals that end a program are its own from then on.
#[must_use]
pub fn run(args: &[OsString]) -> u8 {
    interrupt::start();
    let result = match Cli::try_parse_from(args) {
        Ok(cli) => match cli.command {
            #[cfg(feature = "window")]
            None => window::open(&cli.window.opening(), answer::answer),
            #[cfg(not(feature = "window"))]
            None => Err(Failure::usage(
                "this a3 was built without its window: give a command; --help lists them",
            )),
            #[cfg(feature = "window")]
            Some(Command::Compare(options)) => compare(&options),
            Some(Command::Simulate(options)) => simulate::run(&options),
            #[cfg(feature = "window")]
            Some(Command::Render(options)) => render::run(&options),
            Some(Command::Chart(options)) => chart::run(&options),
            Some(Command::Stability(options)) => stability::run(&options),
            Some(Command::Choose(options)) => choose::run(&options),
            Some(Command::Simplify(options)) => simplify::run(&options),
            Some(Command::Judge(options)) => judge::run(&options),
            Some(Command::Sweep(options)) => sweep::run(&options),
            Some(Command::Scenes(options)) => list::scenes(&options),
            Some(Command::Solvers(options)) => solvers::run(&options),
            Some(Command::Lessons { lesson, answers }) => lessons::print(lesson, answers),
            Some(Command::Completions { shell }) => manual::completions(shell),
            Some(Command::Man { output }) => manual::run(output.as_deref()),
        },
        Err(error) => cli::explain(&error, args),
    };
    let Err(failure) = result else {
        terminal::tell_notes();
        return 0;
    };
    let code = match failure {
        Failure::Usage(_) | Failure::Input(_) => 2,
        Failure::Run(_) => 1,
        Failure::Interrupted(_) => {
            terminal::warn(&failure.to_string());
            return interrupt::exit_code();
        }
    };
    terminal::warn(&format!("error: {failure}"));
    code
}

/// Opens the window on several runs, or draws their picture.
#[cfg(feature = "window")]
fn compare(options: &Compare) -> Result<(), Failure> {
    let opening = options.opening()?;
    match (&options.output, options.until) {
        (Some(path), Some(until)) => window::compare::run(&opening, path, until, options.size),
        (None, None) => window::open(&opening, answer::answer),
        _ => Err(Failure::usage("a picture takes both --output and --until")),
    }
}
