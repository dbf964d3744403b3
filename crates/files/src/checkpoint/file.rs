//! Reading of a checkpoint from the file system.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::terminal;

/// Size of the largest file that is read (bytes).
const MAX_SIZE: u64 = 4 << 30;

/// Reads the bytes of an ordinary file that is not too large.
pub fn bytes_of(path: &Path) -> Result<Vec<u8>, String> {
    let read = || -> std::io::Result<Option<Vec<u8>>> {
        let file = File::open(path)?;
        let there = file.metadata()?;
        if !there.is_file() || there.len() > MAX_SIZE {
            return Ok(None);
        }
        let mut bytes = vec![];
        file.take(MAX_SIZE).read_to_end(&mut bytes)?;
        Ok(Some(bytes))
    };
    match read() {
        Ok(Some(bytes)) => Ok(bytes),
        Ok(None) => Err("this is no checkpoint of a3".into()),
        Err(error) => Err(format!(
            "it could not be read: {}",
            terminal::reason(&error)
        )),
    }
}
