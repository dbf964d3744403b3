//! Files that are whole or absent.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::Failure;

/// `Ok` if the path ends as it should and its folder is there: said before the work, not after.
pub fn check(path: &Path, extension: &str) -> Result<(), Failure> {
    if !path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case(extension))
    {
        return Err(Failure::usage(format!(
            "{}: the file to write ends in .{extension}",
            path.display()
        )));
    }
    if path.is_dir() {
        return Err(Failure::run(format!(
            "{}: is a folder, not a file",
            path.display()
        )));
    }
    let folder = folder(path);
    if folder.is_dir() {
        Ok(())
    } else {
        Err(Failure::run(format!(
            "{}: there is no folder {}",
            path.display(),
            folder.display()
        )))
    }
}

fn folder(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.into(),
        _ => PathBuf::from("."),
    }
}

/// Writes `bytes` to `path`: beside it first, then in its place. What is no ordinary file is written to as it is.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let special = fs::metadata(path).is_ok_and(|meta| !meta.is_file());
    let result = if special {
        write_to(&mut fs::File::options().write(true).open(path), bytes)
    } else {
        replace(path, bytes)
    };
    result.map_err(|e| Failure::run(format!("{}: not written: {e}", path.display())))
}

fn write_to(file: &mut io::Result<fs::File>, bytes: &[u8]) -> io::Result<()> {
    match file {
        Ok(file) => file.write_all(bytes),
        Err(e) => Err(io::Error::new(e.kind(), e.to_string())),
    }
}

fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".a3-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As any new file: less what the umask takes.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder(path))?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist(path).map_err(|e| e.error)?;
    Ok(())
}

/// Eight-bit RGBA rows from the top, as PNG.
pub fn png(pixels: &[u8], (width, height): (u32, u32)) -> Result<Vec<u8>, Failure> {
    use image::ImageEncoder;
    let mut bytes = vec![];
    image::codecs::png::PngEncoder::new(&mut bytes)
        .write_image(pixels, width, height, image::ExtendedColorType::Rgba8)
        .map_err(Failure::run)?;
    Ok(bytes)
}
