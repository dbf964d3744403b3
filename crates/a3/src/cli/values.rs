//! Values of arguments: numbers within their ranges, sizes and solvers. An error says what is right.

use std::str::FromStr;

use a3_core::{Grid, Method, integrators};

use crate::bounds::{LARGEST_STEP, SMALLEST_STEP, TOLERANCES};

/// Beginning of the error of a name that is no solver's.
pub const UNKNOWN_SOLVER: &str = "the solvers are";

pub fn step(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(step) if (*TOLERANCES.start()..=LARGEST_STEP).contains(&step) => Ok(step),
        _ => Err(format!(
            "a step is a number of seconds from {SMALLEST_STEP} to {LARGEST_STEP}, such as 0.01; the tolerance of an \
             adaptive solver is a number from {:e} to {}",
            TOLERANCES.start(),
            TOLERANCES.end()
        )),
    }
}

pub fn solver_and_step(text: &str) -> Result<(&'static Method, Option<f64>), String> {
    match text.split_once(':') {
        Some((name, number)) => Ok((solver(name)?, Some(step(number)?))),
        None => Ok((solver(text)?, None)),
    }
}

pub fn particle(text: &str) -> Result<usize, String> {
    text.parse()
        .map_err(|_| "a particle is a whole number from 0, such as 12".into())
}

pub fn until(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(time) if (0.0..=1e9).contains(&time) => Ok(time),
        _ => Err("the end is a number of seconds from 0 to 1e9, such as 10".into()),
    }
}

pub fn beginning(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(time) if (0.0..=1e9).contains(&time) => Ok(time),
        _ => Err("a film begins at a number of seconds from 0 to 1e9, such as 2.5".into()),
    }
}

pub fn rate(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(rate) if (0.1..=1000.0).contains(&rate) => Ok(rate),
        _ => Err("a rate is a number of frames per second from 0.1 to 1000, such as 30".into()),
    }
}

pub fn horizon(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(time) if (0.01..=1000.0).contains(&time) => Ok(time),
        _ => Err("the end is a number of seconds from 0.01 to 1000, such as 1".into()),
    }
}

pub fn factor(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(factor) if (1e-6..=1e6).contains(&factor) => Ok(factor),
        _ => Err("a factor of the stiffness is a number from 1e-6 to 1e6, such as 10".into()),
    }
}

pub fn error(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(error) if (1e-12..=10.0).contains(&error) => Ok(error),
        _ => Err("an error is a number of metres from 1e-12 to 10, such as 1e-3".into()),
    }
}

pub fn budget(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(budget) if (1e-4..=1e5).contains(&budget) => Ok(budget),
        _ => Err("a budget is a number of milliseconds from 1e-4 to 1e5, such as 2".into()),
    }
}

pub fn picture_size(text: &str) -> Result<(u32, u32), String> {
    match pair(text) {
        Some((w, h)) if (320..=8000).contains(&w) && (240..=8000).contains(&h) => Ok((w, h)),
        _ => Err(
            "a picture's size is WIDTHxHEIGHT, from 320x240 to 8000x8000, such as 1200x800".into(),
        ),
    }
}

pub fn solver(text: &str) -> Result<&'static Method, String> {
    integrators::find(text).ok_or_else(|| {
        let names: Vec<_> = integrators::METHODS
            .iter()
            .map(|m| format!("{} ({})", m.letter, m.name))
            .collect();
        format!("{UNKNOWN_SOLVER} {}", names.join(", "))
    })
}

/// Two numbers with an x between them.
fn pair<T: FromStr>(text: &str) -> Option<(T, T)> {
    let (a, b) = text.split_once(['x', 'X', '×'])?;
    Some((a.parse().ok()?, b.parse().ok()?))
}

pub fn grid(text: &str) -> Result<Grid, String> {
    let (rows, cols) = pair(text).ok_or("a grid is ROWSxCOLS, such as 20x30")?;
    Grid::new(rows, cols).map_err(|e| e.to_string())
}

pub fn size(text: &str) -> Result<(u32, u32), String> {
    match pair(text) {
        Some((w, h)) if w > 0 && h > 0 => Ok((w, h)),
        _ => Err("a size is WIDTHxHEIGHT in pixels, such as 1280x720".into()),
    }
}
