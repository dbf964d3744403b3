//! Files of the system, with a limit for their size.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use crate::base::terminal;
use crate::files::output;

fn unreadable(error: &io::Error) -> String {
    format!("it could not be read: {}", terminal::reason(error))
}

/// The bytes of an ordinary file with at most `longest` bytes.
pub fn read(path: &Path, longest: u64) -> Result<Vec<u8>, String> {
    let meta = fs::metadata(path).map_err(|e| unreadable(&e))?;
    if !meta.is_file() {
        return Err("it is not an ordinary file".into());
    }
    let too_long = || format!("it is larger than {} MiB", longest >> 20);
    if meta.len() > longest {
        return Err(too_long());
    }
    let mut bytes = vec![];
    let file = File::open(path).map_err(|e| unreadable(&e))?;
    output::is_read(path);
    file.take(longest + 1)
        .read_to_end(&mut bytes)
        .map_err(|e| unreadable(&e))?;
    if bytes.len() as u64 > longest {
        return Err(too_long());
    }
    Ok(bytes)
}
