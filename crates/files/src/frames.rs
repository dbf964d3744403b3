//! The times of frames, and the names of numbered files.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

use crate::failure::Failure;
use crate::platform::output;

/// Largest number of frames of a run. More are refused as a mistake.
const MAX_FRAMES: f64 = 1e6;

/// Times `from` + k / `rate` (s), the last at or before the end.
#[derive(Clone, Copy, Debug)]
pub struct FrameTimes {
    /// Time of the first frame (s).
    pub from: f64,
    /// Frames a second (1/s).
    pub rate: f64,
    /// Number of the first frame: 0, unless the run was resumed from a checkpoint.
    pub first: usize,
    /// The number of frames, at least 1.
    pub count: usize,
    /// The end of the run (s).
    pub until: f64,
}

impl FrameTimes {
    /// Creates the times of the frames from `from` to `until` (s).
    pub fn new(from: f64, until: f64, rate: f64) -> Result<Self, Failure> {
        if from > until {
            return Err(Failure::usage(format!(
                "there is nothing to film: --from {from} is later than --until {until}"
            )));
        }
        // The last frame may miss the end by no more than rounding.
        let count = ((until - from) * rate + 1e-6).floor() + 1.0;
        if count > MAX_FRAMES {
            return Err(Failure::usage(format!(
                "{until} s at {rate} frames a second are {count:.0} frames, and {MAX_FRAMES} is the most: a lower --fps or \
                 --until"
            )));
        }
        Ok(Self { from, rate, first: 0, count: count as usize, until })
    }

    /// Returns the frames at a time (s) or later; at least the last one.
    pub fn since(self, time: f64) -> Self {
        let before = self.times().filter(|t| *t < time).count();
        let before = before.min(self.count - 1);
        Self { first: self.first + before, count: self.count - before, ..self }
    }

    /// Returns the times of all frames (s).
    pub fn times(self) -> impl Iterator<Item = f64> {
        let numbers = self.first..self.first + self.count;
        numbers.map(move |k| (self.from + k as f64 / self.rate).min(self.until))
    }
}

/// Files that are numbered, with as many digits as the name has `#`.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequence {
    folder: PathBuf,
    before: String,
    digits: usize,
    after: String,
}

impl Sequence {
    /// Returns the sequence that a path names, if there is a `#` in its file name.
    pub fn of(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_str()?;
        let (before, rest) = name.split_once('#')?;
        let after = rest.trim_start_matches('#');
        Some(Self {
            folder: path.parent().unwrap_or(Path::new("")).into(),
            before: before.into(),
            digits: 1 + rest.len() - after.len(),
            after: after.into(),
        })
    }

    /// Refuses a sequence whose numbers have too few digits for `count` files.
    pub fn check(&self, count: usize) -> Result<(), Failure> {
        if self.after.contains('#') {
            return Err(Failure::usage(
                "the # of a sequence must be side by side, as in cloth-####.png",
            ));
        }
        let number = |name: &OsStr| -> Option<usize> {
            let name = name.to_str()?.strip_prefix(&*self.before)?;
            name.strip_suffix(&*self.after)?.parse().ok()
        };
        for read in output::files_read() {
            let name = read.file_name().and_then(number);
            if let Some(k) = name.filter(|k| (1..=count).contains(k)) {
                output::refuse_read(&self.file(k - 1))?;
            }
        }
        let needed = count.to_string().len();
        if needed > self.digits {
            return Err(Failure::usage(format!(
                "{count} frames need numbers of {needed} digits: put as many # in the name"
            )));
        }
        Ok(())
    }

    /// Returns the file of frame k, counted from 0: its number is k + 1.
    pub fn file(&self, k: usize) -> PathBuf {
        let (before, after, width) = (&self.before, &self.after, self.digits);
        let name = format!("{before}{:0width$}{after}", k + 1);
        self.folder.join(OsString::from(name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_end_at_or_before_the_end() {
        let times = |from, until, rate| -> Vec<f64> {
            let frames = FrameTimes::new(from, until, rate).ok().unwrap();
            let times: Vec<f64> = frames.times().collect();
            assert_eq!(times.len(), frames.count);
            times
        };
        assert_eq!(times(0.0, 0.0, 30.0), [0.0]);
        assert_eq!(times(0.0, 1.0, 4.0), [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(times(0.5, 1.2, 4.0), [0.5, 0.75, 1.0]);
        // 0.1 * 3 is more than 0.3, and 2.3 / 0.1 less than 23.
        assert_eq!(times(0.0, 0.3, 10.0).len(), 4);
        assert_eq!(times(0.0, 2.3, 10.0).len(), 24);
        assert!(times(0.0, 0.3, 10.0).iter().all(|t| *t <= 0.3));
    }

    #[test]
    fn a_run_that_is_taken_up_has_the_frames_that_are_left() {
        let all = FrameTimes::new(0.0, 1.0, 30.0).ok().unwrap();
        let times: Vec<f64> = all.times().collect();
        for (time, first) in [(0.0, 0), (times[7], 7), (0.24, 8), (1.0, 30)] {
            let left = all.since(time);
            assert_eq!((left.first, left.count), (first, 31 - first));
            assert!(left.times().eq(times[first..].iter().copied()));
        }
    }

    #[test]
    fn frames_that_cannot_be_are_refused() {
        assert!(FrameTimes::new(2.0, 1.0, 30.0).is_err());
        assert!(FrameTimes::new(0.0, 1e9, 30.0).is_err());
    }

    #[test]
    fn the_marks_of_a_name_are_its_digits() {
        let sequence = Sequence::of(Path::new("f#/cloth-###.png")).unwrap();
        assert_eq!(sequence.file(0), Path::new("f#/cloth-001.png"));
        assert_eq!(sequence.file(41), Path::new("f#/cloth-042.png"));
        assert!(sequence.check(999).is_ok() && sequence.check(1000).is_err());
        assert_eq!(Sequence::of(Path::new("f#/cloth.png")), None);
        assert!(Sequence::of(Path::new("#-#.png")).unwrap().check(1).is_err());
    }
}
