//! Writing files: each is complete or absent.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::failure::Failure;
use crate::interrupt::Temporary;

/// `Ok` if the path has one of the extensions and its folder exists. Commands check before they
/// work.
pub fn check(path: &Path, extensions: &[&str]) -> Result<(), Failure> {
    if !extensions.iter().any(|extension| ends_in(path, extension)) {
        let (last, others) = extensions.split_last().unwrap_or((&"", &[]));
        let others = match others {
            [] => String::new(),
            others => format!("{} or .", others.join(", .")),
        };
        return Err(Failure::usage(format!(
            "{}: the name of the file must end in .{others}{last}",
            path.display(),
        )));
    }
    if path.is_dir() {
        return Err(Failure::run(format!(
            "{}: this is a folder, not a file",
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

/// Whether the path has this extension, in lower or upper case.
pub fn ends_in(path: &Path, extension: &str) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case(extension))
}

/// The folder of a file.
fn folder(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.into(),
        _ => PathBuf::from("."),
    }
}

/// Writes to standard output. It is no failure if the reader closes it early, as `head` does.
pub fn say(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    said(
        stdout
            .write_all(text.as_bytes())
            .and_then(|()| stdout.flush()),
    )
}

/// The result of a write to standard output.
pub fn said(written: io::Result<()>) -> Result<(), Failure> {
    match written {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => Err(Failure::run(format!(
            "standard output could not be written: {e}"
        ))),
        _ => Ok(()),
    }
}

/// The first of the names a3-SCENE-1.png, a3-SCENE-2.png, ... that is free.
pub fn free_picture_name(scene: &str) -> Result<String, Failure> {
    free_name("".as_ref(), scene, "png").map(|path| path.to_string_lossy().into_owned())
}

/// The first of the names a3-SCENE-1, a3-SCENE-2, ... with an extension that is free in the folder.
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

/// Lets `content` write to `path`.
pub fn write_with(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Failure> {
    let mut draft = Draft::new(path)?;
    content(&mut draft).map_err(|e| not_written(path, &e))?;
    draft.place()
}

/// A file that is being written: beside its place until it is complete. A draft that is dropped
/// leaves nothing behind. A path that is no ordinary file, such as a device, is written to
/// directly.
pub struct Draft {
    /// The path as it was given.
    path: PathBuf,
    file: BufWriter<Sink>,
}

/// Where a draft is written.
enum Sink {
    /// A temporary file, and the place to which it will go.
    Beside {
        file: NamedTempFile,
        target: PathBuf,
        _temporary: Temporary,
    },
    /// The path itself.
    Direct(File),
}

impl Draft {
    /// Begins a file.
    pub fn new(path: &Path) -> Result<Self, Failure> {
        // A link stays a link: the file to which it leads is replaced.
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.into());
        let sink = match fs::metadata(&target) {
            Ok(there) if !there.is_file() => {
                let file = File::options().write(true).open(&target);
                file.map(Sink::Direct)
            }
            there => beside(&target, there.ok().map(|there| there.permissions())).map(|file| {
                Sink::Beside {
                    _temporary: Temporary::new(file.path()),
                    file,
                    target,
                }
            }),
        };
        Ok(Self {
            path: path.into(),
            file: BufWriter::new(sink.map_err(|e| not_written(path, &e))?),
        })
    }

    /// The path at which another program may write the draft, if it is an ordinary file.
    pub fn beside(&self) -> Option<&Path> {
        match self.file.get_ref() {
            Sink::Beside { file, .. } => Some(file.path()),
            Sink::Direct(_) => None,
        }
    }

    /// Puts the complete file in its place.
    pub fn place(self) -> Result<(), Failure> {
        let path = self.path;
        let placed = self
            .file
            .into_inner()
            .map_err(io::IntoInnerError::into_error);
        let placed = placed.and_then(|sink| match sink {
            Sink::Beside { file, target, .. } => {
                file.as_file().sync_all()?;
                file.persist(target).map_err(|e| e.error)?;
                Ok(())
            }
            Sink::Direct(_) => Ok(()),
        });
        placed.map_err(|e| not_written(&path, &e))
    }

    /// The failure of a write.
    pub fn failure(&self, error: &io::Error) -> Failure {
        not_written(&self.path, error)
    }
}

impl Write for Draft {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Beside { file, .. } => file.write(bytes),
            Self::Direct(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A new file beside `path`, with these permissions or with those of any new file.
fn beside(path: &Path, permissions: Option<fs::Permissions>) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".a3-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The umask takes permissions from these.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let file = builder.tempfile_in(folder(path))?;
    if let Some(permissions) = permissions {
        file.as_file().set_permissions(permissions)?;
    }
    Ok(file)
}

/// A file without a name, in the folder of `path`.
pub fn scratch(path: &Path) -> Result<File, Failure> {
    tempfile::tempfile_in(folder(path)).map_err(|e| not_written(path, &e))
}

fn not_written(path: &Path, error: &io::Error) -> Failure {
    // The message does not show the name of the temporary file.
    let why = error.to_string();
    let why = why.split(" at path").next().unwrap_or_default();
    Failure::run(format!("{}: could not be written: {why}", path.display()))
}

/// A PNG of pixels: rows from the top, with eight bits each of red, green, blue and opacity.
pub fn png(pixels: &[u8], (width, height): (u32, u32)) -> Result<Vec<u8>, Failure> {
    use image::ImageEncoder;
    let mut bytes = vec![];
    image::codecs::png::PngEncoder::new(&mut bytes)
        .write_image(pixels, width, height, image::ExtendedColorType::Rgba8)
        .map_err(Failure::run)?;
    Ok(bytes)
}
