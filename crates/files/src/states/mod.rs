//! States of other programs: positions, and perhaps velocities, at times, as CSV, JSON or `.npz`.

mod build;
mod csv;
mod json;
mod npz;

use std::path::Path;

use a3_scenes::unmarked;

pub use build::States;

use super::failure::InputError;
use super::platform;

/// Largest size of a file (bytes).
const MAX_SIZE: u64 = 256 << 20;

/// Endings of the files that are read.
const ENDINGS: [&str; 5] = ["csv", "txt", "tsv", "json", "npz"];

/// Reads the states of that many particles in a file.
///
/// # Errors
/// The file cannot be read, or its content is wrong.
pub fn read(path: &Path, particles: usize) -> Result<States, InputError> {
    let wrong = |why: String| InputError::File { file: path.display().to_string(), why };
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    let Some(ending) = ENDINGS.into_iter().find(|known| ending == *known) else {
        return Err(wrong(format!(
            "states are read from files that end in .{}",
            ENDINGS.join(", .")
        )));
    };
    let bytes = platform::read(path, MAX_SIZE).map_err(wrong)?;
    parse(&bytes, ending, particles).map_err(wrong)
}

/// Reads the states of that many particles in the bytes of a file with this ending.
///
/// # Errors
/// The content is wrong.
pub fn parse(bytes: &[u8], ending: &str, particles: usize) -> Result<States, String> {
    let text = || {
        str::from_utf8(unmarked(bytes)?)
            .map_err(|e| format!("it is not UTF-8 text: see byte {}", e.valid_up_to()))
    };
    let raw = match ending {
        "npz" => npz::read(bytes)?,
        "json" => json::read(text()?)?,
        _ => csv::read(text()?, particles)?,
    };
    raw.checked(particles)
}
