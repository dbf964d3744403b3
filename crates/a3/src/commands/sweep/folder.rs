//! The folder of a sweep: a file for each run, in the format of the data of a chart, with one line.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use a3_files::failure::Failure;
use a3_files::output;
use a3_files::rows;
use a3_files::terminal;
use a3_lab::chart::record::{Record, VERSION};

use super::plan::{Plan, Run};
use crate::cli::sweep::Id;

/// Largest size of the file of a run (bytes).
const MAX_SIZE: u64 = 1 << 16;

/// The folder of a sweep.
pub struct Folder(PathBuf);

impl Folder {
    /// Creates a folder object, whether or not the folder exists.
    pub fn new(path: &Path) -> Self {
        Self(path.into())
    }

    /// Returns the path.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Creates the folder if it does not exist.
    pub fn create(&self) -> Result<(), Failure> {
        fs::create_dir_all(&self.0).map_err(|why| {
            let (path, why) = (self.0.display(), terminal::reason(&why));
            Failure::run(format!("{path}: the folder could not be made: {why}"))
        })
    }

    fn file(&self, id: Id) -> PathBuf {
        self.0.join(format!("{id}.csv"))
    }

    /// Reads the outcome of a run; `None` if its file is missing. A damaged file counts as missing,
    /// and a warning says so: the run is made again.
    pub fn read(&self, run: &Run) -> Result<Option<Record>, Failure> {
        let path = self.file(run.id);
        let fault = |why: String| Failure::run(format!("{}: {why}", path.display()));
        // A link is not followed, because the file that it leads to would be replaced.
        let length = match fs::symlink_metadata(&path) {
            Ok(there) if there.is_file() => there.len(),
            Ok(_) => return Err(fault("it is no ordinary file: take it away".into())),
            Err(why) if why.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(why) => return Err(fault(terminal::reason(&why))),
        };
        let bytes = if length > MAX_SIZE { Ok(vec![]) } else { fs::read(&path) };
        let bytes = bytes.map_err(|why| fault(terminal::reason(&why)))?;
        let text = String::from_utf8(bytes).ok();
        let is_of = |record: &Record| {
            (record.version.as_str(), record.solver.as_str()) == (VERSION, run.method.name)
                && record.setting == run.setting
        };
        let record = text.and_then(|text| record_of(&text)).filter(is_of);
        if record.is_none() {
            let path = path.display();
            terminal::warn(&format!("{path}: it is damaged: the run counts as missing"));
        }
        Ok(record)
    }

    /// Writes the outcome of a run, whole or not at all.
    pub fn write(&self, id: Id, record: Record) -> Result<(), Failure> {
        let text = rows::write(&[record], false).map_err(Failure::run)?;
        output::write(&self.file(id), text.as_bytes())
    }

    /// Warns of runs of another version, or of other values, which are left alone.
    pub fn warn_of_others(&self, plan: &Plan) {
        let ids: BTreeSet<Id> = plan.runs.iter().map(|run| run.id).collect();
        let names = fs::read_dir(&self.0).into_iter().flatten().flatten();
        let others = names.filter_map(|entry| {
            let path = entry.path();
            let id = Id::parse(path.file_name()?.to_str()?.strip_suffix(".csv")?)?;
            (!ids.contains(&id)).then_some(path)
        });
        let others: Vec<_> = others.collect();
        let version = others.iter().find_map(|path| {
            let record = record_of(&fs::read_to_string(path).ok()?)?;
            (record.version != VERSION).then_some(record.version)
        });
        let folder = self.0.display();
        match (others.len(), version) {
            (0, _) => {}
            (count, Some(version)) => terminal::warn(&format!(
                "warning: {folder} has {count} other runs, of a3 {version}, which this a3 {VERSION} leaves alone: \
                 give another --output to keep them apart"
            )),
            (count, None) => terminal::warn(&format!(
                "warning: {folder} has {count} other runs, which do not belong to the present sweep and are left alone"
            )),
        }
    }
}

/// Reads the run in the text of a file, whose checksum must be there and correct.
fn record_of(text: &str) -> Option<Record> {
    let names_checks = text.lines().next()?.ends_with(",check");
    let mut records: Vec<Record> = rows::read(text, false).ok().filter(|_| names_checks)?;
    (records.len() == 1).then(|| records.remove(0))
}
