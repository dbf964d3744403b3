//! Values of arguments from their texts: numbers within their ranges, sizes, and solvers. An error
//! says what would be right.

use std::ops::RangeInclusive;
use std::str::FromStr;

use a3_core::{Grid, Method, integrators};
use a3_scenes::nearest;

use super::bounds::{LARGEST_STEP, SMALLEST_STEP, TOLERANCES};

/// Largest number of threads.
const MAX_THREADS: usize = 1024;

/// Reads a number, or a fraction such as 1/60.
fn number(text: &str) -> Option<f64> {
    match text.split_once('/') {
        Some((above, below)) => Some(above.parse::<f64>().ok()? / below.parse::<f64>().ok()?),
        None => text.parse().ok(),
    }
}

/// Reads a number in a range. `right` is the message for any other text.
pub fn within(text: &str, range: RangeInclusive<f64>, right: &str) -> Result<f64, String> {
    match number(text) {
        Some(number) if range.contains(&number) => Ok(number),
        _ => Err(decimal_point_advice(text).unwrap_or_else(|| right.into())),
    }
}

/// Returns the message for a number with a decimal comma.
fn decimal_point_advice(text: &str) -> Option<String> {
    let point = text.replacen(',', ".", 1);
    (point != text && number(&point).is_some()).then(|| format!("use a decimal point: {point}"))
}

/// Reads a step (s) or a tolerance.
pub fn step(text: &str) -> Result<f64, String> {
    let right = format!(
        "a step is a number of seconds from {SMALLEST_STEP} to {LARGEST_STEP}, such as 0.01 or 1/60; the tolerance of an \
         adaptive solver is a number from {:e} to {}",
        TOLERANCES.start(),
        TOLERANCES.end()
    );
    within(text, *TOLERANCES.start()..=LARGEST_STEP, &right)
}

/// Reads an absolute tolerance (m).
pub fn absolute(text: &str) -> Result<f64, String> {
    within(
        text,
        1e-18..=1e6,
        "an absolute tolerance is a number of metres from 1e-18 to 1e6, such as 1e-6",
    )
}

/// Reads the longest step of an adaptive solver (s).
pub fn max_step(text: &str) -> Result<f64, String> {
    within(
        text,
        SMALLEST_STEP..=LARGEST_STEP,
        &format!(
            "a longest step is a number of seconds from {SMALLEST_STEP} to {LARGEST_STEP}, such as 0.01"
        ),
    )
}

/// Reads the number of a particle.
pub fn particle(text: &str) -> Result<usize, String> {
    text.parse().map_err(|_| "a particle is a whole number from 0, such as 12".into())
}

/// Reads a number of threads.
pub fn threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count) if (1..=MAX_THREADS).contains(&count) => Ok(count),
        _ => Err(format!(
            "the number of threads is a whole number from 1 to {MAX_THREADS}, such as 4"
        )),
    }
}

/// Reads two numbers with an x between them.
pub fn pair<T: FromStr>(text: &str) -> Option<(T, T)> {
    let (a, b) = text.split_once(['x', 'X', '×'])?;
    Some((a.parse().ok()?, b.parse().ok()?))
}

/// Reads the rows and columns of a cloth.
pub fn grid(text: &str) -> Result<Grid, String> {
    let (rows, cols) = pair(text).ok_or("a grid is ROWSxCOLS, such as 20x30")?;
    Grid::new(rows, cols).map_err(|e| e.to_string())
}

/// Finds a solver by its letter or its name.
pub fn solver(text: &str) -> Result<&'static Method, String> {
    integrators::find(text).ok_or_else(|| {
        let meant = hint(text, &[]);
        format!("there is no such solver; {meant}`a3 solvers` lists all of them")
    })
}

/// Returns what may be meant by a word that names no solver: a step, or the command, the solver or
/// the letter of a solver that is most like it.
pub fn hint(text: &str, commands: &[&str]) -> String {
    if text.parse::<f64>().is_ok() {
        return format!("a step comes after its solver, as in `r {text}`; ");
    }
    let letters: Vec<_> =
        integrators::METHODS.iter().filter_map(|m| Some(m.letter?.to_string())).collect();
    let names = commands.iter().copied().chain(integrators::METHODS.iter().map(|m| m.name));
    let near = nearest(text, names.chain(letters.iter().map(String::as_str)));
    near.map_or_else(String::new, |name| format!("did you mean {name}? "))
}

/// Reads a solver, and its step or tolerance after a colon, if there is one.
pub fn solver_and_step(text: &str) -> Result<(&'static Method, Option<f64>), String> {
    match text.split_once(':') {
        Some((name, number)) => Ok((solver(name)?, Some(step(number)?))),
        None => Ok((solver(text)?, None)),
    }
}
