//! Files of a page, with a limit for their size.

use std::path::Path;

use crate::base::browser::files;

/// The bytes of a file that was dropped on the page, with at most `longest` bytes.
pub fn read(path: &Path, longest: u64) -> Result<Vec<u8>, String> {
    let bytes = files::read(path);
    let bytes = bytes.ok_or("it is not on this page: drop the files that it names first")?;
    if bytes.len() as u64 > longest {
        return Err(format!("it is larger than {} MiB", longest >> 20));
    }
    Ok(bytes)
}
