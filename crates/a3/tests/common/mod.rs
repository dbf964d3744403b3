//! Runs of the program in a folder of their own.

#![allow(dead_code, reason = "not every test needs all of it")]

use std::io::Write;
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

/// Returns the command of the program without a display.
pub fn command(folder: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_a3"));
    command
        .args(words)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        // Some libraries print a warning without this folder.
        .env("XDG_RUNTIME_DIR", folder);
    command
}

pub fn a3(folder: &Path, words: &[&str]) -> Output {
    command(folder, words).output().unwrap()
}

pub fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// Returns the state that the program writes to standard output.
pub fn simulate(folder: &Path, words: &[&str]) -> Value {
    let words = [&["simulate"], words, &["--output", "-"]].concat();
    let output = a3(folder, &words);
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Returns the line on stderr of a program that ended with `code` and printed nothing else.
pub fn complaint(output: &Output, code: i32) -> String {
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{stderr}");
    assert_eq!(stderr.lines().count(), 1, "one line, not\n{stderr}");
    assert!(output.stdout.is_empty());
    stderr.trim_end().to_owned()
}

/// Reports a test that is skipped; fails if an environment variable demands it.
pub fn skip(why: &str, required: &str) {
    assert!(
        std::env::var_os(required).is_none(),
        "{required} is set: {why}"
    );
    // Written directly, because the test runner hides the output of passing tests.
    let _ = writeln!(std::io::stderr(), "SKIPPED, NOT TESTED: {why}");
}

/// Returns whether there is no adapter to draw with.
pub fn gpu_is_missing(output: &Output) -> bool {
    let stderr = text(&output.stderr);
    let missing = stderr.contains("mesa-vulkan-drivers");
    if missing {
        skip(stderr, "A3_REQUIRE_GPU");
    }
    missing
}

/// Returns whether an external program that checks files is not installed.
pub fn is_missing(program: &str) -> bool {
    let found = Command::new(program)
        .arg("-version")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    let missing = found.is_err();
    if missing {
        skip(
            &format!("{program} is not installed"),
            "A3_REQUIRE_CHECKERS",
        );
    }
    missing
}

/// Returns the output of an external program about a file, which it must accept.
pub fn asked(folder: &Path, program: &str, words: &[&str]) -> String {
    let output = Command::new(program)
        .args(words)
        .current_dir(folder)
        .output()
        .unwrap();
    let (stdout, stderr) = (
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr),
    );
    assert!(
        output.status.success(),
        "{program} {words:?}: {stdout}{stderr}"
    );
    stdout.into_owned()
}
