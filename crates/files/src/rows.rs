//! Measured data in files, from which a later command continues: CSV, or a JSON array, with a line
//! for each row. The last value of a line, `check`, is the CRC-32 of all bytes before it in the
//! file. So that of the last line shows whether any byte has changed.

use std::fmt::Display;
use std::fs;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::failure::Failure;
use super::platform::output;

/// Largest size of a data file that is read (bytes).
const MAX_FILE_SIZE: u64 = 64 << 20;
/// Key of the checksums.
const CHECK: &str = "check";
/// Number of digits of a checksum.
const DIGITS: usize = 8;

/// Row of measured data. The names of its fields are the keys of the file.
pub trait Row: Clone + Serialize + DeserializeOwned {
    /// Returns whether both rows are of the same measurement, so that the later one replaces the
    /// other.
    fn is_same(&self, other: &Self) -> bool;

    /// Returns the checksum of the file up to this row, as it was read.
    fn check(&mut self) -> &mut String;
}

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
        let mut rows =
            Self { path: path.map(Path::to_owned), all: vec![], name, seen: String::new() };
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
        let found = read(&text, output::ends_in(path, "json")).map_err(|e| wrong(&e))?;
        for row in found {
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
        let text = write(&self.all, json).map_err(Failure::run)?;
        output::write(&path, text.as_bytes())?;
        self.seen = text;
        Ok(())
    }
}

/// Returns the text after the last checksum.
fn end(json: bool) -> &'static str {
    if json { "\"}\n]\n" } else { "\n" }
}

/// Writes a checksum in hexadecimal digits.
fn digits(sum: u32) -> String {
    format!("{sum:0DIGITS$x}")
}

/// Writes rows as text.
pub fn write<T: Serialize>(rows: &[T], json: bool) -> Result<String, String> {
    let mut text = String::new();
    let (mut sum, mut summed) = (crc32fast::Hasher::new(), 0);
    for (k, row) in rows.iter().enumerate() {
        if json {
            let line = serde_json::to_string(row).map_err(|e| e.to_string())?;
            let open = line.strip_suffix('}').unwrap_or(&line);
            text += if k == 0 { "[\n" } else { "\"},\n" };
            text.extend([open, ",\"", CHECK, "\":\""]);
        } else {
            let lines = csv_lines(row, k == 0)?;
            if let Some((head, line)) = lines.split_once('\n').filter(|_| k == 0) {
                text.extend([head, ",", CHECK, "\n", line, ","]);
            } else {
                text.extend(["\n", &lines, ","]);
            }
        }
        sum.update(&text.as_bytes()[summed..]);
        summed = text.len();
        text += &digits(sum.clone().finalize());
    }
    Ok(text + end(json))
}

/// Writes the line of a row in CSV, below a line of keys if `names`.
pub fn csv_lines(row: &impl Serialize, names: bool) -> Result<String, String> {
    let mut writer = csv::WriterBuilder::new().has_headers(names).from_writer(vec![]);
    writer.serialize(row).map_err(|e| e.to_string())?;
    let bytes = writer.into_inner().map_err(|e| e.to_string())?;
    let mut lines = String::from_utf8(bytes).map_err(|e| e.to_string())?;
    lines.truncate(lines.trim_end_matches('\n').len());
    Ok(lines)
}

/// Names the line of a text that cannot be read.
fn see_line(line: u64) -> String {
    format!("see line {line}")
}

/// Reads the rows in a text. A text without checksums is accepted: an older version wrote it, or
/// somebody took them out.
///
/// # Errors
/// The text does not hold such rows, or its last checksum is wrong.
pub fn read<T: Row>(text: &str, json: bool) -> Result<Vec<T>, String> {
    let mut rows: Vec<T> = if json && !text.is_empty() {
        serde_json::from_str(text).map_err(|e| see_line(e.line() as u64))?
    } else {
        let lines = csv::Reader::from_reader(text.as_bytes()).into_deserialize();
        lines
            .collect::<Result<_, _>>()
            .map_err(|e| see_line(e.position().map_or(1, csv::Position::line)))?
    };
    if rows.is_empty() && !text.is_empty() {
        return Err("it has no runs".into());
    }
    let names_checks = !json && text.lines().next().is_some_and(|line| line.ends_with(CHECK));
    if names_checks || rows.iter_mut().any(|row| !row.check().is_empty()) {
        let open = text.strip_suffix(end(json)).unwrap_or_default();
        let begin = open.len().saturating_sub(DIGITS);
        if !open.is_char_boundary(begin)
            || open[begin..] != digits(crc32fast::hash(&open.as_bytes()[..begin]))
        {
            return Err(format!(
                "it is damaged, or was changed: its last checksum is not that of the text before it; without `{CHECK}` \
                 in any line it would be accepted"
            ));
        }
    }
    for row in &mut rows {
        row.check().clear();
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    /// Row with a text, numbers and values that may be missing.
    #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Record {
        version: String,
        scene: String,
        solver: String,
        setting: f64,
        error_position: Option<f64>,
        lost_at: Option<f64>,
        #[serde(default, skip_serializing)]
        check: String,
    }

    impl Row for Record {
        fn is_same(&self, other: &Self) -> bool {
            self == other
        }

        fn check(&mut self) -> &mut String {
            &mut self.check
        }
    }

    fn records() -> Vec<Record> {
        let record = |scene: &str, setting| Record {
            version: "0.1.0".into(),
            scene: scene.into(),
            solver: "rk4".into(),
            setting,
            error_position: (setting <= 0.1).then_some(1.234_567_890_123e-5),
            lost_at: (setting > 0.1).then_some(0.75),
            ..Record::default()
        };
        vec![record("cloth", 0.01), record("a, \"b\"\nc", 0.2), record("é", 0.1)]
    }

    #[test]
    fn what_was_written_is_read() {
        for json in [false, true] {
            for count in 1..=3 {
                let records = &records()[..count];
                let text = write(records, json).unwrap();
                assert_eq!(read(&text, json).as_deref(), Ok(records), "{text}");
                let longer = write(&[records, records].concat(), json).unwrap();
                let kept = text.strip_suffix(end(json)).unwrap();
                assert!(longer.starts_with(kept), "lines are only added");
            }
            assert_eq!(read::<Record>("", json), Ok(vec![]));
        }
    }

    /// Every byte, changed to each of several others.
    #[test]
    fn no_changed_byte_is_believed() {
        for json in [false, true] {
            let text = write(&records(), json).unwrap();
            for at in 0..text.len() {
                for other in [1, 2, 4, 7, 0x20, 0x80, 0xff] {
                    let mut bytes = text.clone().into_bytes();
                    bytes[at] ^= other;
                    // Bytes that are no UTF-8 are refused where the file is read.
                    if let Ok(changed) = String::from_utf8(bytes) {
                        assert!(read::<Record>(&changed, json).is_err(), "byte {at}: {changed}");
                    }
                }
            }
            for length in 1..text.len() {
                // Cut after a whole line, CSV is a text that was written earlier.
                let Some(short) = text.get(..length) else {
                    continue;
                };
                if let Ok(runs) = read::<Record>(short, json) {
                    assert_eq!(write(&runs, json).as_deref(), Ok(short));
                }
            }
        }
    }

    #[test]
    fn lines_without_checksums_are_believed() {
        let text = write(&records()[..1], false).unwrap();
        let old: Vec<_> = text.lines().map(|line| line.rsplit_once(',').unwrap().0).collect();
        assert_eq!(read(&old.join("\n"), false), Ok(records()[..1].to_vec()));
        let (head, _) = text.split_once('\n').unwrap();
        for other in ["buy milk", "buy,milk\n", head, "a,b\n1,2\n", "\n"] {
            assert!(read::<Record>(other, false).is_err(), "{other}");
            assert!(read::<Record>(other, true).is_err(), "{other}");
        }
        assert!(read::<Record>("[]", true).is_err());
    }
}
