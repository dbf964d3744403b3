//! Checks that the files of a command are distinct: none that is read is written, and none is
//! written twice.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::place::resolve;
use crate::base::failure::Failure;

/// The files of this command, as they were named.
struct Files {
    read: Vec<PathBuf>,
    written: Vec<PathBuf>,
}

static FILES: Mutex<Files> = Mutex::new(Files {
    read: vec![],
    written: vec![],
});

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

#[cfg(unix)]
#[cfg(test)]
mod tests {
    use super::*;

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
}
