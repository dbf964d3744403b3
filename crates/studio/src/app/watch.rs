//! A watch over files, which checks periodically whether they have changed.

use std::fs;
use std::path::PathBuf;
use std::time::{Duration, Instant, SystemTime};

/// Time between two checks. Checking works whether an editor renames, truncates or rewrites the
/// file.
const CHECK_INTERVAL: Duration = Duration::from_millis(200);

/// Modification time and length of a file, which identify its version; `None` if there is no file.
type Stamp = Option<(SystemTime, u64)>;

/// A watch over the files of a scene.
pub struct Watch {
    files: Vec<PathBuf>,
    seen: Vec<Stamp>,
    next: Instant,
}

impl Watch {
    /// Starts to watch files in their present versions.
    pub fn new(files: Vec<PathBuf>) -> Self {
        Self {
            seen: files.iter().map(stamp).collect(),
            files,
            next: Instant::now() + CHECK_INTERVAL,
        }
    }

    /// Returns the time of the next check.
    pub fn next(&self) -> Instant {
        self.next
    }

    /// Checks the files if that is due. Returns whether one has changed and all of them exist.
    pub fn changed(&mut self) -> bool {
        if Instant::now() < self.next {
            return false;
        }
        self.next = Instant::now() + CHECK_INTERVAL;
        let now: Vec<_> = self.files.iter().map(stamp).collect();
        // A file that is being replaced does not exist for a moment.
        if now == self.seen || now.iter().any(Option::is_none) {
            return false;
        }
        self.seen = now;
        true
    }
}

fn stamp(path: &PathBuf) -> Stamp {
    let meta = fs::metadata(path).ok()?;
    Some((meta.modified().ok()?, meta.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread::sleep;

    #[test]
    fn a_changed_file_is_reported_once_and_a_missing_one_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        fs::write(&path, "a").unwrap();
        let mut watch = Watch::new(vec![path.clone()]);
        let mut look = || {
            sleep(CHECK_INTERVAL + Duration::from_millis(20));
            watch.changed()
        };
        assert!(!look());
        fs::write(&path, "ab").unwrap();
        assert!(look() && !look());
        fs::remove_file(&path).unwrap();
        assert!(!look());
        fs::write(&path, "abc").unwrap();
        assert!(look());
    }
}
