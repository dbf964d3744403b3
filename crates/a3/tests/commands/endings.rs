//! The end of the program: its exit codes, as the manual lists them, and its last message.

use std::fmt::Write;
use std::fs;
use std::process::Stdio;

use crate::common::{Folder, a3, command, complaint, text};

/// Characters that would move the cursor, change colours or hide what follows.
const TRICKS: &str = "\u{1b}[31mred\u{7}\u{9b}1m\u{202e}";

#[test]
fn every_exit_code_is_in_the_manual_and_is_used() {
    let folder = &Folder::new();
    let manual = a3(folder, "man");
    let manual = text(&manual.stdout);
    let (_, section) = manual.split_once(".SH \"EXIT STATUS\"\n").unwrap();
    let section = section.split(".SH").next().unwrap();
    let listed: Vec<i32> = section
        .lines()
        .filter_map(|line| line.strip_prefix("\\fB")?.strip_suffix("\\fR")?.parse().ok())
        .collect();
    // Signals have tests of their own.
    assert_eq!(listed, [0, 1, 2, 129, 130, 143]);
    let code = |words: &str| {
        let output = command(folder, words)
            // No adapter has this name.
            .env("WGPU_ADAPTER_NAME", "none of them")
            .output()
            .unwrap();
        let lines = text(&output.stderr).lines().count();
        assert!(lines <= 2, "{words:?}: {}", text(&output.stderr));
        output.status.code().unwrap()
    };
    folder.write("bad.toml", "cloth = 1\n");
    folder.write("bad.csv", "a\n");
    for (expected, words) in [
        (0, "simulate r 0.01 --until 1 -o x.json --scene simple"),
        // Without a display, and then without a picture.
        (0, "r 0.01 --scene simple"),
        (0, "compare e r --scene simple"),
        (1, "simulate e 0.1 --scene mit --until 9 -o x.json"),
        (1, "simulate r --until 1 -o nowhere/x.json"),
        (1, "render --scene simple --until 1 -o x.png"),
        (2, "simulate r 0.01 --until 1 -o x.json --scene bad.toml"),
        (2, "simulate r 0.01 --until 1 -o x.json --scene nowhere.toml"),
        (2, "simulate r 0.01 --until 1 -o x.json --grid 1x1"),
        (2, "simulate r 0.01 --until 1 -o x.json --summary x.json"),
        (2, "chart --data bad.csv"),
        (2, "fly"),
    ] {
        assert_eq!(code(words), expected, "{words:?}");
    }
}

#[test]
fn nothing_from_a_file_or_a_name_moves_the_cursor() {
    let folder = &Folder::new();
    let path = folder.join("tricky.toml");
    let mut name = String::new();
    for c in TRICKS.chars() {
        write!(name, "\\u{:04x}", u32::from(c)).unwrap();
    }
    let body = "gravity = [0, -9.81, 0]\n[[cloth]]\ngrid = [3, 3]\nwidth = 1\nmass = 0.01\nstiffness = [20, 10, 5]\npin = [{ at = [\"top\"] }]\n";
    let scene = format!("name = \"{name}/..\"\nsummary = \"{name}\"\n{body}");
    fs::write(&path, &scene).unwrap();
    let tricky = ["--scene", "tricky.toml"];
    let no_folder = format!("{TRICKS}/x.json");
    let quoted = format!("'{TRICKS}'\n{}", "long ".repeat(10_000));
    for words in [
        [&["chart", "--solvers", "r", "--until", "0.1"][..], &tricky].concat(),
        [&["r", "0.01"][..], &tricky].concat(),
        [&["r", "0.01", "--springs-of", "0"][..], &tricky].concat(),
        [&["v", "0.01", "--wind"][..], &tricky].concat(),
        vec!["simulate", "--until", "1", "-o", &no_folder],
        vec!["simulate", "--until", "1", "-o", TRICKS],
        vec!["--scene", &quoted],
        vec![&quoted],
        vec!["chart", "--solvers", &quoted],
    ] {
        let output = a3(folder, &words);
        for (channel, bytes) in [("out", &output.stdout), ("error", &output.stderr)] {
            let unseen = |c: char| c != '\n' && (c.is_control() || c == '\u{202e}');
            let said = text(bytes);
            assert!(!said.contains(unseen), "{words:?}, {channel}: {said:?}");
        }
        if !output.status.success() {
            let line = complaint(&output, output.status.code().unwrap());
            assert!(line.chars().count() < 1300, "{line}");
        }
    }
    // The chart has a name in this folder.
    let charts = fs::read_dir(folder).unwrap().filter(|entry| {
        let name = entry.as_ref().unwrap().file_name().into_string().unwrap();
        name.starts_with("a3-chart-") && !name.contains(char::is_control)
    });
    assert_eq!(charts.count(), 1);
    // Data stay as they are, and a name adds no line to them.
    let words = [&["simulate", "--until", "0", "-o", "x.obj"][..], &tricky].concat();
    fs::write(&path, scene.replacen("/..", "\\nv 7 7 7", 1)).unwrap();
    assert!(a3(folder, &words).status.success());
    let obj = folder.read("x.obj");
    assert!(!obj.lines().any(|line| line == "v 7 7 7"));
}

/// A failed write to standard error causes no panic.
#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_error_does_not_change_the_exit_code() {
    let folder = &Folder::new();
    for (words, code) in
        [("fly", 2), ("simulate --until 1 -o nowhere/x.json", 1), ("r 0.01 --scene simple", 0)]
    {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let status = command(folder, words).stdout(Stdio::null()).stderr(full).status();
        assert_eq!(status.unwrap().code(), Some(code), "{words:?}");
    }
}
