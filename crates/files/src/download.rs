//! Files that a page writes, as downloads.

use std::path::{Path, PathBuf};

use crate::browser::{download, files};
use crate::failure::Failure;
use crate::visible::part_of_name;

/// Gives `bytes` to the browser as a download, and stores them as a file of the page under the
/// first free name a3-SCENE-k. Returns that name.
pub fn write_new(_: &Path, scene: &str, extension: &str, bytes: &[u8]) -> Result<PathBuf, Failure> {
    let scene = part_of_name(scene);
    let name = |k: usize| PathBuf::from(format!("a3-{scene}-{k}.{extension}"));
    let path = (1..=usize::MAX)
        .map(name)
        .find(|path| files::read(path).is_none());
    let path = path.unwrap_or_default();
    write(&path, bytes)?;
    Ok(path)
}

/// Gives `bytes` to the browser as a download of that name, and stores them as a file of the page.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    files::keep(path, bytes);
    download(&path.to_string_lossy(), bytes).map_err(Failure::run)
}
