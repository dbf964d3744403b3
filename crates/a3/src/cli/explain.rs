//! Messages for a command line that cannot be understood.

use std::error::Error;
use std::ffi::OsString;

use a3_files::failure::Failure;
use a3_files::terminal;
use a3_scenes::nearest;
use clap::CommandFactory;
use clap::error::{ContextKind, ContextValue, ErrorKind};

use super::command::Cli;

/// Largest number of characters of a quoted argument.
const MAX_QUOTED_CHARS: usize = 80;

/// Prints help and version as clap does, and returns any mistake of the arguments in one line.
pub fn explain(error: &clap::Error, args: &[OsString]) -> Result<(), Failure> {
    if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
        return terminal::check_write(error.print());
    }
    Err(Failure::Usage(mistake(error, args)))
}

fn mistake(error: &clap::Error, args: &[OsString]) -> String {
    let arg = text(error, ContextKind::InvalidArg);
    let value = text(error, ContextKind::InvalidValue);
    let option = arg.split([' ', '=']).next().unwrap_or_default();
    let typed = if option.starts_with('-') {
        quoted(format!("{option} {value}").trim_end())
    } else {
        quoted(&value)
    };
    let choices = list(error, ContextKind::ValidValue);
    let list_of_choices = choices.join(", ");
    match error.kind() {
        ErrorKind::ValueValidation => {
            let why = error.source().map(ToString::to_string).unwrap_or_default();
            format!("{typed}: {why}")
        }
        ErrorKind::InvalidValue if value.is_empty() => {
            let needed = format!("{} needs a value: {}", quoted(option), without_brackets(&arg));
            if choices.is_empty() {
                needed
            } else {
                format!("{needed}, which is one of {list_of_choices}")
            }
        }
        ErrorKind::InvalidValue => match nearest(&value, choices.iter().map(String::as_str)) {
            Some(name) => {
                format!("{typed}: did you mean {name}? The choices are {list_of_choices}")
            }
            None => format!("{typed}: the choices are {list_of_choices}"),
        },
        ErrorKind::TooManyValues => format!("{} takes no value: leave out {value}", quoted(option)),
        ErrorKind::UnknownArgument => unknown(&arg, &text(error, ContextKind::SuggestedArg)),
        ErrorKind::InvalidSubcommand => {
            let name = quoted(&text(error, ContextKind::InvalidSubcommand));
            let windowless = if cfg!(feature = "window") {
                ""
            } else {
                "; this a3 was built without its window"
            };
            match list(error, ContextKind::SuggestedSubcommand).first() {
                Some(meant) => format!("there is no command {name}; did you mean {meant}?"),
                None => format!("there is no command {name}; --help lists them{windowless}"),
            }
        }
        ErrorKind::MissingRequiredArgument => {
            let missing = list(error, ContextKind::InvalidArg);
            let missing: Vec<_> = missing.iter().map(|arg| without_brackets(arg)).collect();
            if is_of_choose(error) && missing.iter().any(|arg| arg.contains("--error")) {
                return either_error_or_budget();
            }
            format!("{} is missing; --help explains it", missing.join(" and "))
        }
        ErrorKind::ArgumentConflict => conflict(error, &arg),
        ErrorKind::InvalidUtf8 => not_utf_8(args),
        _ => "the command line cannot be understood; --help explains it".into(),
    }
}

/// Returns the message for a name that is not UTF-8, which is the first such argument.
fn not_utf_8(args: &[OsString]) -> String {
    let name = args.iter().find(|arg| arg.to_str().is_none());
    let name = quoted(&name.map(|name| name.to_string_lossy()).unwrap_or_default());
    format!("{name} is not UTF-8: give the file a name in UTF-8")
}

/// Returns the message for an unknown argument.
fn unknown(arg: &str, similar: &str) -> String {
    let arg = quoted(arg);
    if !similar.is_empty() {
        return format!("there is no option {arg}; did you mean {similar}?");
    }
    if arg.starts_with("`--") {
        return format!("there is no option {arg} here; --help lists the options");
    }
    if arg.starts_with("`-") {
        return format!(
            "there is no option {arg}: long options have two dashes, as in --scene, and a step is a number above 0, \
             such as 0.01 or 1/60"
        );
    }
    format!("{arg} is one word too many; --help shows what is expected")
}

/// Returns the message for two arguments that exclude each other.
fn conflict(error: &clap::Error, arg: &str) -> String {
    let others = list(error, ContextKind::PriorArg);
    let both = [&[arg.to_owned()], &others[..]].concat();
    if both.iter().any(|arg| arg.contains("--error")) {
        return either_error_or_budget();
    }
    let word = text(error, ContextKind::InvalidSubcommand);
    if !word.is_empty() && Cli::command().find_subcommand(&word).is_none() {
        return unknown(&word, "");
    }
    if arg.is_empty() || others.is_empty() {
        return "a command comes before everything else, as in `a3 chart --scene flag`; without one, there is a \
                solver and a step, as in `a3 t 0.01`"
            .into();
    }
    if both[0] == both[1] {
        return format!("{} is there twice: give it once", without_brackets(arg));
    }
    let both: Vec<_> = both.iter().map(|arg| without_brackets(arg)).collect();
    format!("give either {}, not both", both.join(" or "))
}

/// Returns whether a mistake is one of the options of `a3 choose`.
fn is_of_choose(error: &clap::Error) -> bool {
    let usage = error.get(ContextKind::Usage);
    usage.is_some_and(|usage| usage.to_string().contains("a3 choose"))
}

fn either_error_or_budget() -> String {
    "choose takes either --error E (in m) or --budget MS (in ms per frame)".into()
}

/// Returns an argument as it is typed, without clap's brackets.
fn without_brackets(arg: &str) -> String {
    quoted(&arg.replace(['<', '>', '[', ']'], ""))
}

fn quoted(text: &str) -> String {
    match text.char_indices().nth(MAX_QUOTED_CHARS) {
        Some((end, _)) => format!("`{} ...`", &text[..end]),
        None => format!("`{text}`"),
    }
}

/// Returns the first of clap's texts of this kind about a mistake; empty if there is none.
fn text(error: &clap::Error, kind: ContextKind) -> String {
    list(error, kind).into_iter().next().unwrap_or_default()
}

fn list(error: &clap::Error, kind: ContextKind) -> Vec<String> {
    match error.get(kind) {
        Some(ContextValue::String(text)) => vec![text.clone()],
        Some(ContextValue::Strings(texts)) => texts.clone(),
        _ => vec![],
    }
}
