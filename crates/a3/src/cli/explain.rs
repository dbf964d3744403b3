//! What the program says when the command line cannot be understood.

use clap::CommandFactory;
use clap::error::ErrorKind;

use super::Cli;
use super::values::{UNKNOWN_SOLVER, step};
use crate::failure::Failure;
use crate::output;

/// The refused value: the text between the first quotes.
fn value_of(head: &str) -> &str {
    head.split('\'').nth(1).unwrap_or_default()
}

/// Prints help and version as clap does, and returns any mistake in one line.
pub fn explain(error: &clap::Error) -> Result<(), Failure> {
    if matches!(
        error.kind(),
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion
    ) {
        return output::said(error.print());
    }
    let text = error.render().to_string();
    // The first paragraph is the error; usage and hints follow.
    let words: Vec<_> = text
        .lines()
        .take_while(|line| !line.is_empty())
        .map(str::trim)
        .collect();
    let line = words.join(" ");
    let line = line.strip_prefix("error: ").unwrap_or(&line).to_owned();
    let tip = text
        .lines()
        .find_map(|line| line.trim().strip_prefix("tip: "));
    Err(Failure::Usage(match (error.kind(), tip) {
        // The first word may be meant as a solver or as a command.
        (ErrorKind::ValueValidation, _) if line.contains(UNKNOWN_SOLVER) => {
            let cli = Cli::command();
            let commands: Vec<_> = cli.get_subcommands().map(clap::Command::get_name).collect();
            format!("{line}; the commands are {}, and come first", commands.join(", "))
        }
        // The parser's own words end with what is right; those about a scene file begin with its
        // name.
        (ErrorKind::ValueValidation, _) => match line.split_once("': ") {
            Some((head, rest)) if head.contains(" '") && rest.starts_with(value_of(head)) => {
                rest.into()
            }
            _ => line,
        },
        (ErrorKind::ArgumentConflict | ErrorKind::MissingRequiredArgument, _)
            if line.contains("--error") =>
        {
            "choose takes either --error E (in m) or --budget MS (in ms per frame)".into()
        }
        (ErrorKind::ArgumentConflict, _) => {
            "a command comes before everything else, as in `a3 chart --scene flag`; without one, there is a solver and a step, as in `a3 t 0.01`".into()
        }
        // clap takes -1e-3 for options, but not -0.001.
        (ErrorKind::UnknownArgument, _) if line.contains("argument '-") && !line.contains("argument '--") => {
            format!("{line}; {}", step("").unwrap_err())
        }
        (_, Some(tip)) => format!("{line}; {tip}"),
        (_, None) => format!("{line}; --help explains the options"),
    }))
}
