//! Rows of data in a file, which a later command continues.

use std::fmt::Display;
use std::fs;
use std::path::{Path, PathBuf};

use super::row::Row;
use super::text;
use crate::failure::Failure;
use crate::output;

/// Largest size of a data file that is read (bytes).
const MAX_FILE_SIZE: u64 = 64 << 20;

/// Rows that are known, and the file in which they are saved.
pub struct Rows<T> {
    path: Option<PathBuf>,
    all: Vec<T>,
    /// Description of the rows, for messages, such as `the data of a chart`.
    name: &'static str,
    /// Text of the file when it was last read or written.
    seen: String,
}

impl<T: Row> Rows<T> {
    /// Reads the rows in a file; none if there is no file, or an empty one.
    ///
    /// # Errors
    /// The file holds something else, or cannot be read.
    pub fn open(path: Option<&Path>, name: &'static str) -> Result<Self, Failure> {
        let mut rows = Self {
            path: path.map(Path::to_owned),
            all: vec![],
            name,
            seen: String::new(),
        };
        let Some(path) = path else { return Ok(rows) };
        output::check(path, &["csv", "json"])?;
        rows.look(path).map_err(Failure::usage)?;
        Ok(rows)
    }

    /// Reads the file again if it has changed, and adds the rows that are not known yet, such as
    /// those of another command.
    fn look(&mut self, path: &Path) -> Result<(), String> {
        let name = self.name;
        let wrong = |why: &dyn Display| {
            let path = path.display();
            format!("{path}: this file does not hold {name} ({why}); give another name")
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
        for row in read {
            if !self.all.iter().any(|known| known.is_same(&row)) {
                self.all.push(row);
            }
        }
        self.seen = text;
        Ok(())
    }

    /// Returns all rows.
    pub fn all(&self) -> &[T] {
        &self.all
    }

    /// Returns the row of the same measurement, if it is known.
    pub fn find(&self, like: &T) -> Option<&T> {
        self.all.iter().find(|row| row.is_same(like))
    }

    /// Adds a row, in place of an older one of the same measurement.
    pub fn add(&mut self, row: T) {
        self.all.retain(|known| !known.is_same(&row));
        self.all.push(row);
    }

    /// Writes the file, if there is one, with the rows that another command has added meanwhile.
    pub fn save(&mut self) -> Result<(), Failure> {
        let Some(path) = self.path.clone().filter(|_| !self.all.is_empty()) else {
            return Ok(());
        };
        let _alone = output::lock(&path)?;
        self.look(&path).map_err(Failure::run)?;
        let json = output::ends_in(&path, "json");
        let text = text::write(&self.all, json).map_err(Failure::run)?;
        output::write(&path, text.as_bytes())?;
        self.seen = text;
        Ok(())
    }
}
