//! Exports that are refused, blow up, or are interrupted.

use std::fs;
use std::process::Command;

use crate::common::{a3, command, complaint};

#[test]
fn exports_that_cannot_be_are_refused_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let long = |grid, output, more: &[&'static str]| {
        let run = [
            "simulate", "v", "0.01", "--until", "100", "--grid", grid, "--output", output,
        ];
        [&run[..], more].concat()
    };
    for (words, says) in [
        (
            long("5x5", "x.txt", &[]),
            ".json, .csv, .npz, .obj, .pc2, .glb, .usda or .vtu",
        ),
        (long("5x5", "-", &["--fps", "25"]), "final state"),
        (long("5x5", "-", &["--summary", "-"]), "not both"),
        (long("5x5", "x.json", &["--summary", "s.txt"]), ".json"),
        (long("5x5", "x.json", &["--fps", "0"]), "such as 30"),
        (long("5x5", "x.obj", &["--fps", "25"]), "cloth-####.obj"),
        (long("5x5", "x-###.obj", &[]), "4 digits"),
        (
            long("5x5", "x.glb", &[]),
            "3001 frames are too many for a .glb, which has at most 600",
        ),
        (
            long("1000x1000", "x.glb", &["--fps", "5"]),
            "11.2 GiB, and at most 4 GiB",
        ),
        (
            long("1000x1000", "x.pc2", &[]),
            "33.5 GiB, and at most 16 GiB",
        ),
        (
            long("1000x1000", "x.npz", &["--fps", "5"]),
            "22.4 GiB, and at most 4 GiB",
        ),
        (long("1000x1000", "x.csv", &[]), "GiB"),
        (long("1000x1000", "x-####.obj", &[]), "GiB"),
        (long("1000x1000", "x.json", &["--fps", "30"]), "GiB"),
    ] {
        let line = complaint(&a3(folder.path(), &words), 2);
        assert!(
            line.starts_with("error: ") && line.contains(says),
            "{words:?}: {line}"
        );
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// Files are complete or absent, and all their numbers are finite.
#[test]
fn a_run_that_blows_up_leaves_only_the_whole_files_of_a_sequence() {
    let folder = tempfile::tempdir().unwrap();
    let run = |more: &[&str]| {
        let words = [
            "simulate",
            "rk4",
            "0.04",
            "--scene",
            "mit",
            "--until",
            "8",
            "--summary",
            "s.json",
            "--output",
        ];
        complaint(&a3(folder.path(), &[&words[..], more].concat()), 1)
    };
    // Steps for a frame, none of which is shortened.
    let several = ["--fps", "25"];
    for output in ["x.json", "x.obj"] {
        assert!(run(&[output]).contains("blew up at step"));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "{output}");
    }
    for output in ["x.json", "x.csv", "x.npz", "x.pc2", "x.glb", "x.usda"] {
        let line = run(&[&[output], &several[..]].concat());
        assert!(
            line.contains("blew up at step") && line.contains("nothing was written; a step of "),
            "{line}"
        );
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "{output}");
    }
    let line = run(&[&["x-###.obj"], &several[..]].concat());
    let count = fs::read_dir(folder.path()).unwrap().count();
    assert!((2..200).contains(&count), "{count}");
    assert!(
        line.contains(&format!("x-###.obj has the first {count} of 201 frames")),
        "{line}"
    );
    for entry in fs::read_dir(folder.path()).unwrap() {
        let obj = fs::read_to_string(entry.unwrap().path()).unwrap();
        assert!(obj.contains("\nf ") && !obj.contains("NaN") && !obj.contains("inf"));
    }
}

#[test]
#[cfg(unix)]
fn an_interrupted_export_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    for output in ["x.csv", "x.npz", "x.pc2", "x.glb", "x.usda"] {
        let words = ["simulate", "v", "1e-5", "--until", "19", "--output", output];
        let child = command(folder.path(), &words).spawn().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(400));
        let interrupt = Command::new("kill")
            .args(["-INT", &child.id().to_string()])
            .status();
        assert!(interrupt.unwrap().success());
        let line = complaint(&child.wait_with_output().unwrap(), 130);
        assert_eq!(line, "interrupted: nothing was written");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
