//! Names of solvers and scenes as arguments. Shells complete them, and a message suggests the
//! nearest.

use std::ffi::OsStr;

use a3_core::{Method, integrators};
use a3_scenes::nearest;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Arg, Command};

#[cfg(feature = "window")]
use super::values::step;

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
pub const SOLVER: Names<&'static Method> = Names {
    parse: |text, _| solver(text),
    all: solvers,
};

/// A solver, or `None` for the word "all".
pub const SOLVER_OR_ALL: Names<Option<&'static Method>> = Names {
    parse: |text, _| solver_or_all(text),
    all: || [vec![ALL], solvers()].concat(),
};

/// A solver in a place where a command may also stand.
#[cfg(feature = "window")]
pub const SOLVER_OR_COMMAND: Names<&'static Method> = Names {
    parse: solver_or_command,
    all: solvers,
};

/// A solver, and its step or tolerance after a colon.
#[cfg(feature = "window")]
pub const SOLVER_AND_STEP: Names<(&'static Method, Option<f64>)> = Names {
    parse: |text, _| solver_and_step(text),
    all: solvers,
};

/// Word for all solvers.
const ALL: &str = "all";

/// The name of a scene, or of its file.
pub const SCENE: Names<String> = Names {
    parse: |text, _| Ok(text.to_owned()),
    all: scenes,
};

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

fn solver(text: &str) -> Result<&'static Method, String> {
    integrators::find(text).ok_or_else(|| match nearest_of(text, &[]) {
        Some(name) => {
            format!("there is no such solver; did you mean {name}? `a3 solvers` lists all of them")
        }
        None => format!(
            "there is no such solver; the solvers are {}",
            letters_and_names()
        ),
    })
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
        return Err(format!(
            "a scene comes after --scene, as in `a3 --scene {text}`"
        ));
    }
    let commands = cli.get_subcommands().map(Command::get_name);
    let commands: Vec<_> = commands.filter(|name| *name != "help").collect();
    if commands.contains(&text) {
        return Err(format!(
            "a command comes before its options, as in `a3 {text} --scene flag`"
        ));
    }
    Err(match nearest_of(text, &commands) {
        Some(name) => format!(
            "there is no such command or solver; did you mean {name}? `a3 --help` lists the commands, and `a3 solvers` \
             the solvers"
        ),
        None => format!(
            "there is no such command or solver; the commands are {}; the solvers are {}",
            commands.join(", "),
            letters_and_names()
        ),
    })
}

/// Returns the command, the solver or the letter of a solver that is most like a word, if one is.
fn nearest_of(text: &str, commands: &[&str]) -> Option<String> {
    let letters: Vec<_> = integrators::METHODS
        .iter()
        .filter_map(|m| Some(m.letter?.to_string()))
        .collect();
    let names = commands.iter().copied().chain(solvers());
    nearest(text, names.chain(letters.iter().map(String::as_str))).map(str::to_owned)
}

#[cfg(feature = "window")]
fn solver_and_step(text: &str) -> Result<(&'static Method, Option<f64>), String> {
    match text.split_once(':') {
        Some((name, number)) => Ok((solver(name)?, Some(step(number)?))),
        None => Ok((solver(text)?, None)),
    }
}

fn letters_and_names() -> String {
    let names = integrators::METHODS.iter();
    let names: Vec<_> = names
        .filter_map(|m| Some(format!("{} ({})", m.letter?, m.name)))
        .collect();
    names.join(", ")
}
