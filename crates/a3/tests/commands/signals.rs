//! Signals: a program that a signal ends has the exit code 128 plus the signal's number, and leaves
//! no unfinished file.

use std::fs;
use std::path::Path;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use crate::common::{Folder, Words, command, text};

fn kill(child: &Child, signal: &str) {
    let id = child.id().to_string();
    let status = Command::new("kill").args([signal, &id]).status();
    assert!(status.unwrap().success());
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names.collect()
}

/// Starts a command and waits until it has created its file.
fn begin(folder: &Path, words: impl Words) -> Child {
    let mut child = command(folder, words).spawn().unwrap();
    let begun = Instant::now();
    while !names(folder).iter().any(|name| name.starts_with(".a3-")) {
        assert!(child.try_wait().unwrap().is_none(), "it ended before");
        assert!(begun.elapsed() < Duration::from_mins(1));
        std::thread::sleep(Duration::from_millis(1));
    }
    child
}

const EXPORT: &str = "simulate v 0.001 --until 5000 --fps 0.1 --output";

/// Returns whether this test was started by `nohup`, which the program respects.
fn hangups_are_ignored() -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.is_some_and(|mask| mask.trim().ends_with(['1', '3', '5', '7', '9', 'b', 'd', 'f']))
}

#[test]
fn every_signal_ends_a_run_with_its_own_code() {
    let folder = &Folder::new();
    for (signal, code) in [("-HUP", 129), ("-INT", 130), ("-TERM", 143)] {
        if signal == "-HUP" && hangups_are_ignored() {
            continue;
        }
        for output in ["x.csv", "x.glb"] {
            let words = format!("{EXPORT} {output}");
            let child = begin(folder, &words);
            kill(&child, signal);
            let output = child.wait_with_output().unwrap();
            assert_eq!(output.status.code(), Some(code), "{words:?}");
            assert!(text(&output.stderr).starts_with("interrupted: "));
            assert_eq!(names(folder), [""; 0], "{words:?}");
        }
    }
}

/// A film creates its file before it starts the adapter, which may take long.
#[test]
fn a_film_ends_while_it_starts() {
    let folder = &Folder::new();
    for output in ["x.gif", "x.mp4"] {
        if output == "x.mp4" && crate::common::is_missing("ffmpeg") {
            continue;
        }
        for milliseconds in [0, 20, 60, 120] {
            let words = format!("render --until 1000 --size 320x240 -o {output}");
            let child = begin(folder, words);
            std::thread::sleep(Duration::from_millis(milliseconds));
            kill(&child, "-TERM");
            let ended = child.wait_with_output().unwrap();
            if crate::common::gpu_is_missing(&ended) {
                continue;
            }
            assert_eq!(ended.status.code(), Some(143), "{}", text(&ended.stderr));
            // The frames so far are kept, if there are any.
            let _ = fs::remove_file(folder.join(output));
            assert_eq!(names(folder), [""; 0], "{milliseconds} ms");
        }
    }
}

/// A command that does not check for signals, because it waits for a reader, is ended nevertheless.
#[test]
fn a_run_that_does_not_notice_is_ended() {
    let folder = &Folder::new();
    let status = Command::new("mkfifo").arg(folder.join("x.csv")).status();
    assert!(status.unwrap().success());
    let words = "chart --scene simple --until 0.1 --data d.csv \
                 --output x.svg --solvers r --work evaluations";
    let data = folder.join("d.csv");
    fs::rename(folder.join("x.csv"), folder.join("x.svg")).unwrap();
    let child = command(folder, words).spawn().unwrap();
    while !data.exists() {
        std::thread::sleep(Duration::from_millis(5));
    }
    std::thread::sleep(Duration::from_millis(300));
    let begun = Instant::now();
    kill(&child, "-INT");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
    assert!(begun.elapsed() < Duration::from_secs(20));
    assert!(text(&output.stderr).contains("interrupted"));
}

/// A step of the implicit midpoint rule on a very large cloth takes many seconds.
#[test]
fn a_run_is_ended_within_a_long_step() {
    let folder = &Folder::new();
    let words = "simulate n 0.05 --grid 400x400 --until 10 -o x.csv";
    let child = begin(folder, words);
    std::thread::sleep(Duration::from_secs(1));
    let begun = Instant::now();
    kill(&child, "-TERM");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(143), "{}", text(&output.stderr));
    // A second, and more if the machine is busy.
    assert!(begun.elapsed() < Duration::from_secs(4));
    assert_eq!(names(folder), [""; 0]);
}

/// The next run deletes the temporary file of a run that `kill -9` ended, and nothing else.
#[test]
fn the_next_run_sweeps_what_a_killed_one_left() {
    let folder = &Folder::new();
    let mut killed = begin(folder, format!("{EXPORT} x.csv"));
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert_eq!(names(folder).len(), 1);
    let other = folder.join("other");
    fs::create_dir(&other).unwrap();
    let at_work = begin(&other, format!("{EXPORT} y.csv"));
    let name = names(&other).remove(0);
    fs::hard_link(other.join(&name), folder.join(&name)).unwrap();
    let words = "simulate --scene simple --until 1 -o z.json";
    assert!(command(folder, words).status().unwrap().success());
    let mut left = names(folder);
    left.sort();
    assert_eq!(left, [&name, "other", "z.json"]);
    kill(&at_work, "-KILL");
    at_work.wait_with_output().unwrap();
}

/// After `nohup`, the signal of a closed terminal is ignored.
#[cfg(target_os = "linux")]
#[test]
fn a_run_without_a_terminal_goes_on() {
    let folder = &Folder::new();
    let program = env!("CARGO_BIN_EXE_a3");
    let script =
        format!("trap '' HUP; exec '{program}' simulate v 0.001 --until 100000 -o x.csv --fps 0.1");
    let mut child = Command::new("sh")
        .args(["-c", &script])
        .current_dir(folder)
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    while names(folder).is_empty() {
        std::thread::sleep(Duration::from_millis(1));
    }
    kill(&child, "-HUP");
    std::thread::sleep(Duration::from_millis(300));
    assert!(child.try_wait().unwrap().is_none(), "it goes on");
    kill(&child, "-TERM");
    assert_eq!(child.wait().unwrap().code(), Some(143));
}
