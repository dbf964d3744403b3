//! Writing of a file under a temporary name in its folder until it is complete.

use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Seek, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::place::{folder, metadata, not_written, resolve, writable};
use super::{apart, leftovers};
use crate::base::failure::Failure;
use crate::base::fault;
use crate::base::interrupt::{self, Cleanup, Temporary};

/// Length by which a draft is extended to find out whether the disk is full (bytes).
const PROBE_LENGTH: u64 = 1 << 20;

/// A file that is being written: it has a temporary name in its folder until it is complete. A
/// draft that is dropped leaves nothing behind. A path that is no ordinary file, such as a device,
/// is written to directly.
pub struct Draft {
    /// The path as it was given.
    path: PathBuf,
    file: BufWriter<Sink>,
}

/// Function that renames a temporary file to its target.
type Rename = fn(NamedTempFile, PathBuf) -> Result<File, tempfile::PersistError>;

/// Target of the bytes of a draft.
enum Sink {
    /// A temporary file, and the path to which it will be renamed.
    Beside {
        file: NamedTempFile,
        target: PathBuf,
        _temporary: Temporary,
    },
    /// The path itself.
    Direct(File),
}

impl Draft {
    /// Creates a draft of the file at `path`.
    pub fn new(path: &Path) -> Result<Self, Failure> {
        apart::refuse_read(path)?;
        let sink = Sink::new(path).map_err(|e| not_written(path, &e))?;
        Ok(Self {
            path: path.into(),
            file: BufWriter::new(sink),
        })
    }

    /// Returns the path as it was given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the path of the temporary file, to which another program may write; `None` if the
    /// target is no ordinary file.
    pub fn beside(&self) -> Option<&Path> {
        match self.file.get_ref() {
            Sink::Beside { file, .. } => Some(file.path()),
            Sink::Direct(_) => None,
        }
    }

    /// Checks for a full disk by extending a draft that another program wrote.
    pub fn grow(&mut self) -> io::Result<()> {
        let Sink::Beside { file, .. } = self.file.get_mut() else {
            return Ok(());
        };
        file.seek(io::SeekFrom::End(0))?;
        io::copy(&mut io::repeat(0).take(PROBE_LENGTH), file)?;
        Ok(())
    }

    /// Renames the complete file to its path.
    pub fn place(self) -> Result<(), Failure> {
        self.rename_by(NamedTempFile::persist).map(drop)
    }

    /// Renames the complete file to its path if nothing is there. Returns whether it did.
    pub fn place_new(self) -> Result<bool, Failure> {
        self.rename_by(NamedTempFile::persist_noclobber)
    }

    fn rename_by(self, rename: Rename) -> Result<bool, Failure> {
        let sink = self.file.into_inner();
        match sink
            .map_err(io::IntoInnerError::into_error)
            .and_then(|sink| sink.place(rename))
        {
            Ok(()) => Ok(true),
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => Ok(false),
            Err(e) => Err(not_written(&self.path, &e)),
        }
    }

    /// Returns the failure of a write.
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

impl Sink {
    /// Opens the file of this path, or a temporary one beside it.
    fn new(path: &Path) -> io::Result<Self> {
        let target = resolve(path)?;
        let there = metadata(&target)?;
        fault::point()?;
        if there.as_ref().is_some_and(|there| !there.is_file()) {
            return File::options().write(true).open(&target).map(Self::Direct);
        }
        there.as_ref().map_or(Ok(()), writable)?;
        leftovers::sweep(&folder(&target));
        let make = || beside(&target, there.map(|there| there.permissions()));
        let (file, temporary) =
            interrupt::temporary(make, |file| Cleanup::File(file.path().into()))?;
        Ok(Self::Beside {
            file,
            target,
            _temporary: temporary,
        })
    }

    /// Renames the complete file to its path, and syncs file and folder, so that it stays even if
    /// the power fails.
    fn place(self, rename: Rename) -> io::Result<()> {
        let Self::Beside { file, target, .. } = self else {
            return Ok(());
        };
        fault::point()?;
        file.as_file().sync_all()?;
        fault::point()?;
        let folder = folder(&target);
        rename(file, target).map_err(|e| e.error)?;
        fault::point()?;
        sync(&folder)
    }
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        fault::point()?;
        match self {
            Self::Beside { file, .. } => file.write(bytes),
            Self::Direct(file) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Creates a temporary file beside `path`, with these permissions or with the defaults of new
/// files. It is locked while it is open, so that no other run takes it for a leftover.
fn beside(path: &Path, permissions: Option<fs::Permissions>) -> io::Result<NamedTempFile> {
    let prefix = leftovers::prefix();
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(leftovers::SUFFIX);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The umask is subtracted from these.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let file = builder.tempfile_in(folder(path))?;
    // On systems without these locks, leftovers are never deleted.
    #[cfg(unix)]
    let _ = file.as_file().try_lock();
    if let Some(permissions) = permissions {
        file.as_file().set_permissions(permissions)?;
    }
    Ok(file)
}

/// Syncs the names in a folder to the disk, where the system can do that and the folder may be
/// read.
fn sync(folder: &Path) -> io::Result<()> {
    if cfg!(not(unix)) {
        return Ok(());
    }
    match File::open(folder).and_then(|folder| folder.sync_all()) {
        Err(e)
            if matches!(
                e.kind(),
                io::ErrorKind::InvalidInput
                    | io::ErrorKind::Unsupported
                    | io::ErrorKind::PermissionDenied
            ) =>
        {
            Ok(())
        }
        synced => synced,
    }
}

/// A temporary file without a name, for data that are copied to a draft later.
pub struct Scratch(File);

impl Scratch {
    /// Creates a file in the folder of `path`.
    pub fn new(path: &Path) -> Result<Self, Failure> {
        let make = || tempfile::tempfile_in(folder(&resolve(path)?));
        let file = fault::point().and_then(|()| make());
        file.map(Self).map_err(|e| not_written(path, &e))
    }

    /// Returns a reader of the file from its beginning.
    pub fn reader(&self) -> io::Result<impl Read> {
        let mut file = &self.0;
        file.rewind()?;
        Ok(file)
    }
}

impl Write for Scratch {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        fault::point()?;
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If two runs find the same name free, one gets it, and the other notices.
    #[test]
    fn a_name_is_taken_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.png");
        let drafts = [b"first", b"other"].map(|bytes| {
            let mut draft = Draft::new(&path).ok().unwrap();
            draft.write_all(bytes).unwrap();
            draft
        });
        let taken = drafts.map(|draft| draft.place_new().ok().unwrap());
        assert_eq!(taken, [true, false]);
        assert_eq!(fs::read(&path).unwrap(), b"first");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
