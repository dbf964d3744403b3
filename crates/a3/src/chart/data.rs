//! Data behind a chart: its runs, one line each, in a CSV or JSON file from which a later chart
//! goes on.

use std::fs;
use std::path::{Path, PathBuf};

use super::record::{self, Record};
use crate::failure::Failure;
use crate::output;

/// Size of the largest data file that is read (bytes).
const LARGEST_FILE: u64 = 64 << 20;

/// The runs so far, and the file that keeps them.
pub struct Data {
    path: Option<PathBuf>,
    pub records: Vec<Record>,
}

impl Data {
    /// The runs in the file; none if there is no file.
    pub fn open(path: Option<&Path>) -> Result<Self, Failure> {
        let mut data = Self {
            path: path.map(Path::to_owned),
            records: vec![],
        };
        let Some(path) = path else { return Ok(data) };
        output::check(path, &["csv", "json"])?;
        let Ok(there) = fs::metadata(path) else {
            return Ok(data);
        };
        let wrong = |why: String| {
            Failure::run(format!(
                "{}: this file does not hold the data of a chart ({why}); give another name",
                path.display()
            ))
        };
        if !there.is_file() || there.len() > LARGEST_FILE {
            return Err(wrong(
                "it is not an ordinary file, or it is too large".into(),
            ));
        }
        let text = fs::read_to_string(path).map_err(|e| wrong(e.to_string()))?;
        data.records = record::read(&text, output::ends_in(path, "json")).map_err(wrong)?;
        Ok(data)
    }

    /// The run of the same scene, method, setting and version, if there is one; if `timed`, only
    /// one that was timed or lost.
    pub fn find(&self, like: &Record, timed: bool) -> Option<&Record> {
        self.records
            .iter()
            .find(|r| r.same_run(like) && (!timed || r.seconds.is_some() || r.lost_at.is_some()))
    }

    /// Adds a run, and removes an older one of the same scene, method and setting.
    pub fn add(&mut self, record: Record) {
        self.records.retain(|r| !r.same_run(&record));
        self.records.push(record);
    }

    /// Writes the file, if the runs have one.
    pub fn save(&self) -> Result<(), Failure> {
        let Some(path) = &self.path else {
            return Ok(());
        };
        let bytes = if output::ends_in(path, "json") {
            let mut text = serde_json::to_string_pretty(&self.records).map_err(Failure::run)?;
            text.push('\n');
            text.into_bytes()
        } else {
            let mut writer = csv::Writer::from_writer(vec![]);
            for record in &self.records {
                writer.serialize(record).map_err(Failure::run)?;
            }
            writer.into_inner().map_err(Failure::run)?
        };
        output::write(path, &bytes)
    }
}

/// Version of this program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
