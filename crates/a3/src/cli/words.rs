//! The words of a command line that opens a window, from a link, a lesson or the window itself.

use a3_files::failure::Failure;
use a3_studio::session::Opening;
use clap::Parser;

use super::{Cli, Command, explain};

/// Reads the words that follow the name of the program.
///
/// # Errors
/// An option is wrong, or the command opens no window.
pub fn read(words: &[String]) -> Result<Opening, Failure> {
    let program = ["a3".to_owned()];
    let options = Cli::try_parse_from(program.iter().chain(words));
    let options = options.map_err(|error| match explain(&error, &[]) {
        Err(failure) => failure,
        Ok(()) => Failure::usage(error),
    })?;
    match options.command {
        None => Ok(options.window.opening()),
        Some(Command::Compare(options)) => options.opening(),
        Some(_) => Err(Failure::usage(
            "a page has no command except compare: the other commands need the program",
        )),
    }
}
