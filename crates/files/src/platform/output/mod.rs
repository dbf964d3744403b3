//! Writing of files: each is complete or absent, and none is also read.

mod draft;
mod place;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::failure::Failure;

pub use crate::visible::part_of_name;

pub use draft::{Draft, Scratch};
pub use draft::{files_read, is_read, refuse_read};
pub use place::{lock, not_written};

/// Largest number of numbered names of a scene.
const MAX_NAMES: usize = 9999;

/// Checks that the path has one of the extensions, that its folder exists, and that the file may be
/// written: it is not protected, and the command neither reads it nor writes it for another
/// purpose. Commands check each output once, before they work.
pub fn check(path: &Path, extensions: &[&str]) -> Result<(), Failure> {
    check_ending(path, extensions)?;
    if path.is_dir() {
        return Err(Failure::run(format!("{}: this is a folder, not a file", path.display())));
    }
    place::check(path)?;
    draft::claim(path)
}

/// Checks that the path has one of the extensions. This is done before any scene is built.
pub fn check_ending(path: &Path, extensions: &[&str]) -> Result<(), Failure> {
    if !extensions.iter().any(|extension| ends_in(path, extension)) {
        let (last, others) = extensions.split_last().unwrap_or((&"", &[]));
        let others = match others {
            [] => String::new(),
            others => format!("{} or .", others.join(", .")),
        };
        let folder = if path.is_dir() { "this is a folder, and " } else { "" };
        return Err(Failure::usage(format!(
            "{}: {folder}the name of the file must end in .{others}{last}",
            path.display(),
        )));
    }
    Ok(())
}

/// Returns whether the path has this extension, in lower or upper case.
pub fn ends_in(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension))
}

/// Returns the first of the names a3-SCENE-1, a3-SCENE-2, ... with this ending that is free in the
/// working folder. A sequence is free if its first file is.
pub fn free_name(scene: &str, ending: &str) -> Result<PathBuf, Failure> {
    let scene = part_of_name(scene);
    (1..=MAX_NAMES)
        .map(|k| format!("a3-{scene}-{k}{ending}"))
        .find(|name| fs::symlink_metadata(name.replace("####", "0001")).is_err())
        .map(PathBuf::from)
        .ok_or_else(|| {
            Failure::run(format!("there are {MAX_NAMES} files a3-{scene}-*{ending} already"))
        })
}

/// Writes `bytes` to the first of the names a3-SCENE-1, a3-SCENE-2, ... with an extension that is
/// free in the folder, and returns it.
pub fn write_new(
    folder: &Path,
    scene: &str,
    extension: &str,
    bytes: &[u8],
) -> Result<PathBuf, Failure> {
    let scene = part_of_name(scene);
    for k in 1..=MAX_NAMES {
        let path = folder.join(format!("a3-{scene}-{k}.{extension}"));
        // A link that leads nowhere occupies a name too.
        if fs::symlink_metadata(&path).is_ok() {
            continue;
        }
        let mut draft = Draft::new(&path)?;
        draft.write_all(bytes).map_err(|e| draft.failure(&e))?;
        // Another run may have taken the name meanwhile.
        if draft.place_new()? {
            return Ok(path);
        }
    }
    Err(Failure::run(format!("there are {MAX_NAMES} files a3-{scene}-*.{extension} already")))
}

/// Writes `bytes` to `path`.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    write_with(path, |file| file.write_all(bytes))
}

/// Lets `content` write to `path`.
pub fn write_with(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Failure> {
    let mut draft = Draft::new(path)?;
    content(&mut draft).map_err(|e| draft.failure(&e))?;
    draft.place()
}

/// Encodes pixels as a PNG: rows from the top, with eight bits each of red, green, blue and
/// opacity.
pub fn png(pixels: &[u8], (width, height): (u32, u32)) -> Result<Vec<u8>, Failure> {
    let mut bytes = vec![];
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_compression(png::Compression::Fast);
    let written = encoder.write_header();
    let written = written.and_then(|mut picture| picture.write_image_data(pixels));
    written.map_err(Failure::run)?;
    Ok(bytes)
}
