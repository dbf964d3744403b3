//! Files that are checked now and then, to see whether they were saved.

use std::fs;
use std::path::PathBuf;
use std::time::{Duration, Instant, SystemTime};

/// Time from one check to the next. Editors rename, truncate and write files: checking works with
/// all of them.
const CHECK_INTERVAL: Duration = Duration::from_millis(200);

/// Time of change and length, by which one version of a file differs from the next; `None` without
/// a file.
type Stamp = Option<(SystemTime, u64)>;

/// The files of a scene.
pub struct Watch {
    files: Vec<PathBuf>,
    seen: Vec<Stamp>,
    next: Instant,
}

impl Watch {
    /// Begins to watch files as they are now.
    pub fn new(files: Vec<PathBuf>) -> Self {
        Self {
            seen: files.iter().map(stamp).collect(),
            files,
            next: Instant::now() + CHECK_INTERVAL,
        }
    }

    /// Time of the next check.
    pub fn next(&self) -> Instant {
        self.next
    }

    /// Whether a file was saved since the last check, and all of them are there.
    pub fn changed(&mut self) -> bool {
        if Instant::now() < self.next {
            return false;
        }
        self.next = Instant::now() + CHECK_INTERVAL;
        let now: Vec<_> = self.files.iter().map(stamp).collect();
        // A file that is being replaced is absent for a moment.
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
    fn a_saved_file_is_seen_once_and_one_that_is_away_not() {
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
