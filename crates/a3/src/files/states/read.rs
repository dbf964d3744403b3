//! Files of states, by their endings.

use std::path::Path;

use super::build::States;
use super::parse::parse;
use crate::base::input_error::InputError;
use crate::files::scene_file;

/// Largest size of a file (bytes).
const MAX_SIZE: u64 = 256 << 20;

/// Endings of the files that are read.
const ENDINGS: [&str; 5] = ["csv", "txt", "tsv", "json", "npz"];

/// Reads the states of that many particles in a file.
///
/// # Errors
/// The file cannot be read, or its content is wrong.
pub fn read(path: &Path, particles: usize) -> Result<States, InputError> {
    let wrong = |why: String| InputError::File {
        file: path.display().to_string(),
        why,
    };
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    let Some(ending) = ENDINGS.into_iter().find(|known| ending == *known) else {
        return Err(wrong(format!(
            "states are read from files that end in .{}",
            ENDINGS.join(", .")
        )));
    };
    let bytes = scene_file::read(path, MAX_SIZE).map_err(wrong)?;
    parse(&bytes, ending, particles).map_err(wrong)
}
