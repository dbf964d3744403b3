//! The place of a file that is written: links are followed, protected files refused, and folders
//! locked, with which processes wait for one another.

use std::fs::{self, File, Metadata, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::failure::Failure;
use crate::platform::terminal::{reason, warn};

/// Largest number of links in a row that are followed, as operating systems do.
const MAX_LINKS: usize = 40;
/// Times of waiting for another process: until a message says so, and until the wait fails.
const WAITS: [Duration; 2] = [Duration::from_secs(1), Duration::from_secs(10)];

/// Returns the folder of a file.
pub fn folder(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.into(),
        _ => PathBuf::from("."),
    }
}

/// Follows links to the path of the file that is written. It need not exist yet.
pub fn resolve(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        match fs::canonicalize(&path) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => {}
            resolved => return resolved,
        }
        let Ok(next) = fs::read_link(&path) else {
            let name = path.file_name().unwrap_or_default();
            return Ok(fs::canonicalize(folder(&path))?.join(name));
        };
        path = folder(&path).join(next);
    }
    Err(io::Error::other("too many links lead to one another"))
}

/// Returns the metadata of a path; `None` if nothing is there.
pub fn metadata(place: &Path) -> io::Result<Option<Metadata>> {
    match fs::metadata(place) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(None),
        there => there.map(Some),
    }
}

/// Checks that a file may be written to the path, as far as that is known before writing.
pub fn check(path: &Path) -> Result<(), Failure> {
    let given = folder(path);
    if !given.is_dir() {
        return Err(no_folder(path, &given));
    }
    let failed = |e| not_written(path, &e);
    let place = match resolve(path) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => {
            let link = fs::read_link(path).unwrap_or_default();
            return Err(no_folder(path, &folder(&link)));
        }
        place => place.map_err(failed)?,
    };
    let there = metadata(&place).map_err(failed)?;
    there.as_ref().map_or(Ok(()), writable).map_err(failed)
}

/// Refuses a file that its owner has protected, because a rename would replace it nevertheless.
pub fn writable(there: &Metadata) -> io::Result<()> {
    #[cfg(unix)]
    let protected = {
        use std::os::unix::fs::PermissionsExt;
        there.permissions().mode() & 0o200 == 0
    };
    #[cfg(not(unix))]
    let protected = there.permissions().readonly();
    if there.is_file() && protected {
        return Err(io::Error::new(
            io::ErrorKind::PermissionDenied,
            "it is protected from writing: permit it, or give another name",
        ));
    }
    Ok(())
}

fn no_folder(path: &Path, folder: &Path) -> Failure {
    Failure::run(format!("{}: there is no folder {}", path.display(), folder.display()))
}

/// Returns the failure of a write.
pub fn not_written(path: &Path, error: &io::Error) -> Failure {
    let why = reason(error);
    Failure::run(format!("{}: could not be written: {why}", path.display()))
}

/// Locks the folder of a file until the returned value is dropped, so that no other process that
/// locks it reads or replaces the file meanwhile. `None` where the system has no such locks; a
/// failure if another process holds the lock for 10 s.
pub fn lock(path: &Path) -> Result<Option<File>, Failure> {
    let folder = resolve(path).and_then(|place| File::open(folder(&place)));
    let Ok(folder) = folder else {
        return Ok(None);
    };
    let (begun, mut is_said) = (Instant::now(), false);
    loop {
        match folder.try_lock() {
            Ok(()) => return Ok(Some(folder)),
            Err(TryLockError::Error(_)) => return Ok(None),
            Err(TryLockError::WouldBlock) => {}
        }
        let (waited, place) = (begun.elapsed(), path.display());
        if waited > WAITS[1] {
            return Err(Failure::run(format!(
                "{place}: another process has locked its folder for 10 s: end it, or give another name"
            )));
        }
        if waited > WAITS[0] && !is_said {
            is_said = true;
            warn(&format!("{place}: waits for another process that has locked its folder"));
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}
