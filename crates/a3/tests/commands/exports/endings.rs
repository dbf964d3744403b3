//! Exports that are refused, blow up, or are interrupted.

use std::fs;
use std::process::Command;

use crate::common::{Folder, a3, command, complaint};

#[test]
fn exports_that_cannot_be_are_refused_before_the_work() {
    let folder = &Folder::new();
    let long = |more: &str| format!("simulate v 0.01 --until 100 --grid {more}");
    for (words, says) in [
        ("5x5 --output x.txt", ".json, .csv, .npz, .obj, .glb, .usda or .vtu"),
        ("5x5 --output - --fps 25", "final state"),
        ("5x5 --output - --summary -", "not both"),
        ("5x5 --output x.json --summary s.txt", ".json"),
        ("5x5 --output x.json --fps 0", "such as 30"),
        ("5x5 --output x.obj --fps 25", "cloth-####.obj"),
        ("5x5 --output x-###.obj", "4 digits"),
        ("5x5 --output x.glb", "3001 frames are too many for a .glb, which has at most 600"),
        ("1000x1000 --output x.glb --fps 5", "11.2 GiB, and at most 4 GiB"),
        ("1000x1000 --output x.usda", "GiB, and at most 16 GiB"),
        ("1000x1000 --output x.npz --fps 5", "22.4 GiB, and at most 4 GiB"),
        ("1000x1000 --output x.csv", "GiB"),
        ("1000x1000 --output x-####.obj", "GiB"),
        ("1000x1000 --output x.json --fps 30", "GiB"),
    ] {
        let line = complaint(&a3(folder, long(words)), 2);
        assert!(line.starts_with("error: ") && line.contains(says), "{words:?}: {line}");
    }
    assert_eq!(folder.count(), 0);
}

/// Files are complete or absent, and all their numbers are finite.
#[test]
fn a_run_that_blows_up_leaves_only_the_whole_files_of_a_sequence() {
    let folder = &Folder::new();
    let run = |more: &str| {
        let words = "simulate rk4 0.04 --scene mit --until 8 --summary s.json --output";
        complaint(&a3(folder, format!("{words} {more}")), 1)
    };
    for output in ["x.json", "x.obj"] {
        assert!(run(output).contains("blew up at step"));
        assert_eq!(folder.count(), 0, "{output}");
    }
    // Whole steps for each frame, none shortened.
    for output in ["x.json", "x.csv", "x.npz", "x.glb", "x.usda"] {
        let line = run(&format!("{output} --fps 25"));
        assert!(
            line.contains("blew up at step") && line.contains("nothing was written; a step of "),
            "{line}"
        );
        assert_eq!(folder.count(), 0, "{output}");
    }
    let line = run("x-###.obj --fps 25");
    let count = folder.count();
    assert!((2..200).contains(&count), "{count}");
    assert!(line.contains(&format!("x-###.obj has the first {count} of 201 frames")), "{line}");
    for entry in fs::read_dir(folder).unwrap() {
        let obj = fs::read_to_string(entry.unwrap().path()).unwrap();
        assert!(obj.contains("\nf ") && !obj.contains("NaN") && !obj.contains("inf"));
    }
}

#[test]
#[cfg(unix)]
fn an_interrupted_export_leaves_nothing() {
    let folder = &Folder::new();
    for output in ["x.csv", "x.npz", "x.glb", "x.usda"] {
        let words = format!("simulate v 1e-5 --until 19 --output {output}");
        let child = command(folder, words).spawn().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(400));
        let interrupt = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        assert!(interrupt.unwrap().success());
        let line = complaint(&child.wait_with_output().unwrap(), 130);
        assert_eq!(line, "interrupted: nothing was written");
        assert_eq!(folder.count(), 0);
    }
}
