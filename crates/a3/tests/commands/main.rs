//! The program from the command line: its outputs, its refusals, and its messages.

#![allow(missing_docs, reason = "a test")]

mod charts;
mod choices;
#[path = "../common/mod.rs"]
mod common;
mod data;
#[cfg(unix)]
mod endings;
mod exports;
#[cfg(unix)]
mod faults;
mod films;
#[cfg(unix)]
mod hand_in;
mod help;
mod judge;
mod lessons;
mod looks;
mod manual;
#[cfg(unix)]
mod outputs;
mod pictures;
mod resumed;
mod scene_files;
#[cfg(unix)]
mod signals;
mod simplify;
mod states;
mod sweeps;
#[cfg(unix)]
mod untouched;
mod usage;
mod watch;
mod words;

use common::{Folder, Words, a3, complaint};

/// Returns the line on stderr of a program that ended with `code` and wrote nothing to its empty
/// folder.
fn refused(folder: &Folder, words: impl Words, code: i32) -> String {
    let line = complaint(&a3(folder, &words), code);
    assert!(line.starts_with("error: "), "{words:?}: {line}");
    assert_eq!(folder.count(), 0, "{words:?} leaves nothing behind");
    line
}
