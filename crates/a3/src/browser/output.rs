//! What a page writes: files as downloads, and words to the console of the browser.

use std::io;
use std::path::{Path, PathBuf};

use crate::browser::{download, files, log};
use crate::failure::Failure;

/// Gives `bytes` to the browser as a download, and keeps them as a file of the page. Returns its
/// name.
pub fn write_new(_: &Path, scene: &str, extension: &str, bytes: &[u8]) -> Result<PathBuf, Failure> {
    let scene = scene.replace(|c: char| c.is_control() || "/\\".contains(c), "-");
    let name = |k: usize| PathBuf::from(format!("a3-{scene}-{k}.{extension}"));
    let path = (1..=usize::MAX)
        .map(name)
        .find(|path| files::read(path).is_none());
    let path = path.unwrap_or_default();
    write(&path, bytes)?;
    Ok(path)
}

/// Gives `bytes` to the browser as a download of that name, and keeps them as a file of the page.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    files::keep(path, bytes);
    download(&path.to_string_lossy(), bytes).map_err(Failure::run)
}

/// Writes words to the console.
pub fn say(text: &str) -> Result<(), Failure> {
    log(text.trim_end());
    Ok(())
}

/// Writes data to the console.
pub fn send(data: &str) -> Result<(), Failure> {
    say(data)
}

/// The result of a write to the console.
pub fn said(written: io::Result<()>) -> Result<(), Failure> {
    written.map_err(Failure::run)
}

/// Writes a message to the console.
pub fn warn(message: &str) {
    log(message);
}

/// Why a file could not be read, in words.
pub fn reason(error: &io::Error) -> String {
    error.to_string()
}
