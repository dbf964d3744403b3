//! The program, run from its command line in a folder.

#![allow(dead_code, reason = "not every test needs all of it")]

use std::fmt::Debug;
use std::fs;
use std::io::Write;
use std::ops::Deref;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

/// A cloth whose left and right edges are pulled apart until it tears in between.
pub const TEARING: &str = r#"
solver = "r"
step = 0.002
tear = 1.4
drag_per_mass = 1

[camera]
eye = [0, 0, 5]
target = [0, 0, 0]

[[cloth]]
grid = [6, 6]
width = 1
mass = 0.01
stiffness = [20, 10, 5]
damping_ratio = 0.1
at = [0, 0.5, 0]
pin = [
    { at = ["left"], shift = { by = [-0.9, 0, 0], start = 0.1, end = 0.7 } },
    { at = ["right"], shift = { by = [0.9, 0, 0], start = 0.1, end = 0.7 } },
]
"#;

/// Words of a command line: a text, which is split at its spaces, or a list.
pub trait Words: Debug {
    fn list(&self) -> Vec<&str>;
}

impl Words for str {
    fn list(&self) -> Vec<&str> {
        self.split_whitespace().collect()
    }
}

impl Words for String {
    fn list(&self) -> Vec<&str> {
        self.as_str().list()
    }
}

impl Words for Vec<&str> {
    fn list(&self) -> Vec<&str> {
        self.clone()
    }
}

impl<const N: usize> Words for [&str; N] {
    fn list(&self) -> Vec<&str> {
        self.to_vec()
    }
}

impl<W: Words + ?Sized> Words for &W {
    fn list(&self) -> Vec<&str> {
        (**self).list()
    }
}

/// Folder of a test.
pub struct Folder(tempfile::TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn write(&self, name: impl AsRef<Path>, contents: impl AsRef<[u8]>) {
        fs::write(self.join(name), contents).unwrap();
    }

    pub fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.join(name)).unwrap()
    }

    pub fn read(&self, name: &str) -> String {
        String::from_utf8(self.bytes(name)).unwrap()
    }

    pub fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&self.bytes(name)).unwrap()
    }

    /// Returns the number of its files.
    pub fn count(&self) -> usize {
        fs::read_dir(self).unwrap().count()
    }
}

impl Deref for Folder {
    type Target = Path;

    fn deref(&self) -> &Path {
        self.0.path()
    }
}

impl AsRef<Path> for Folder {
    fn as_ref(&self) -> &Path {
        self
    }
}

/// Returns a command that runs the program without a display.
pub fn command(folder: &Path, words: impl Words) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_a3"));
    command
        .args(words.list())
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        // Some libraries warn if this folder is not set.
        .env("XDG_RUNTIME_DIR", folder);
    command
}

pub fn a3(folder: &Path, words: impl Words) -> Output {
    command(folder, words).output().unwrap()
}

pub fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// Runs the program, which must succeed.
pub fn succeed(folder: &Path, words: impl Words) -> Output {
    let output = a3(folder, &words);
    assert!(output.status.success(), "{words:?}: {}", text(&output.stderr));
    output
}

/// Runs the program, which must succeed, and returns its standard output.
pub fn said(folder: &Path, words: impl Words) -> String {
    text(&succeed(folder, words).stdout).to_owned()
}

/// Runs `a3 simulate`, and returns the state that it writes to standard output.
pub fn simulate(folder: &Path, words: impl Words) -> Value {
    let words = [&["simulate"], &words.list()[..], &["--output", "-"]].concat();
    let output = succeed(folder, words);
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Returns the only line on stderr, except for notes on the scene, of a program that exited with
/// `code` and wrote nothing else.
pub fn complaint(output: &Output, code: i32) -> String {
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{stderr}");
    let lines = stderr.lines().filter(|line| !line.starts_with("note: "));
    let lines: Vec<_> = lines.collect();
    assert_eq!(lines.len(), 1, "one line, not\n{stderr}");
    assert!(output.stdout.is_empty());
    lines[0].trim_end().to_owned()
}

/// Prints that a test is skipped, or fails if the variable `required` is set.
pub fn skip(why: &str, required: &str) {
    assert!(std::env::var_os(required).is_none(), "{required} is set: {why}");
    // Bypass the test runner, which hides the output of passing tests.
    let _ = writeln!(std::io::stderr(), "SKIPPED, NOT TESTED: {why}");
}

/// Returns whether there is no graphics adapter, with a message.
pub fn gpu_is_missing(output: &Output) -> bool {
    let stderr = text(&output.stderr);
    let missing = stderr.contains("mesa-vulkan-drivers");
    if missing {
        skip(stderr, "A3_REQUIRE_GPU");
    }
    missing
}

/// Returns whether a program that checks files is missing, with a message.
pub fn is_missing(program: &str) -> bool {
    let found = Command::new(program)
        .arg("-version")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    let missing = found.is_err();
    if missing {
        skip(&format!("{program} is not installed"), "A3_REQUIRE_CHECKERS");
    }
    missing
}

/// Runs a program that checks files, and returns its output. It must succeed.
pub fn asked(folder: &Path, program: &str, words: impl Words) -> String {
    let output = Command::new(program).args(words.list()).current_dir(folder).output().unwrap();
    let (stdout, stderr) =
        (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{program} {words:?}: {stdout}{stderr}");
    stdout.into_owned()
}
