//! Data of a chart: its runs, in a file that a later chart continues.

use std::fmt::Display;
use std::fs;
use std::path::{Path, PathBuf};

use super::each::Each;
use super::record::Record;
use super::text;
use crate::base::failure::Failure;
use crate::files::output;

/// Largest size of a data file that is read (bytes).
const MAX_FILE_SIZE: u64 = 64 << 20;

/// Runs that are known, and the file in which they are saved.
pub struct Data {
    path: Option<PathBuf>,
    pub records: Vec<Record>,
    /// File for the errors of each particle in the runs that are measured, if it was asked for.
    pub each: Option<Each>,
    /// Text of the file when it was last read or written.
    seen: String,
}

impl Data {
    /// Reads the runs in a file; none if there is no file, or an empty one.
    ///
    /// # Errors
    /// The file holds something else, or cannot be read.
    pub fn open(path: Option<&Path>) -> Result<Self, Failure> {
        let mut data = Self {
            path: path.map(Path::to_owned),
            records: vec![],
            each: None,
            seen: String::new(),
        };
        let Some(path) = path else { return Ok(data) };
        output::check(path, &["csv", "json"])?;
        data.look(path).map_err(Failure::usage)?;
        Ok(data)
    }

    /// Reads the file again if it has changed, and adds the runs that are not known yet, such as
    /// those of another chart.
    fn look(&mut self, path: &Path) -> Result<(), String> {
        let wrong = |why: &dyn Display| {
            let path = path.display();
            format!(
                "{path}: this file does not hold the data of a chart ({why}); give another name"
            )
        };
        let Ok(there) = fs::metadata(path) else {
            return Ok(());
        };
        if !there.is_file() || there.len() > MAX_FILE_SIZE {
            return Err(wrong(&"it is not an ordinary file, or it is too large"));
        }
        let text = fs::read_to_string(path).map_err(|e| wrong(&e))?;
        if text == self.seen {
            return Ok(());
        }
        let read = text::read(&text, output::ends_in(path, "json")).map_err(|e| wrong(&e))?;
        for record in read {
            if !self.records.iter().any(|known| known.same_run(&record)) {
                self.records.push(record);
            }
        }
        self.seen = text;
        Ok(())
    }

    /// Finds the run of the same scene, method, setting and version; if `timed`, only one that was
    /// timed, or that blew up.
    pub fn find(&self, like: &Record, timed: bool) -> Option<&Record> {
        self.records
            .iter()
            .find(|r| r.same_run(like) && (!timed || r.seconds.is_some() || r.lost_at.is_some()))
    }

    /// Adds a run, in place of an older one of the same scene, method and setting.
    pub fn add(&mut self, record: Record) {
        self.records.retain(|r| !r.same_run(&record));
        self.records.push(record);
    }

    /// Writes the file, if there is one, with the runs that another chart has added meanwhile.
    pub fn save(&mut self) -> Result<(), Failure> {
        let Some(path) = self.path.clone().filter(|_| !self.records.is_empty()) else {
            return Ok(());
        };
        let _alone = output::lock(&path)?;
        self.look(&path).map_err(Failure::run)?;
        let json = output::ends_in(&path, "json");
        let text = text::write(&self.records, json).map_err(Failure::run)?;
        output::write(&path, text.as_bytes())?;
        self.seen = text;
        Ok(())
    }
}

/// Version of this program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
