//! Writing of a file under a temporary name in its folder until it is complete.
//!
//! Temporary files of runs that were killed are deleted by the next run that writes to their
//! folder. The files of a command are distinct: none that is read is written, and none is written
//! twice.

use std::fs::File;
use std::io::{BufWriter, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::{fs, io};

use tempfile::NamedTempFile;

use super::place::{folder, metadata, not_written, resolve, writable};
use crate::failure::Failure;
use crate::platform::interrupt::{Cleanup, Temporary};
use crate::platform::{fault, interrupt};

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
    Beside { file: NamedTempFile, target: PathBuf, _temporary: Temporary },
    /// The path itself.
    Direct(File),
}

impl Draft {
    /// Creates a draft of the file at `path`.
    pub fn new(path: &Path) -> Result<Self, Failure> {
        refuse_read(path)?;
        let sink = Sink::new(path).map_err(|e| not_written(path, &e))?;
        Ok(Self { path: path.into(), file: BufWriter::new(sink) })
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
        match sink.map_err(io::IntoInnerError::into_error).and_then(|sink| sink.place(rename)) {
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
        sweep(&folder(&target));
        let make = || beside(&target, there.map(|there| there.permissions()));
        let (file, temporary) =
            interrupt::temporary(make, |file| Cleanup::File(file.path().into()))?;
        Ok(Self::Beside { file, target, _temporary: temporary })
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
    let prefix = prefix();
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(SUFFIX);
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

/// The files of this command, as they were named.
struct Files {
    read: Vec<PathBuf>,
    written: Vec<PathBuf>,
}

static FILES: Mutex<Files> = Mutex::new(Files { read: vec![], written: vec![] });

fn files() -> MutexGuard<'static, Files> {
    FILES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Registers a file that the command reads, such as a scene or a mesh: it is never written.
pub fn is_read(path: &Path) {
    let mut files = files();
    if !files.read.iter().any(|read| read == path) {
        files.read.push(path.into());
    }
}

/// Returns the files that the command reads, as they were named.
pub fn files_read() -> Vec<PathBuf> {
    files().read.clone()
}

/// Checks that the command does not read this file, under any name.
pub fn refuse_read(path: &Path) -> Result<(), Failure> {
    if files().read.iter().any(|read| same(read, path)) {
        return Err(Failure::usage(format!(
            "{}: the command reads this file and would overwrite it: give the output another name",
            path.display()
        )));
    }
    Ok(())
}

/// Registers a file that the command will write. Refuses one that it reads, or that is registered
/// already.
pub fn claim(path: &Path) -> Result<(), Failure> {
    refuse_read(path)?;
    let mut files = files();
    if files.written.iter().any(|written| same(written, path)) {
        return Err(Failure::usage(format!(
            "{}: two outputs of the command would go to this file: give one of them another name",
            path.display()
        )));
    }
    files.written.push(path.into());
    Ok(())
}

/// Returns whether two paths lead to the same ordinary file, which need not exist, also by links of
/// any kind.
fn same(a: &Path, b: &Path) -> bool {
    let there = [a, b].map(|path| fs::metadata(path).ok());
    if there.iter().flatten().any(|there| !there.is_file()) {
        return false;
    }
    #[cfg(unix)]
    if let [Some(a), Some(b)] = &there {
        use std::os::unix::fs::MetadataExt;
        return (a.dev(), a.ino()) == (b.dev(), b.ino());
    }
    matches!((resolve(a), resolve(b)), (Ok(a), Ok(b)) if a == b)
}

/// End of the name of a temporary file.
pub const SUFFIX: &str = ".tmp";

/// Returns the start of the name of a temporary file of this process.
pub fn prefix() -> String {
    format!(".a3-{}-", std::process::id())
}

/// Deletes the leftovers in a folder, at the first call for that folder. A file is a leftover if
/// its name is that of a temporary file of a3, its process is gone, and no process of another
/// machine or container has locked it.
#[cfg(unix)]
pub fn sweep(folder: &Path) {
    use std::fs::{self, File};
    use std::path::PathBuf;
    use std::sync::Mutex;
    static SWEPT: Mutex<Vec<PathBuf>> = Mutex::new(vec![]);
    let Ok(mut swept) = SWEPT.lock() else { return };
    if swept.iter().any(|before| before == folder) {
        return;
    }
    swept.push(folder.into());
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let process = name.to_str().and_then(process_of);
        let path = entry.path();
        if process.is_some_and(is_gone)
            && entry.file_type().is_ok_and(|kind| kind.is_file())
            && File::open(&path).is_ok_and(|file| file.try_lock().is_ok())
        {
            // A leftover that cannot be deleted does no harm.
            let _ = fs::remove_file(path);
        }
    }
}

/// Does nothing on systems where a3 cannot find out whether a process is gone.
#[cfg(not(unix))]
pub fn sweep(_: &Path) {}

/// Returns the process that wrote the temporary file of this name, if it is a name of such a file.
#[cfg(unix)]
fn process_of(name: &str) -> Option<i32> {
    let rest = name.strip_prefix(".a3-")?.strip_suffix(SUFFIX)?;
    let (process, random) = rest.split_once('-')?;
    let digits = process.bytes().all(|b| b.is_ascii_digit());
    let ours = random.len() == 6 && random.bytes().all(|b| b.is_ascii_alphanumeric());
    process.parse().ok().filter(|_| digits && ours)
}

/// Returns whether there is no such process.
#[cfg(unix)]
fn is_gone(process: i32) -> bool {
    use nix::errno::Errno;
    use nix::sys::signal::kill;
    use nix::unistd::Pid;
    process > 0 && kill(Pid::from_raw(process), None) == Err(Errno::ESRCH)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::fs::File;

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

    #[cfg(unix)]
    #[test]
    fn a_file_is_the_same_by_every_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("a"), "").unwrap();
        fs::write(path("b"), "").unwrap();
        fs::create_dir(path("below")).unwrap();
        fs::hard_link(path("a"), path("hard")).unwrap();
        std::os::unix::fs::symlink("a", path("soft")).unwrap();
        std::os::unix::fs::symlink("new", path("dangling")).unwrap();
        std::os::unix::fs::symlink("/dev/null", path("null")).unwrap();
        for other in ["a", "hard", "soft", "below/../a", "./a"] {
            assert!(same(&path("a"), &path(other)), "{other}");
            assert!(!same(&path("b"), &path(other)), "{other}");
        }
        assert!(same(&path("new"), &path("dangling")));
        assert!(!same(&path("new"), &path("a")));
        assert!(!same(&path("null"), &path("null")), "no ordinary file");
    }

    #[cfg(unix)]
    #[test]
    fn only_what_is_certainly_left_over_is_deleted() {
        let folder = tempfile::tempdir().unwrap();
        let mut child = std::process::Command::new("true").spawn().unwrap();
        child.wait().unwrap();
        let (gone, here) = (child.id(), std::process::id());
        let left = format!(".a3-{gone}-AbC123.tmp");
        let locked = format!(".a3-{gone}-locked.tmp");
        let others = [
            locked.clone(),
            format!(".a3-{here}-AbC123.tmp"),
            format!(".a3-{gone}-AbC12.tmp"),
            format!(".a3-{gone}-AbC1234.tmp"),
            format!(".a3-{gone}-AbC-23.tmp"),
            format!(".a3-{gone}-AbC123"),
            format!(".a3-{gone}-AbC123.tmp.json"),
            format!("a3-{gone}-AbC123.tmp"),
            ".a3-+12-AbC123.tmp".into(),
            ".a3-0-AbC123.tmp".into(),
            ".a3-AbC123.tmp".into(),
        ];
        for name in others.iter().chain([&left]) {
            fs::write(folder.path().join(name), "").unwrap();
        }
        let file = File::open(folder.path().join(&locked)).unwrap();
        file.lock().unwrap();
        sweep(folder.path());
        assert!(!folder.path().join(&left).exists());
        for name in others {
            assert!(folder.path().join(&name).exists(), "{name}");
        }
    }
}
