//! The path of the file that an output goes to: links are followed, and protected files refused.

use std::fs::{self, Metadata};
use std::io;
use std::path::{Path, PathBuf};

use crate::failure::Failure;
use crate::terminal::reason;

/// Largest number of links in a row that are followed, as operating systems do.
const MAX_LINKS: usize = 40;

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
    Failure::run(format!(
        "{}: there is no folder {}",
        path.display(),
        folder.display()
    ))
}

/// Returns the failure of a write.
pub fn not_written(path: &Path, error: &io::Error) -> Failure {
    let why = reason(error);
    Failure::run(format!("{}: could not be written: {why}", path.display()))
}
