//! The rules of the house: no file of more than 700 lines, no comment of more than 100 columns, no
//! circle of imports between the modules of a crate, a first line in each file that says its
//! subject, and a map in ARCHITECTURE.md that names exactly the folders that exist.

#![allow(missing_docs, reason = "a test")]

mod imports;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use imports::Crate;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
const MAX_LINES: usize = 700;
const MAX_COLUMNS: usize = 100;

/// Returns all files below a folder whose names have this ending, in order.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut entries: Vec<_> =
        fs::read_dir(folder).into_iter().flatten().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    let mut found = vec![];
    for path in entries {
        if path.is_dir() {
            found.extend(files(&path, ending));
        } else if path.to_str().unwrap().ends_with(ending) {
            found.push(path);
        }
    }
    found
}

fn rust_files() -> Vec<PathBuf> {
    ["crates", "benches"]
        .iter()
        .flat_map(|folder| files(&Path::new(ROOT).join(folder), ".rs"))
        .collect()
}

/// Returns the folder of the sources of each crate.
fn sources() -> Vec<PathBuf> {
    let crates = fs::read_dir(Path::new(ROOT).join("crates")).unwrap();
    crates.map(|entry| entry.unwrap().path().join("src")).filter(|source| source.is_dir()).collect()
}

#[test]
fn no_file_is_longer_than_700_lines() {
    let shaders = files(&Path::new(ROOT).join("crates"), ".wgsl");
    let all = rust_files();
    assert!(all.len() > 100, "the sources were not found");
    let long: Vec<_> = all
        .into_iter()
        .chain(shaders)
        .filter_map(|path| {
            let lines = fs::read_to_string(&path).unwrap().lines().count();
            (lines > MAX_LINES).then(|| format!("{lines} {}", path.display()))
        })
        .collect();
    assert!(long.is_empty(), "{long:#?}");
}

/// The formatter wraps code, but not comments.
#[test]
fn no_comment_is_wider_than_100_columns() {
    let mut wide = vec![];
    for path in rust_files() {
        for (k, line) in fs::read_to_string(&path).unwrap().lines().enumerate() {
            let is_comment = line.trim_start().starts_with("//");
            if is_comment && line.chars().count() > MAX_COLUMNS {
                wide.push(format!("{}:{}", path.display(), k + 1));
            }
        }
    }
    assert!(wide.is_empty(), "{wide:#?}");
}

#[test]
fn no_module_imports_one_that_imports_it() {
    let circles: Vec<_> = sources()
        .iter()
        .flat_map(|source| Crate::read(source, &files(source, ".rs")).circles())
        .collect();
    assert!(circles.is_empty(), "{circles:#?}");
}

#[test]
fn no_module_imports_from_its_parent() {
    let upwards: Vec<_> = sources()
        .iter()
        .flat_map(|source| Crate::read(source, &files(source, ".rs")).upwards())
        .collect();
    assert!(upwards.is_empty(), "{upwards:#?}");
}

/// A type to which many files add methods is too large, and should be made of parts.
#[test]
fn no_type_has_methods_in_more_than_two_files() {
    let spread: Vec<_> = sources()
        .iter()
        .flat_map(|source| Crate::read(source, &files(source, ".rs")).spread())
        .collect();
    assert!(spread.is_empty(), "{spread:#?}");
}

/// The first cell of a row of the map names folders, each by its path from the root.
#[test]
fn the_map_of_the_architecture_is_the_territory() {
    let text = fs::read_to_string(Path::new(ROOT).join("ARCHITECTURE.md")).unwrap();
    let mut named = BTreeSet::new();
    for row in text.lines().filter(|line| line.starts_with("| `")) {
        let cell = row.split('|').nth(1).unwrap();
        let paths = cell.split('`').skip(1).step_by(2);
        named.extend(paths.map(|path| PathBuf::from(path.trim_end_matches('/'))));
    }
    let root = Path::new(ROOT).canonicalize().unwrap();
    let strangers: Vec<_> = named.iter().filter(|path| !root.join(path).is_dir()).collect();
    assert!(strangers.is_empty(), "the map names what is not there: {strangers:#?}");
    let mut rooms = BTreeSet::new();
    for source in sources() {
        for path in files(&source.canonicalize().unwrap(), ".rs") {
            let folder = path.parent().unwrap();
            if !folder.ends_with("tests") {
                rooms.insert(folder.strip_prefix(&root).unwrap().to_owned());
            }
        }
    }
    let missing: Vec<_> = rooms.difference(&named).collect();
    assert!(missing.is_empty(), "folders that the map leaves out: {missing:#?}");
}

#[test]
fn every_file_says_its_subject_in_its_first_line() {
    let silent: Vec<_> = sources()
        .iter()
        .flat_map(|source| files(source, ".rs"))
        .filter(|path| {
            let text = fs::read_to_string(path).unwrap();
            !text.starts_with("//! ") && !text.starts_with("#![doc")
        })
        .collect();
    assert!(silent.is_empty(), "{silent:#?}");
}
