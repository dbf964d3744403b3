//! Temporary files of runs that were killed: the next run that writes to their folder deletes them.

use std::path::Path;

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

#[cfg(unix)]
#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::{self, File};

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
