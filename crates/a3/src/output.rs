//! Files that are whole or absent.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::Failure;

/// `Ok` if the path ends as it should and its folder is there: said before the work, not after.
pub fn check(path: &Path, extensions: &[&str]) -> Result<(), Failure> {
    let ends_in = |extension: &&str| {
        path.extension()
            .is_some_and(|e| e.eq_ignore_ascii_case(extension))
    };
    if !extensions.iter().any(ends_in) {
        return Err(Failure::usage(format!(
            "{}: the file to write ends in .{}",
            path.display(),
            extensions.join(" or .")
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

/// Writes to standard output. A reader that has seen enough, such as `head`, is no failure.
pub fn say(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush())
    {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::run(format!("standard output: not written: {e}")))
        }
        _ => Ok(()),
    }
}

/// The first of a3-SCENE-1.png, a3-SCENE-2.png, ... that is not there yet.
pub fn free_picture_name(scene: &str) -> Result<String, Failure> {
    free_name("".as_ref(), scene, "png").map(|path| path.to_string_lossy().into_owned())
}

/// The first of a3-SCENE-1, a3-SCENE-2, ... with that extension that is not in the folder yet.
pub fn free_name(folder: &Path, scene: &str, extension: &str) -> Result<PathBuf, Failure> {
    (1..=9999)
        .map(|k| folder.join(format!("a3-{scene}-{k}.{extension}")))
        .find(|path| !path.exists())
        .ok_or_else(|| {
            Failure::run(format!(
                "there are 9999 files a3-{scene}-*.{extension} already"
            ))
        })
}

/// Writes `bytes` to `path`.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    write_with(path, |file| file.write_all(bytes))
}

/// Lets `content` write to `path`: beside it first, then in its place. What is no ordinary file is written to as it is.
pub fn write_with(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Failure> {
    // A link stays one: what it leads to is replaced.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.into());
    let result = match fs::metadata(&target) {
        Ok(there) if !there.is_file() => fs::File::options()
            .write(true)
            .open(&target)
            .and_then(|file| buffered(file, content).map(drop)),
        there => replace(
            &target,
            content,
            there.ok().map(|there| there.permissions()),
        ),
    };
    result.map_err(|e| {
        // The name of the temporary file is nobody's business.
        let why = e.to_string();
        let why = why.split(" at path").next().unwrap_or_default();
        Failure::run(format!("{}: not written: {why}", path.display()))
    })
}

/// With the permissions of the old file, or those of any new one.
fn replace(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    permissions: Option<fs::Permissions>,
) -> io::Result<()> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".a3-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Less what the umask takes.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let file = builder.tempfile_in(folder(path))?;
    if let Some(permissions) = permissions {
        file.as_file().set_permissions(permissions)?;
    }
    let file = buffered(file, content)?;
    file.as_file().sync_all()?;
    file.persist(path).map_err(|e| e.error)?;
    Ok(())
}

fn buffered<F: Write>(
    file: F,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<F> {
    let mut writer = io::BufWriter::new(file);
    content(&mut writer)?;
    writer.into_inner().map_err(io::IntoInnerError::into_error)
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
