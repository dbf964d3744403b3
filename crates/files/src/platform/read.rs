//! Files on the disk, read up to a limit of their size.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use super::{output, terminal};

/// Size of the largest checkpoint that is read (bytes).
const MAX_CHECKPOINT: u64 = 4 << 30;

/// Writes the error of a file that the system could not read.
fn unreadable(error: &io::Error) -> String {
    format!("it could not be read: {}", terminal::reason(error))
}

/// Reads an ordinary file of at most `max_size` bytes.
pub fn read(path: &Path, max_size: u64) -> Result<Vec<u8>, String> {
    let meta = fs::metadata(path).map_err(|e| unreadable(&e))?;
    if !meta.is_file() {
        return Err("it is not an ordinary file".into());
    }
    let too_long = || format!("it is larger than {} MiB", max_size >> 20);
    if meta.len() > max_size {
        return Err(too_long());
    }
    let mut bytes = vec![];
    let file = File::open(path).map_err(|e| unreadable(&e))?;
    output::is_read(path);
    file.take(max_size + 1).read_to_end(&mut bytes).map_err(|e| unreadable(&e))?;
    if bytes.len() as u64 > max_size {
        return Err(too_long());
    }
    Ok(bytes)
}

/// Reads the bytes of a checkpoint, an ordinary file that is not too large.
pub fn read_checkpoint(path: &Path) -> Result<Vec<u8>, String> {
    let read = || -> io::Result<Option<Vec<u8>>> {
        let file = File::open(path)?;
        let there = file.metadata()?;
        if !there.is_file() || there.len() > MAX_CHECKPOINT {
            return Ok(None);
        }
        let mut bytes = vec![];
        file.take(MAX_CHECKPOINT).read_to_end(&mut bytes)?;
        Ok(Some(bytes))
    };
    match read() {
        Ok(Some(bytes)) => Ok(bytes),
        Ok(None) => Err("this is no checkpoint of a3".into()),
        Err(error) => Err(unreadable(&error)),
    }
}
