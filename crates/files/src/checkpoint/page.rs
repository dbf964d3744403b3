//! Reading of a checkpoint on a web page.

use std::path::Path;

use crate::browser::files;

/// Returns the bytes of a file of the page.
pub fn bytes_of(path: &Path) -> Result<Vec<u8>, String> {
    files::read(path).ok_or_else(|| "there is no such file on this page".into())
}
