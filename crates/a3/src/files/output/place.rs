//! Where a file is written: the end of all links, in a folder that is there, unless protected.

use std::fs::{self, Metadata};
use std::io;
use std::path::{Path, PathBuf};

use crate::base::failure::Failure;
use crate::base::terminal::reason;

/// Most links, one leading to the next, that are followed. Systems follow as many.
const MOST_LINKS: usize = 40;

/// The folder of a file.
pub fn folder(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.into(),
        _ => PathBuf::from("."),
    }
}

/// The place to which a path leads: a link stays a link, and the file at its end is written, also
/// if there is none yet.
pub fn resolve(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
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

/// What is at a place, if there is anything.
pub fn there(place: &Path) -> io::Result<Option<Metadata>> {
    match fs::metadata(place) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(None),
        there => there.map(Some),
    }
}

/// `Ok` if a file may be written to the path, as far as can be told before.
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
    let there = there(&place).map_err(failed)?;
    there.as_ref().map_or(Ok(()), writable).map_err(failed)
}

/// An error for a file that its owner has protected: a rename would replace it all the same.
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

/// The failure of a write.
pub fn not_written(path: &Path, error: &io::Error) -> Failure {
    let why = reason(error);
    Failure::run(format!("{}: could not be written: {why}", path.display()))
}
