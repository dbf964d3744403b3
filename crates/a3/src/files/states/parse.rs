//! States in the bytes of a file.

use a3_scenes::unmarked;

use super::build::States;
use super::{csv, json, npz};

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
    States::new(raw, particles)
}
