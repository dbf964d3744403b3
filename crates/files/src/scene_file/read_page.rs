//! Files on a page of the web, read up to a limit of their size.

use std::path::Path;

use crate::browser::files;

/// Reads a file of at most `max_size` bytes that was dropped on the page.
pub fn read(path: &Path, max_size: u64) -> Result<Vec<u8>, String> {
    let bytes = files::read(path);
    let bytes = bytes.ok_or("it is not on this page: drop the files that it names first")?;
    if bytes.len() as u64 > max_size {
        return Err(format!("it is larger than {} MiB", max_size >> 20));
    }
    Ok(bytes)
}
