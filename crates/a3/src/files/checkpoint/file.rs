//! The bytes of a file of the system.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::base::terminal;

/// Size of the largest file that is read (bytes).
const LARGEST: u64 = 4 << 30;

/// The bytes of an ordinary file that is not too large.
pub fn bytes_of(path: &Path) -> Result<Vec<u8>, String> {
    let read = || -> std::io::Result<Option<Vec<u8>>> {
        let file = File::open(path)?;
        let there = file.metadata()?;
        if !there.is_file() || there.len() > LARGEST {
            return Ok(None);
        }
        let mut bytes = vec![];
        file.take(LARGEST).read_to_end(&mut bytes)?;
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
