//! Values of arguments: numbers within their ranges, sizes, and names of solvers and scenes. An
//! error says what would be right; shells complete names, and a message suggests the nearest.

use std::ffi::OsStr;

use a3_core::{Method, integrators};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Arg, Command};

#[cfg(feature = "window")]
use a3_files::arguments::{hint, solver_and_step};
use a3_files::arguments::{pair, solver, within};
use a3_files::bounds::{Allowed, BUDGETS, ERRORS, FACTORS, HORIZONS};

/// Reads the end of a run (s).
pub fn until(text: &str) -> Result<f64, String> {
    within(text, 0.0..=1e9, "the end is a number of seconds from 0 to 1e9, such as 10")
}

/// Reads the real time between two checkpoints (s).
pub fn pause(text: &str) -> Result<f64, String> {
    within(
        text,
        0.0..=1e6,
        "the time between checkpoints is a number of seconds from 0 to 1e6, such as 60",
    )
}

/// Reads the beginning of a film (s).
#[cfg(feature = "window")]
pub fn beginning(text: &str) -> Result<f64, String> {
    within(text, 0.0..=1e9, "a film begins at a number of seconds from 0 to 1e9, such as 2.5")
}

/// Reads a number of frames per second.
pub fn rate(text: &str) -> Result<f64, String> {
    within(text, 0.1..=1e6, "a rate is a number of frames per second from 0.1 to 1e6, such as 30")
}

/// Reads a number of those that an option may have.
fn allowed(text: &str, allowed: &Allowed) -> Result<f64, String> {
    within(text, allowed.range.clone(), allowed.right)
}

/// Reads the end of runs that are compared (s).
pub fn horizon(text: &str) -> Result<f64, String> {
    allowed(text, &HORIZONS)
}

/// Reads a factor of the stiffness.
pub fn factor(text: &str) -> Result<f64, String> {
    allowed(text, &FACTORS)
}

/// Reads an error of positions (m).
pub fn error(text: &str) -> Result<f64, String> {
    allowed(text, &ERRORS)
}

/// Reads the computing time for a frame (ms).
pub fn budget(text: &str) -> Result<f64, String> {
    allowed(text, &BUDGETS)
}

/// Reads the computing time of a run (s).
pub fn seconds(text: &str) -> Result<f64, String> {
    within(
        text,
        1e-9..=1e9,
        "a computing time is a number of seconds from 1e-9 to 1e9, such as 0.8",
    )
}

/// Size of a chart for a column of a paper, 90 mm wide (px).
const COLUMN_SIZE: (u32, u32) = (340, 360);

/// Reads the width and height of a chart (px).
pub fn picture_size(text: &str) -> Result<(u32, u32), String> {
    if text == "column" {
        return Ok(COLUMN_SIZE);
    }
    match pair(text) {
        Some((w, h)) if (320..=8000).contains(&w) && (240..=8000).contains(&h) => Ok((w, h)),
        _ => Err(
            "a picture's size is WIDTHxHEIGHT, from 320x240 to 8000x8000, such as 1200x800, or column".into(),
        ),
    }
}

/// Reads the width and height of a picture (px).
#[cfg(feature = "window")]
pub fn size(text: &str) -> Result<(u32, u32), String> {
    match pair(text) {
        Some((w, h)) if w > 0 && h > 0 => Ok((w, h)),
        _ => Err("a size is WIDTHxHEIGHT in pixels, such as 1280x720".into()),
    }
}

/// Parser of an argument that is a name, with all names for the completion by shells.
#[derive(Clone)]
pub struct Names<T> {
    parse: fn(&str, &Command) -> Result<T, String>,
    all: fn() -> Vec<&'static str>,
}

impl<T: Clone + Send + Sync + 'static> TypedValueParser for Names<T> {
    type Value = T;

    fn parse_ref(
        &self,
        command: &Command,
        arg: Option<&Arg>,
        value: &OsStr,
    ) -> Result<T, clap::Error> {
        let found = (self.parse)(value.to_str().unwrap_or_default(), command);
        // Only a parser that fails lets clap make its message.
        let found = move |_: &str| found.clone();
        TypedValueParser::parse_ref(&found, command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new((self.all)().into_iter().map(PossibleValue::new)))
    }
}

/// A solver by its letter or its name.
pub const SOLVER: Names<&'static Method> = Names { parse: |text, _| solver(text), all: solvers };

/// A solver, or `None` for the word "all".
pub const SOLVER_OR_ALL: Names<Option<&'static Method>> =
    Names { parse: |text, _| solver_or_all(text), all: || [vec![ALL], solvers()].concat() };

/// A solver in a place where a command may also stand.
#[cfg(feature = "window")]
pub const SOLVER_OR_COMMAND: Names<&'static Method> =
    Names { parse: solver_or_command, all: solvers };

/// A solver, and its step or tolerance after a colon.
#[cfg(feature = "window")]
pub const SOLVER_AND_STEP: Names<(&'static Method, Option<f64>)> =
    Names { parse: |text, _| solver_and_step(text), all: solvers };

/// Word for all solvers.
const ALL: &str = "all";

/// The name of a scene, or of its file.
pub const SCENE: Names<String> = Names { parse: |text, _| Ok(text.to_owned()), all: scenes };

/// Creates a parser of one of some values, each with its name and its help.
pub fn choice<T: Copy + Send + Sync + 'static>(
    all: &'static [T],
    words: fn(T) -> (&'static str, &'static str),
) -> impl TypedValueParser<Value = T> {
    let values = all.iter().map(move |value| {
        let (name, help) = words(*value);
        PossibleValue::new(name).help(help)
    });
    PossibleValuesParser::new(values).try_map(move |name| {
        let found = all.iter().find(|value| words(**value).0 == name);
        found.copied().ok_or("there is no such choice")
    })
}

fn solvers() -> Vec<&'static str> {
    integrators::METHODS.iter().map(|m| m.name).collect()
}

fn scenes() -> Vec<&'static str> {
    a3_scenes::SCENES.iter().map(|entry| entry.name).collect()
}

fn solver_or_all(text: &str) -> Result<Option<&'static Method>, String> {
    (text != ALL).then(|| solver(text)).transpose()
}

#[cfg(feature = "window")]
fn solver_or_command(text: &str, cli: &Command) -> Result<&'static Method, String> {
    if let Some(method) = integrators::find(text) {
        return Ok(method);
    }
    if scenes().contains(&text) || [".toml", ".json"].iter().any(|end| text.ends_with(end)) {
        return Err(format!("a scene comes after --scene, as in `a3 --scene {text}`"));
    }
    let commands = cli.get_subcommands().map(Command::get_name);
    let commands: Vec<_> = commands.filter(|name| *name != "help").collect();
    if commands.contains(&text) {
        return Err(format!("a command comes before its options, as in `a3 {text} --scene flag`"));
    }
    let meant = hint(text, &commands);
    Err(format!(
        "there is no such command or solver; {meant}`a3 --help` lists the commands, and `a3 solvers` the solvers"
    ))
}
